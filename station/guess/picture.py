# SPDX-License-Identifier: MIT
"""Pictures of the first hit: rows of blocks in the terminal, and an HTML file."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import software_version
from jointbench.signal.hits.plausibility import active_share
from jointbench.station.drawing.palette import MEASURED
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import Plot, Report, Section, Text
from jointbench.station.screen.traces import line

_BLOCKS = " ▁▂▃▄▅▆▇█"
_WIDTH = 60
_AROUND = 0.6
"""Share of the picture after the hit."""
_MOST_POINTS = 4000
_SI = {"force": "N", "acceleration": "m/s²", "velocity": "m/s", "displacement": "m"}


def block_rows(recording: Recording) -> list[str]:
    """Return one row of blocks a channel: the largest magnitude of each stretch."""
    part, span = _shown(recording)
    rows = []
    for channel, values in zip(recording.channels, part, strict=True):
        blocks = _blocks(values)
        unit = _SI[channel.quantity.value]
        ends = f"{values.min():.3g} to {values.max():.3g} {unit}"
        rows.append(f"{channel.name[:14]:14s} {blocks} {ends}")
    rows.append(f"{'':14s} {span[0]:.4g} s{'':{_WIDTH - 18}s}{span[1]:.4g} s")
    return rows


def write_picture(path: Path, recording: Recording, notes: list[str]) -> None:
    """Write the first hit as an HTML file with one plot a channel."""
    part, span = _shown(recording)
    time = np.linspace(span[0], span[1], part.shape[1])
    plots = []
    for number, (channel, values) in enumerate(
        zip(recording.channels, part, strict=True)
    ):
        unit = _SI[channel.quantity.value]
        kept = max(1, values.size // _MOST_POINTS)
        trace = line(time[::kept], values[::kept], channel.name, color=MEASURED)
        drawn = figure(
            [trace],
            axis("time [s]"),
            axis(f"{channel.name} [{unit}]"),
            showlegend=False,
        )
        caption = f"{channel.name}: {channel.quantity.value} in {unit}"
        plots.append(Plot(f"channel-{number}", caption, drawn, 240))
    texts = tuple(Text(note, "notice") for note in notes)
    section = Section("channels", recording.name, (*texts, *plots))
    report = Report(
        title=f"Proposal for {recording.name}",
        lead="First hit as it would be imported. Nothing is written before it is "
        "confirmed.",
        software=software_version(),
        simulated=False,
        tiles=(),
        sections=(section,),
    )
    write_report(report, path)


def _shown(recording: Recording) -> tuple[FloatArray, tuple[float, float]]:
    """Return the stretch around the first pulse, and its ends [s]."""
    samples = np.asarray(recording.samples[:], np.float64)
    shares = [active_share(row) for row in samples]
    sharpest = samples[int(np.argmin(shares))]
    plain = np.abs(sharpest - np.median(sharpest))
    at = int(np.argmax(plain > 0.5 * plain.max(initial=0.0)))
    length = min(samples.shape[1], max(200, int(0.25 * recording.sample_rate)))
    last = samples.shape[1] - length
    first = int(np.clip(at - (1 - _AROUND) * 0.5 * length, 0, last))
    span = first / recording.sample_rate, (first + length) / recording.sample_rate
    return samples[:, first : first + length], span


def _blocks(values: FloatArray) -> str:
    plain = np.abs(values - np.median(values))
    pieces = np.array_split(plain, min(_WIDTH, plain.size))
    heights = np.array([piece.max() for piece in pieces])
    scaled = heights / (heights.max() or 1.0) * (len(_BLOCKS) - 1)
    return "".join(_BLOCKS[round(float(one))] for one in scaled)
