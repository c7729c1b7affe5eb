# SPDX-License-Identifier: MIT
"""The report's section on hits: force pulses, responses, verdicts with reasons."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.records.recordings import (
    Hit,
    Quantity,
    Recording,
    Verdict,
    response_rows,
)
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import DataTable, Plot, Section
from jointbench.station.screen.plot_numbers import thin
from jointbench.station.screen.traces import GREY, PALETTE, Trace, line

BEFORE_TRIGGER = 1.5e-3
"""Time before the trigger in the plot of the force pulses [s]."""
AFTER_TRIGGER = 60e-3
"""Time after the trigger, long enough to show a double hit [s]."""
MOST_POINTS = 1600
REJECTED = frozenset(v.value for v in Verdict if v is not Verdict.OK)
UNITS = {
    Quantity.FORCE: "N",
    Quantity.ACCELERATION: "m/s²",
    Quantity.VELOCITY: "m/s",
    Quantity.DISPLACEMENT: "m",
}


def hits_section(recordings: Sequence[Recording]) -> Section:
    """Return the section: pulses, first response, and the table of verdicts."""
    return Section(
        "hits",
        "Hits",
        (
            Plot("pulses", _pulse_caption(recordings), _pulses(recordings), 340),
            Plot("responses", *_responses(recordings), 320),
            _table(recordings),
        ),
    )


def _pulse_caption(recordings: Sequence[Recording]) -> str:
    hits = [hit for recording in recordings for hit in recording.hits]
    good = sum(hit.verdict is Verdict.OK for hit in hits)
    return (
        f"Force of all {len(hits)} hits, aligned at the trigger: {good} accepted, "
        f"{len(hits) - good} rejected (red, dotted)."
    )


def _pulses(recordings: Sequence[Recording]) -> dict[str, object]:
    traces: list[Trace] = []
    for recording in recordings:
        row = recording.row(Quantity.FORCE)
        for number, hit in enumerate(recording.hits, 1):
            traces.append(_pulse(recording, row, hit, number))
    return dict(
        figure(
            traces, axis("time after trigger [ms]"), axis("force [N]"), showlegend=False
        )
    )


def _pulse(recording: Recording, row: int, hit: Hit, number: int) -> Trace:
    rate = recording.sample_rate
    start = max(hit.trigger - round(BEFORE_TRIGGER * rate), 0)
    stop = min(hit.trigger + round(AFTER_TRIGGER * rate), recording.samples.shape[1])
    time = (np.arange(start, stop) - hit.trigger) / rate * 1e3
    good = hit.verdict is Verdict.OK
    return line(
        time,
        recording.samples[row, start:stop],
        f"{recording.name} hit {number}: {hit.verdict.value}",
        color=PALETTE[0] if good else PALETTE[1],
        dash="solid" if good else "dot",
        width=1.2,
    )


def _responses(recordings: Sequence[Recording]) -> tuple[str, dict[str, object]]:
    recording, hit = next(
        (
            (recording, hit)
            for recording in recordings
            for hit in recording.hits
            if hit.verdict is Verdict.OK
        ),
        (recordings[0], recordings[0].hits[0]),
    )
    rows = response_rows(recording)
    unit = UNITS[recording.channels[rows[0]].quantity]
    traces = [
        _response(recording, hit, row, [*PALETTE, GREY][number % 7])
        for number, row in enumerate(rows)
    ]
    caption = (
        f"Response to one hit ({recording.name}, {hit.peak_force:.0f} N): all "
        "channels, entire block."
    )
    plot = figure(traces, axis("time after trigger [s]"), axis(f"response [{unit}]"))
    return caption, dict(plot)


def _response(recording: Recording, hit: Hit, row: int, color: str) -> Trace:
    samples = recording.samples[row, hit.start : hit.stop]
    time = (np.arange(samples.size) + hit.start - hit.trigger) / recording.sample_rate
    return line(
        *thin(time, samples, MOST_POINTS),
        recording.channels[row].name,
        color=color,
        width=1.0,
    )


def _table(recordings: Sequence[Recording]) -> DataTable:
    rows = tuple(
        (
            f"{recording.name} / {number}",
            f"{recording.start_time + hit.trigger / recording.sample_rate:.3f}",
            hit.point,
            f"{hit.peak_force:.4g}",
            hit.verdict.value,
            hit.reason,
        )
        for recording in recordings
        for number, hit in enumerate(recording.hits, 1)
    )
    return DataTable(
        "Every hit with its verdict and reason. Rejected hits stay in the session "
        "and can be assessed again.",
        ("hit", "time [s]", "point", "peak [N]", "verdict", "reason"),
        rows,
        REJECTED,
    )
