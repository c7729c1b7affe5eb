# SPDX-License-Identifier: MIT
"""The plots of the screen: force of the last hit, FRF and coherence of a channel."""

from rich.text import Text

from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.bench_view.curve_lines import (
    MARGIN,
    axis_line,
    curve_rows,
    with_axis,
)
from jointbench.station.session_events.session_state import SessionState
from jointbench.station.session_events.view_events import HitAveraged

_SPAN = 60.0  # [dB] of an FRF that is drawn
_PULSE_ROOM = 7  # rows from which the force has one of them


def plot_lines(
    state: SessionState, channel: int, *, width: int, rows: int
) -> tuple[Text, ...]:
    """Return force pulse, FRF with its axes, and coherence of one response.

    Args:
        state: of the session.
        channel: number of the response, counted on from 0.
        width: columns.
        rows: at most, at least four.
    """
    average = state.average
    if average is None:
        return ()
    lines = []
    if rows >= _PULSE_ROOM and average.pulse:
        lines.append(_pulse_line(average, width))
    if average.frf:
        lines += _frf_lines(average, channel, width, rows - len(lines))
    return tuple(Text(line) for line in lines)


def _pulse_line(average: HitAveraged, width: int) -> str:
    peak = max(average.pulse)
    tail = f" {peak:.4g} N, {1e3 * average.pulse_time:.3g} ms"
    (row,) = curve_rows(
        average.pulse, 0.0, peak, width=width - MARGIN - len(tail), rows=1
    )
    return with_axis((row,), "force", "")[0] + tail


def _frf_lines(
    average: HitAveraged, channel: int, width: int, rows: int
) -> tuple[str, ...]:
    names = list(average.frf)
    name = names[channel % len(names)]
    values, room = average.frf[name], width - MARGIN
    coherence = average.coherence.get(name)
    rows -= 2 if coherence is None else 3
    if rows < 1 or not values:
        return ()
    top = 5.0 * -(-max(values) // 5)
    drawn = curve_rows(values, top - _SPAN, top, width=room, rows=rows)
    low, high = average.band
    count = f"{channel % len(names) + 1} of {len(names)}"
    head = (
        f"FRF of {visible(name)} ({count}), {top:.0f} to {top - _SPAN:.0f} dB "
        f"re 1 SI unit, {average.good} hits"
    )
    lines = [head, *with_axis(drawn, f"{top:.0f} dB", f"{top - _SPAN:.0f} dB")]
    lines.append(" " * MARGIN + axis_line(low, high, "Hz", width=room))
    if coherence is not None:
        (row,) = curve_rows(coherence, 0.0, 1.0, width=room - 7, rows=1)
        mean = average.mean_coherence
        tail = "" if mean is None else f" {mean:.3f}"
        lines.append(with_axis((row,), "coher.", "")[0] + tail)
    return tuple(lines)
