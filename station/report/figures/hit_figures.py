# SPDX-License-Identifier: MIT
"""Small figures of hits: accepted pulses over each other, each rejected one alone."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import (
    Hit,
    Quantity,
    Recording,
    Verdict,
    response_rows,
)
from jointbench.station.drawing.palette import MEASURED, REFUSED
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import Plot
from jointbench.station.screen.plot_numbers import thin
from jointbench.station.screen.traces import Trace, line

BEFORE_TRIGGER = 1.5e-3
"""Time before the trigger in the figures of force pulses [s]."""
AFTER_TRIGGER = 60e-3
"""Time after the trigger, long enough to show a double hit [s]."""
MOST_POINTS = 1000
_ALL_POINTS = 12_000
_FEWEST_POINTS = 80
SI_UNITS = {
    Quantity.FORCE: "N",
    Quantity.ACCELERATION: "m/s²",
    Quantity.VELOCITY: "m/s",
    Quantity.DISPLACEMENT: "m",
}
_HEIGHT = 230


def pulse_figures(recordings: Sequence[Recording]) -> list[Plot]:
    """Return the force of all accepted hits in one figure, then of each rejected."""
    named = [
        (recording, number, hit)
        for recording in recordings
        for number, hit in enumerate(recording.hits, 1)
    ]
    good = [one for one in named if one[2].verdict is Verdict.OK]
    bad = [one for one in named if one[2].verdict is not Verdict.OK]
    plots = []
    if good:
        most = max(_FEWEST_POINTS, min(_ALL_POINTS // len(good), MOST_POINTS))
        traces = [
            _pulse(recording, hit, "accepted", MEASURED, most)
            for recording, _, hit in good
        ]
        plots.append(_plot("pulses", f"{len(good)} accepted hits", traces))
    for place, (recording, number, hit) in enumerate(bad):
        trace = _pulse(recording, hit, "rejected", REFUSED, MOST_POINTS)
        caption = f"{recording.name} / {number}: {hit.verdict.value}"
        plots.append(_plot(f"rejected-{place}", caption, [trace]))
    return plots


def _plot(identifier: str, caption: str, traces: Sequence[Trace]) -> Plot:
    plot = figure(traces, axis("time after trigger [ms]"), axis("force [N]"))
    return Plot(identifier, caption, plot, _HEIGHT)


def _pulse(recording: Recording, hit: Hit, name: str, color: str, most: int) -> Trace:
    rate, row = recording.sample_rate, recording.row(Quantity.FORCE)
    start = max(hit.trigger - round(BEFORE_TRIGGER * rate), 0)
    stop = min(hit.trigger + round(AFTER_TRIGGER * rate), recording.samples.shape[1])
    time = (np.arange(start, stop) - hit.trigger) / rate * 1e3
    force = np.asarray(recording.samples[row, start:stop], float)
    return line(*thin(time, force, most), name, color=color, width=1.0)


def response_figures(recordings: Sequence[Recording]) -> tuple[str, list[Plot]]:
    """Return what is shown, and each channel of the first accepted hit."""
    recording, hit = next(
        (
            (recording, hit)
            for recording in recordings
            for hit in recording.hits
            if hit.verdict is Verdict.OK
        ),
        (recordings[0], recordings[0].hits[0]),
    )
    title = (
        f"Response to one hit ({recording.name}, {hit.peak_force:.0f} N): all "
        "channels, entire block."
    )
    plots = [
        _response(recording, hit, row, number)
        for number, row in enumerate(response_rows(recording))
    ]
    return title, plots


def _response(recording: Recording, hit: Hit, row: int, number: int) -> Plot:
    channel = recording.channels[row]
    samples: FloatArray = np.asarray(
        recording.samples[row, hit.start : hit.stop], float
    )
    time = (np.arange(samples.size) + hit.start - hit.trigger) / recording.sample_rate
    trace = line(
        *thin(time, samples, MOST_POINTS), channel.name, color=MEASURED, width=1.0
    )
    unit = SI_UNITS[channel.quantity]
    plot = figure(
        [trace],
        axis("time after trigger [s]"),
        axis(f"response [{unit}]"),
        showlegend=False,
    )
    return Plot(f"response-{number}", channel.name, plot, _HEIGHT)
