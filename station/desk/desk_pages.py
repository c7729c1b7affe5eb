# SPDX-License-Identifier: MIT
"""What the screens of the desk show, as JSON types; texts are passed on as they are."""

from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.frf.mode_indicators import cmif
from jointbench.signal.modal.shape_checks import phase_collinearity
from jointbench.station.desk.desk_choice import effective
from jointbench.station.desk.desk_state import DeskState, chosen_rows, evidence
from jointbench.station.desk.desk_subject import hit_time
from jointbench.station.pipeline.modal_summary import synthesis_error
from jointbench.station.screen.plot_numbers import numbers

UNITS = {
    FrfKind.RECEPTANCE: "m/N",
    FrfKind.MOBILITY: "m/(N s)",
    FrfKind.ACCELERANCE: "m/(N s²)",
}
# Lines drawn of a curve: of two in each pixel of a wide screen.
_MOST_LINES = 3000
_INDICATORS = 2
Page = dict[str, Any]


def summary_page(state: DeskState) -> Page:
    """Return what every screen shows: title, modes, choices, what can be undone."""
    frf, subject = state.chain.frf, state.subject
    estimate = [s for s in state.chain.provenance if s.name == "estimate_frf"]
    detail = dict(estimate[0].detail) if estimate else {}
    return {
        "title": subject.title,
        "simulated": subject.simulated,
        "preload_n": subject.preload,
        "outputs": list(frf.outputs),
        "inputs": list(frf.inputs),
        "unit": UNITS[frf.kind],
        "averages": frf.averages,
        "estimator": str(detail.get("estimator", "")),
        "band_hz": list(state.chain.result.band),
        "results": subject.results.name,
        "modes": _modes(state),
        "synthesis_error": synthesis_error(state.chain),
        "remarks": [*state.remarks, *state.chain.result.remarks],
        "log": [
            {"who": one.who, "when": one.when, "what": one.words()} for one in state.log
        ],
        "undo": bool(effective(state.log)),
        "curves": bool(state.chain.amplitude),
        "hits_known": bool(subject.recordings),
    }


def _modes(state: DeskState) -> list[Page]:
    model, rows = state.chain.result.model, chosen_rows(state)
    collinearity = phase_collinearity(_side(state))
    starts = np.array([one.frequency for one in state.chosen])
    pages = []
    for i, frequency in enumerate(model.natural_frequency):
        own = int(np.argmin(np.abs(starts - frequency))) if starts.size else -1
        pages.append(
            {
                "frequency_hz": float(frequency),
                "frequency_sd_hz": float(model.frequency_sd[i]),
                "damping_ratio": float(model.damping_ratio[i]),
                "damping_ratio_sd": float(model.damping_ratio_sd[i]),
                "mpc": _finite(collinearity[i]),
                "misfit": _finite(model.residual_ratio[i]),
                "stable_orders": int(model.stable_orders[i]),
                "by_hand": bool(model.by_hand[i]),
                "pinned": own >= 0 and state.chosen[own].pinned,
                "row": rows[own] if own >= 0 else -1,
            }
        )
    return pages


def _side(state: DeskState) -> np.ndarray:
    """Return the shapes of the side with more points."""
    model = state.chain.result.model
    roved = len(model.inputs) > len(model.outputs)
    return model.participation if roved else model.shapes


def diagram_page(state: DeskState) -> Page:
    """Return the stabilisation diagram with the curves under it."""
    table, frf = state.automatic.result.stabilisation, state.automatic.frf
    lines = _drawn_lines(state, None)
    part = frf.response[:, :, lines]
    mean = np.sqrt(np.mean(np.abs(part) ** 2, axis=(0, 1)))
    level = table.stable_frequency.astype(int)
    level += (table.stable_frequency & table.stable_damping).astype(int)
    level += table.stable.astype(int)
    inner = Frf(frf.frequency[lines], part, frf.kind)
    return {
        "frequency_hz": numbers(table.frequency),
        "damping_ratio": numbers(table.damping_ratio),
        "order": [int(one) for one in table.order],
        "stable": [int(one) for one in level],
        "track": [int(one) for one in table.track],
        "orders": [int(table.orders[0]), int(table.orders[-1])],
        "line_hz": numbers(frf.frequency[lines]),
        "mean": numbers(mean),
        "cmif": [numbers(row) for row in cmif(inner)[:_INDICATORS]],
        "unit": UNITS[frf.kind],
    }


def evidence_page(state: DeskState, row: int) -> Page:
    """Return what speaks for one pole of the diagram."""
    found = evidence(state, row)
    return {
        "row": row,
        "frequency_hz": found.frequency,
        "frequency_sd_hz": _finite(found.frequency_sd),
        "frequency_scatter_hz": _finite(found.frequency_scatter),
        "damping_ratio": found.damping_ratio,
        "damping_ratio_sd": _finite(found.damping_ratio_sd),
        "damping_scatter": _finite(found.damping_scatter),
        "mpc": _finite(found.collinearity),
        "orders": found.orders,
    }


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
    lines = _drawn_lines(state, pair)
    response = frf.response[pair][lines]
    fitted = np.full(frf.frequency.size, complex(np.nan, np.nan))
    fitted[np.isin(frf.frequency, synthesis.frequency)] = synthesis.response[pair]
    page = {
        "output": frf.outputs[output],
        "input": frf.inputs[column],
        "unit": UNITS[frf.kind],
        "frequency_hz": numbers(frf.frequency[lines]),
        "size": numbers(np.abs(response)),
        "phase_deg": numbers(np.degrees(np.angle(response))),
        "fitted": numbers(np.abs(fitted[lines])),
        "fitted_phase_deg": numbers(np.degrees(np.angle(fitted[lines]))),
    }
    if frf.coherence is not None:
        page["coherence"] = numbers(frf.coherence[pair][lines])
    return page


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


def curves_page(state: DeskState) -> list[Page]:
    """Return the curves over amplitude; none where they were not asked for."""
    pages: list[Page] = []
    for mode in state.chain.amplitude:
        page: Page = {
            "frequency_hz": mode.soft.frequency,
            "dependence": mode.dependence.value,
            "reason": mode.reason,
        }
        if mode.curve is not None:
            curve = mode.curve
            page |= {
                "amplitude": numbers(curve.amplitude),
                "unit": curve.unit,
                "channel": curve.channel,
                "curve_hz": numbers(curve.frequency),
                "curve_hz_sd": numbers(curve.frequency_sd),
                "damping_ratio": numbers(curve.damping_ratio),
                "damping_ratio_sd": numbers(curve.damping_sd),
            }
        pages.append(page)
    return pages


def _drawn_lines(state: DeskState, pair: tuple[int, int] | None) -> IntArray:
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


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
