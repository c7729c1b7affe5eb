# SPDX-License-Identifier: MIT
"""Bars of a gap: chi2/dof of each slice of a view, before and after."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointbench.analysis.gap.model.diagnosis_record import Gap, View
from jointbench.station.drawing.palette import MODEL, REFUSED
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.traces import Trace

BEFORE, AFTER = REFUSED, MODEL
LEGEND = {"orientation": "h", "x": 0, "yanchor": "bottom", "traceorder": "normal"}
LOWEST_BAR = 0.5
"""Where the bars of chi2/dof start: below 1, so that noise is seen as a short bar."""
SMALLEST_TOP = 10.0
_MOST_NUMBERED = 6
"""Most slices with their numbers above the bars; more are legible on hover alone."""


def view_grid(names: Sequence[str], before: Gap, after: Gap | None) -> Figure:
    """Return chi2/dof of each slice of several views, two views a row."""
    rows = -(-len(names) // 2)
    traces: list[Trace] = []
    layout: dict[str, Any] = {"legend": LEGEND | {"y": 1.0}}
    for k, name in enumerate(names):
        x, y = bar_axes(name, before)
        number = "" if k == 0 else str(k + 1)
        left = 0.56 * (k % 2)
        top = 1.0 - (k // 2) / rows
        height = 1.0 / rows - (0.16 if rows > 1 else 0.06)
        layout[f"xaxis{number}"] = x | {
            "domain": [left, left + 0.44],
            "anchor": f"y{number}",
        }
        layout[f"yaxis{number}"] = y | {
            "domain": [max(top - 0.06 - height, 0.0), top - 0.06],
            "anchor": f"x{number}",
        }
        own = bars(name, before, after, axes=(f"x{number}", f"y{number}"))
        traces += [{**trace, "showlegend": k == 0} for trace in own]
    x, y = layout.pop("xaxis"), layout.pop("yaxis")
    return figure(traces, x, y, barmode="group", **layout)


def bars(
    name: str, before: Gap, after: Gap | None, *, axes: tuple[str, str] = ("x", "y")
) -> list[Trace]:
    """Return chi2/dof of each slice of a view, before and after, as bars."""
    shown = axes[0] == "x"
    gaps = [(before, "base model", BEFORE)]
    if after is not None:
        gaps.append((after, "with the effect", AFTER))
    traces: list[Trace] = []
    for gap, words, color in gaps:
        view = _view_of(gap, name)
        if view is not None:
            traces.append(_bar(view, words, color, axes, shown=shown))
    return traces


def _bar(
    view: View, words: str, color: str, axes: tuple[str, str], *, shown: bool
) -> Trace:
    values = list(view.chi2_per_dof.values())
    return {
        "type": "bar",
        "x": list(view.chi2_per_dof),
        # A logarithmic axis starts bars at its lower end, whatever their base.
        "y": [float(f"{max(value, LOWEST_BAR):.5g}") for value in values],
        "text": [f"{value:.3g}" for value in values],
        "textposition": "outside" if len(values) <= _MOST_NUMBERED else "none",
        "cliponaxis": False,
        "name": words,
        "showlegend": shown,
        "marker": {"color": color},
        "xaxis": axes[0],
        "yaxis": axes[1],
    }


def _view_of(gap: Gap, name: str) -> View | None:
    return next((view for view in gap.views if view.name == name), None)


def bar_axes(name: str, gap: Gap) -> tuple[dict[str, object], dict[str, object]]:
    """Return the axes of `bars`; the one of values is logarithmic."""
    view = _view_of(gap, name)
    largest = max(view.chi2_per_dof.values(), default=1.0) if view else 1.0
    top = float(np.log10(3.0 * max(largest, SMALLEST_TOP)))
    return axis(name, type="category"), axis(
        "chi2/dof [-] (noise: 1)", log=True, range=[float(np.log10(LOWEST_BAR)), top]
    )
