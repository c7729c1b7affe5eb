# SPDX-License-Identifier: MIT
"""One small figure for each FRF: magnitude, phase, coherence, and the synthesis."""

import numpy as np
from numpy.typing import ArrayLike

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.signal.frf.frf import Frf
from jointbench.station.drawing.palette import MEASURED, MODEL
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import Plot
from jointbench.station.screen.plot_numbers import thin
from jointbench.station.screen.traces import Trace, line

MOST_POINTS = 1400
"""Points of a line of a small figure; enough to zoom in on one mode."""
HALF_TURN = 180.0
_HEIGHT = 400


def shown_band(frf: Frf) -> IntArray:
    """Return the indices of the lines shown: the excited band with a margin."""
    low, high = frf.usable_band or (frf.frequency[0], frf.frequency[-1])
    return np.flatnonzero(
        (frf.frequency >= 0.9 * low)
        & (frf.frequency <= 1.05 * high)
        & (frf.frequency > 0)
    )


def frf_figures(frf: Frf, synthesis: Frf) -> list[Plot]:
    """Return a figure of each output and input, all over the same band.

    Args:
        frf: measured.
        synthesis: of the modes.
    """
    lines = shown_band(frf)
    return [
        _one_frf(frf, synthesis, lines, (output, column), number)
        for number, (output, column) in enumerate(np.ndindex(frf.response.shape[:2]))
    ]


def _one_frf(
    frf: Frf, synthesis: Frf, lines: IntArray, pair: tuple[int, int], number: int
) -> Plot:
    frequency, response = frf.frequency[lines], frf.response[pair][lines]
    inside = np.isin(synthesis.frequency, frequency)
    fitted = synthesis.frequency[inside], np.abs(synthesis.response[pair][inside])
    traces: list[Trace] = [
        line(
            *thin(frequency, np.abs(response), MOST_POINTS),
            "measured",
            color=MEASURED,
            width=1.3,
        ),
        line(
            *thin(*fitted, MOST_POINTS),
            "synthesised from the modes",
            color=MODEL,
            width=1.8,
            dash="dash",
        ),
        _below(*_phase(frequency, response), "y2"),
    ]
    coherence = None
    if frf.coherence is not None:
        values = frf.coherence[pair][lines]
        traces.append(_below(*thin(frequency, values, MOST_POINTS // 2), "y3"))
        coherence = axis("coherence [-]", domain=[0.0, 0.2], range=[0, 1.05])
        coherence |= {"tickvals": [0, 1]}
    magnitude = axis(f"|H| [{frf.kind.unit}]", log=True, domain=[0.45, 1.0])
    phase = axis(
        "phase [deg]",
        domain=[0.2 if coherence else 0.0, 0.45],
        range=[-185, 185],
        tickvals=[-180, 0, 180],
    )
    more = {"yaxis2": phase} | ({} if coherence is None else {"yaxis3": coherence})
    output, column = pair
    caption = f"{frf.outputs[output].rstrip('@')} / hit {frf.inputs[column]}"
    plot = figure(traces, axis("frequency [Hz]"), magnitude, **more)
    return Plot(f"frf-plot-{number}", caption, plot, _HEIGHT)


def _below(x: ArrayLike, y: ArrayLike, place: str) -> Trace:
    """Return a thin measured line in the panel of phase or of coherence."""
    return line(x, y, "", color=MEASURED, width=1, axes=("x", place), legend=False)


def _phase(
    frequency: FloatArray, response: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Return frequency and phase [deg], with a gap wherever the phase wraps."""
    every = max(1, frequency.size // MOST_POINTS)
    phase = np.degrees(np.angle(response[::every]))
    wraps = np.flatnonzero(np.abs(np.diff(phase)) > HALF_TURN)
    phase[wraps] = np.nan
    return frequency[::every], phase
