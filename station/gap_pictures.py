# SPDX-License-Identifier: MIT
"""Pictures of a gap: before and after, in the record and the view that tell most."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.exhibit_records import Curves, Exhibit, Spectra, Wishes
from jointbench.analysis.gap.records import Gap, View
from jointbench.station.figures import (
    GREY,
    Figure,
    Trace,
    axis,
    band,
    figure,
    line,
    markers,
)

Pulls = Mapping[str, tuple[float, float]]
MEASURED, BEFORE, AFTER = "#1c2733", "#d1495b", "#0b5cab"
NOISE = "rgba(42, 157, 143, 0.22)"
LEGEND = {"orientation": "h", "x": 0, "yanchor": "bottom", "traceorder": "normal"}
TITLE_WIDTH = 76
LOWEST_BAR = 0.5
"""Where the bars of chi2/dof start: below 1, so that noise is seen as a stub."""
SMALLEST_TOP = 10.0
SHOWN = 0.6
"""Share of the misfit of the record that the first look holds; zoom out for more."""
SHORTEST_LOOK = 0.012
LONGEST_LOOK = 0.05
HALF_WIDTH = 0.62


def hero(
    exhibit: Exhibit,
    before: Gap,
    after: Gap | None,
    *,
    title: str,
    tried: str,
    pulls: Pulls,
) -> Figure:
    """Return the one picture of a gap.

    Args:
        exhibit: evidence of the diagnosis.
        before: gap of the base.
        after: gap with the effects; None where nothing was named.
        title: what was found, in words.
        tried: legend of the model with the effects; empty where there is none.
        pulls: of each base parameter, before and after [sd].
    """
    curves = exhibit.curves
    x, y, left = _panels(curves, tried)
    view = exhibit.view
    lines = textwrap.wrap(title, TITLE_WIDTH)
    traces = [*_response(curves, tried), *_misfit(curves, tried), *_left(curves, tried)]
    if view == "frequency":
        traces += _spectrum(exhibit.spectra, tried, axes=("x4", "y4"))
        x4, y4 = _spectrum_axes(exhibit.spectra)
    elif view == "sheet":
        traces += _pull_bars(pulls, shown=after is not None)
        x4, y4 = axis("base parameter", type="category"), axis("pull [sd]")
    else:
        traces += _bars(view, before, after, axes=("x4", "y4"))
        x4, y4 = _bar_axes(view, before)
    return figure(
        traces,
        x,
        y,
        **left,
        xaxis4=x4 | {"domain": [0.72, 1.0], "anchor": "y4"},
        yaxis4=y4 | {"domain": [0.0, 0.94], "anchor": "x4"},
        annotations=_headings(curves, view),
        title={
            "text": "<br>".join(lines),
            "font": {"size": 19},
            "pad": {"t": 16},
            **{"x": 0.0, "xanchor": "left", "y": 1.0, "yanchor": "top"},
        },
        margin={"l": 76, "r": 24, "t": 62 + 25 * len(lines), "b": 54},
        legend=LEGEND | {"y": 1.0},
    )


def pretty(unit: str) -> str:
    """Write powers in a unit as raised figures.

    >>> pretty("m/s^2/N")
    'm/s²/N'
    """
    for power, raised in (("^2", "²"), ("^3", "³")):
        unit = unit.replace(power, raised)
    return unit


def _panels(
    curves: Curves, tried: str
) -> tuple[dict[str, object], dict[str, object], dict[str, object]]:
    """Return the axes of response, misfit and what is left, one above the other."""
    look = _first_look(curves)
    times: dict[str, Any] = {"domain": [0.0, HALF_WIDTH], "range": look}
    unit = pretty(curves.unit)
    heights = ([0.63, 0.94], [0.30, 0.55], [0.0, 0.21])
    if not tried:
        heights = ([0.52, 0.94], [0.0, 0.40], [0.0, 0.0])
    x = axis("", **times, anchor="y", showticklabels=False)
    y = axis(f"{curves.channel} [{unit}]", domain=heights[0])
    more: dict[str, object] = {
        "xaxis2": axis(
            "" if tried else "time [ms]",
            **times,
            matches="x",
            anchor="y2",
            showticklabels=not tried,
        ),
        "yaxis2": axis(f"misfit [{unit}]", domain=heights[1], anchor="x2"),
    }
    if tried:
        more["xaxis3"] = axis("time [ms]", **times, matches="x", anchor="y3")
        more["yaxis3"] = axis(f"what is left [{unit}]", domain=heights[2], anchor="x3")
    return x, y, more


def _first_look(curves: Curves) -> list[float]:
    """Return the span of time that is shown at first [ms]."""
    power = np.cumsum(curves.misfit_before**2)
    start = float(curves.time[0])
    reach = start + SHORTEST_LOOK
    if power[-1] > 0:
        reach = float(curves.time[int(np.searchsorted(power, SHOWN * power[-1]))])
    span = min(max(1.3 * (reach - start), SHORTEST_LOOK), LONGEST_LOOK)
    return [1e3 * start, 1e3 * min(start + span, float(curves.time[-1]))]


def _response(curves: Curves, tried: str) -> list[Trace]:
    time = 1e3 * curves.time
    traces = [
        line(time, curves.measured, "measured", color=MEASURED, width=3.4),
        line(time, curves.before, "base model", color=BEFORE, width=1.7),
    ]
    if tried:
        traces.append(
            line(time, curves.after, tried, color=AFTER, width=1.7, dash="dot")
        )
    return traces


def _misfit(curves: Curves, tried: str) -> list[Trace]:
    time, axes = 1e3 * curves.time, ("x2", "y2")
    traces = [] if tried else _noise_band(curves, axes)
    traces.append(
        line(time, curves.misfit_before, "", color=BEFORE, axes=axes, legend=False)
    )
    if tried:
        traces.append(
            line(time, curves.misfit_after, "", color=AFTER, axes=axes, legend=False)
        )
    return traces


def _left(curves: Curves, tried: str) -> list[Trace]:
    if not tried:
        return []
    axes = ("x3", "y3")
    after = line(
        1e3 * curves.time,
        curves.misfit_after,
        "",
        color=AFTER,
        width=1.2,
        axes=axes,
        legend=False,
    )
    return [*_noise_band(curves, axes), after]


def _noise_band(curves: Curves, axes: tuple[str, str]) -> list[Trace]:
    ends = 1e3 * curves.time[[0, -1]]
    wide = np.full(2, 2.0 * curves.sigma)
    place = {"xaxis": axes[0], "yaxis": axes[1]}
    return [
        {**trace, **place}
        for trace in band(ends, -wide, wide, "noise (± 2 sd)", color=NOISE)
    ]


def _headings(curves: Curves, view: str) -> list[dict[str, object]]:
    shared: dict[str, object] = {
        "xref": "paper",
        "yref": "paper",
        "showarrow": False,
        "xanchor": "left",
    }
    shared |= {"y": 0.95, "yanchor": "bottom"}
    shared |= {"font": {"size": 13, "color": "#5b6b7b"}}
    left = f"record {curves.record}: {curves.channel}, {curves.condition}"
    right = "misfit over noise, by frequency"
    if view == "sheet":
        right = "how far the sheet is bent; up to 4 is fair"
    elif view != "frequency":
        right = f"chi2/dof by {view}, all records"
    return [{**shared, "x": 0.0, "text": left}, {**shared, "x": 0.70, "text": right}]


def view_grid(names: Sequence[str], before: Gap, after: Gap | None) -> Figure:
    """Return chi2/dof of each slice of several views, two views a row."""
    rows = -(-len(names) // 2)
    traces: list[Trace] = []
    layout: dict[str, Any] = {"legend": LEGEND | {"y": 1.0}}
    for k, name in enumerate(names):
        x, y = _bar_axes(name, before)
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
        own = _bars(name, before, after, axes=(f"x{number}", f"y{number}"))
        traces += [{**trace, "showlegend": k == 0} for trace in own]
    x, y = layout.pop("xaxis"), layout.pop("yaxis")
    return figure(traces, x, y, barmode="group", **layout)


def _bars(
    name: str, before: Gap, after: Gap | None, *, axes: tuple[str, str] = ("x", "y")
) -> list[Trace]:
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


def _bar_axes(name: str, gap: Gap) -> tuple[dict[str, object], dict[str, object]]:
    view = _view_of(gap, name)
    largest = max(view.chi2_per_dof.values(), default=1.0) if view else 1.0
    top = float(np.log10(3.0 * max(largest, SMALLEST_TOP)))
    return axis(name, type="category"), axis(
        "chi2/dof [-] (noise: 1)", log=True, range=[float(np.log10(LOWEST_BAR)), top]
    )


def misfit_spectrum(spectra: Spectra, *, tried: str) -> Figure:
    """Return the misfit of all records over the noise against frequency."""
    x, y = _spectrum_axes(spectra)
    return figure(_spectrum(spectra, tried, shown=True), x, y)


def _spectrum(
    spectra: Spectra,
    tried: str,
    *,
    axes: tuple[str, str] = ("x", "y"),
    shown: bool = False,
) -> list[Trace]:
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


def _spectrum_axes(spectra: Spectra) -> tuple[dict[str, object], dict[str, object]]:
    top = max(float(spectra.misfit_before.max()), SMALLEST_TOP)
    span = [float(np.log10(LOWEST_BAR)), float(np.log10(2.0 * top))]
    return axis("frequency [Hz]", log=True), axis(
        "misfit over noise [-]", log=True, range=span
    )


def _pull_bars(pulls: Pulls, *, shown: bool) -> list[Trace]:
    """Return how far each base parameter is off its sheet, before and after."""
    columns = ((0, BEFORE), (1, AFTER)) if shown else ((0, BEFORE),)
    return [
        {
            "type": "bar",
            "x": list(pulls),
            "y": [float(f"{abs(pull[column]):.4g}") for pull in pulls.values()],
            "text": [f"{abs(pull[column]):.2g}" for pull in pulls.values()],
            "textposition": "outside",
            "cliponaxis": False,
            "showlegend": False,
            "marker": {"color": color},
            "xaxis": "x4",
            "yaxis": "y4",
        }
        for column, color in columns
    ]


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


def wish_figure(wishes: Wishes, *, against: str, tried: str) -> Figure:
    """Return the joint stiffness and damping each record would choose by itself.

    Args:
        wishes: of the records.
        against: `level` or `preload`.
        tried: legend of the model with the effects; empty where there is none.
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
        axis(f"{against} [N]", log=True, domain=[0.0, 0.45], **ticks),
        axis("change of stiffness [%]"),
        xaxis2=axis(
            f"{against} [N]", log=True, domain=[0.56, 1.0], anchor="y2", **ticks
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
