# SPDX-License-Identifier: MIT
"""What the screens of the desk show, as JSON types; texts are passed on as they are."""

import numpy as np

from jointbench.signal.frf.frf import Frf
from jointbench.signal.frf.mode_indicators import cmif
from jointbench.signal.modal.shape_checks import phase_collinearity
from jointbench.station.desk.desk_choice import effective
from jointbench.station.desk.desk_state import DeskState, chosen_rows, evidence
from jointbench.station.desk.frf_pages import Page, drawn_lines
from jointbench.station.pipeline.modal_summary import synthesis_error
from jointbench.station.screen.plot_numbers import numbers

_INDICATORS = 2


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
        "unit": frf.kind.unit,
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
    lines = drawn_lines(state, None)
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
        "unit": frf.kind.unit,
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


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
