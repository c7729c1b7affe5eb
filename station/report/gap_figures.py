# SPDX-License-Identifier: MIT
"""Pictures of a gap: before and after, in the record and the view that tell most."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.diagnosis_record import Gap, View
from jointbench.analysis.gap.model.evidence_records import Spectra, Wishes
from jointbench.station.screen.figures import (
    GREY,
    Figure,
    Trace,
    axis,
    figure,
    line,
    markers,
)

MEASURED, BEFORE, AFTER = "#1c2733", "#d1495b", "#0b5cab"
LEGEND = {"orientation": "h", "x": 0, "yanchor": "bottom", "traceorder": "normal"}
_LOWEST_BAR = 0.5
"""Where the bars of chi2/dof start: below 1, so that noise is seen as a short bar."""
_SMALLEST_TOP = 10.0


def pretty(unit: str) -> str:
    """Write powers in a unit as raised figures.

    >>> pretty("m/s^2/N")
    'm/s²/N'
    """
    for power, raised in (("^2", "²"), ("^3", "³")):
        unit = unit.replace(power, raised)
    return unit


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
        "y": [float(f"{max(value, _LOWEST_BAR):.5g}") for value in values],
        "text": [f"{value:.3g}" for value in values],
        "textposition": "outside",
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
    top = float(np.log10(3.0 * max(largest, _SMALLEST_TOP)))
    return axis(name, type="category"), axis(
        "chi2/dof [-] (noise: 1)", log=True, range=[float(np.log10(_LOWEST_BAR)), top]
    )


def misfit_spectrum(spectra: Spectra, *, tried: str) -> Figure:
    """Return the misfit of all records over the noise against frequency."""
    x, y = spectrum_axes(spectra)
    return figure(spectrum(spectra, tried, shown=True), x, y)


def spectrum(
    spectra: Spectra,
    tried: str,
    *,
    axes: tuple[str, str] = ("x", "y"),
    shown: bool = False,
) -> list[Trace]:
    """Return the misfit over the noise before and after, and the noise, as lines."""
    f = spectra.frequency
    floor = line(
        f[[0, -1]],
        np.ones(2),
        "noise",
        color=GREY,
        dash="dash",
        axes=axes,
        legend=shown,
    )
    traces = [floor]
    for values, name, color in (
        (spectra.misfit_before, "base model", BEFORE),
        (spectra.misfit_after, tried, AFTER),
    ):
        if name:
            traces.append(line(f, values, name, color=color, axes=axes, legend=shown))
    return traces


def spectrum_axes(spectra: Spectra) -> tuple[dict[str, object], dict[str, object]]:
    """Return the axes of `spectrum`, both logarithmic."""
    top = max(float(spectra.misfit_before.max()), _SMALLEST_TOP)
    span = [float(np.log10(_LOWEST_BAR)), float(np.log10(2.0 * top))]
    return axis("frequency [Hz]", log=True), axis(
        "misfit over noise [-]", log=True, range=span
    )


def response_function(spectra: Spectra, *, tried: str) -> Figure:
    """Return the measured and predicted response functions of the telling condition."""
    kept = np.isfinite(spectra.measured)
    f = spectra.frequency[kept]
    traces = [
        line(f, spectra.measured[kept], "measured", color=MEASURED, width=3.4),
        line(f, spectra.before[kept], "base model", color=BEFORE),
    ]
    if tried:
        traces.append(line(f, spectra.after[kept], tried, color=AFTER, dash="dot"))
    return figure(
        traces,
        axis("frequency [Hz]", log=True),
        axis(f"{spectra.channel} over force [{pretty(spectra.unit)}]", log=True),
    )


def wish_figure(wishes: Wishes, *, against: str, tried: str, unit: str) -> Figure:
    """Return the joint stiffness and damping each record would choose by itself.

    Args:
        wishes: of the records.
        against: `level` or `preload`.
        tried: legend of the model with the effects; empty where there is none.
        unit: of level and preload.
    """
    x = wishes.level if against == "level" else wishes.preload
    met = [float(value) for value in np.unique(x)]
    ticks: dict[str, Any] = {"tickvals": met, "ticktext": [f"{v:g}" for v in met]}
    traces: list[Trace] = []
    for column, (name, color) in enumerate((("base model", BEFORE), (tried, AFTER))):
        if name:
            shift = 1.0 + 0.03 * column
            traces += _wish_points(wishes, x * shift, column, name, color)
    return figure(
        traces,
        axis(f"{against} [{unit}]", log=True, domain=[0.0, 0.45], **ticks),
        axis("change of stiffness [%]"),
        xaxis2=axis(
            f"{against} [{unit}]", log=True, domain=[0.56, 1.0], anchor="y2", **ticks
        ),
        yaxis2=axis("change of damping [%]", anchor="x2"),
    )


def _wish_points(
    wishes: Wishes, x: FloatArray, column: int, name: str, color: str
) -> Sequence[Trace]:
    return [
        {
            **markers(
                x,
                100 * values[:, column],
                name,
                color=color,
                axes=axes,
                error=100 * sd[:, column],
            ),
            "showlegend": legend,
        }
        for values, sd, axes, legend in (
            (wishes.stiffness, wishes.stiffness_sd, ("x", "y"), True),
            (wishes.damping, wishes.damping_sd, ("x2", "y2"), False),
        )
    ]
