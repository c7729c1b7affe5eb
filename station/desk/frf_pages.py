# SPDX-License-Identifier: MIT
"""FRFs and hits of the desk, as JSON types; texts are passed on as they are."""

from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.desk.desk_state import DeskState
from jointbench.station.desk.desk_subject import hit_time
from jointbench.station.screen.plot_numbers import numbers

# Lines drawn of a curve: of two in each pixel of a wide screen.
_MOST_LINES = 3000
_HALF_TURN = 180.0
Page = dict[str, Any]


def frf_page(state: DeskState, output: int, column: int) -> Page:
    """Return one FRF as measured and as synthesised.

    Args:
        state: of the desk.
        output: its number, from 0.
        column: number of the input, from 0.

    Raises:
        UsageError: there is no such FRF.
    """
    frf, synthesis = state.chain.frf, state.chain.result.synthesis
    if not (0 <= output < len(frf.outputs) and 0 <= column < len(frf.inputs)):
        raise UsageError(
            f"there are {len(frf.outputs)} outputs and {len(frf.inputs)} inputs, and "
            f"no FRF {output + 1}, {column + 1}"
        )
    pair = (output, column)
    lines = drawn_lines(state, pair)
    response = frf.response[pair][lines]
    fitted = np.full(frf.frequency.size, complex(np.nan, np.nan))
    fitted[np.isin(frf.frequency, synthesis.frequency)] = synthesis.response[pair]
    page = {
        "output": frf.outputs[output],
        "input": frf.inputs[column],
        "unit": frf.kind.unit,
        "frequency_hz": numbers(frf.frequency[lines]),
        "size": numbers(np.abs(response)),
        "phase_deg": numbers(_phase(response)),
        "fitted": numbers(np.abs(fitted[lines])),
        "fitted_phase_deg": numbers(_phase(fitted[lines])),
    }
    if frf.coherence is not None:
        page["coherence"] = numbers(frf.coherence[pair][lines])
    return page


def _phase(response: ComplexArray) -> FloatArray:
    """Return the phase [deg], with a gap wherever it wraps."""
    phase = np.degrees(np.angle(response))
    phase[np.flatnonzero(np.abs(np.diff(phase)) > _HALF_TURN)] = np.nan
    return np.asarray(phase)


def matrix_page(state: DeskState) -> Page:
    """Return every FRF as one number or two: what is missed of it, its coherence."""
    frf, synthesis = state.chain.frf, state.chain.result.synthesis
    inside = np.isin(frf.frequency, synthesis.frequency)
    measured = frf.response[:, :, inside]
    missed = np.sum(np.abs(measured - synthesis.response) ** 2, axis=2)
    whole = np.sum(np.abs(measured) ** 2, axis=2)
    coherence = None
    if frf.coherence is not None:
        coherence = np.nanmean(frf.coherence[:, :, inside], axis=2)
    return {
        "outputs": list(frf.outputs),
        "inputs": list(frf.inputs),
        "misfit": [numbers(row) for row in np.sqrt(missed / np.where(whole, whole, 1))],
        "coherence": None if coherence is None else [numbers(r) for r in coherence],
    }


def hits_page(state: DeskState) -> list[Page]:
    """Return the hits of the subject as they are judged now."""
    return [
        {
            "recording": recording.name,
            "time_s": hit_time(recording, hit.trigger),
            "point": hit.point,
            "peak_n": float(hit.peak_force),
            "verdict": hit.verdict.value,
            "reason": hit.reason,
        }
        for recording in state.chain.recordings
        for hit in recording.hits
    ]


def drawn_lines(state: DeskState, pair: tuple[int, int] | None) -> IntArray:
    """Return the lines that are drawn: the band with a margin, extremes kept."""
    frf, (low, high) = state.automatic.frf, state.automatic.result.band
    margin = 0.05 * (high - low)
    shown = np.flatnonzero(
        (frf.frequency >= max(low - margin, 0.0))
        & (frf.frequency <= high + margin)
        & (frf.frequency > 0.0)
    )
    if shown.size <= _MOST_LINES:
        return shown
    if pair is None:
        size = np.mean(np.abs(frf.response[:, :, shown]) ** 2, axis=(0, 1))
    else:
        size = np.abs(frf.response[pair][shown])
    return shown[_extremes(size, _MOST_LINES)]


def _extremes(values: FloatArray, most: int) -> IntArray:
    """Return the places of the least and the largest value of each group."""
    group = -(-values.size // (most // 2))
    whole = values.size - values.size % group
    rows = values[:whole].reshape(-1, group)
    start = np.arange(rows.shape[0]) * group
    places = np.concatenate((start + rows.argmin(1), start + rows.argmax(1)))
    return np.unique(np.append(places, np.arange(whole, values.size)))
