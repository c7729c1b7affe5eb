# SPDX-License-Identifier: MIT
"""The summary figure of a gap: the representative record and most significant view."""

import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np

from jointbench.analysis.gap.model.diagnosis_record import Gap
from jointbench.analysis.gap.model.evidence_records import Curves, GapEvidence
from jointbench.station.drawing.palette import GOOD, MEASURED
from jointbench.station.report.gap_bars import (
    AFTER,
    BEFORE,
    LEGEND,
    bar_axes,
    bars,
)
from jointbench.station.report.gap_figures import pretty, spectrum, spectrum_axes
from jointbench.station.report.gap_sentences import PRIORS
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.traces import Trace, band, line

Deviations = Mapping[str, tuple[float, float]]
TITLE_WIDTH = 76
SHOWN = 0.6
"""Share of the record's residual in the initial time window; zoom out for more."""
SHORTEST_WINDOW = 0.012
LONGEST_WINDOW = 0.05
HALF_WIDTH = 0.62


def summary_figure(
    evidence: GapEvidence,
    before: Gap,
    after: Gap | None,
    *,
    title: str,
    tried: str,
    prior_deviations: Deviations,
) -> Figure:
    """Return the summary figure of a gap.

    Args:
        evidence: evidence of the diagnosis.
        before: gap of the base.
        after: gap with the effects; None where nothing was named.
        title: the finding, in words.
        tried: legend of the model with the effects; empty where there is none.
        prior_deviations: prior deviation of each base parameter, before and after [sd].
    """
    curves = evidence.curves
    x, y, left = _panels(curves, tried)
    view = evidence.view
    lines = textwrap.wrap(title, TITLE_WIDTH)
    traces = [
        *_response(curves, tried),
        *_residual(curves, tried),
        *_left(curves, tried),
    ]
    if view == "frequency":
        traces += spectrum(evidence.spectra, tried, axes=("x4", "y4"))
        x4, y4 = spectrum_axes(evidence.spectra)
    elif view == PRIORS:
        traces += _deviation_bars(prior_deviations, shown=after is not None)
        x4, y4 = axis("base parameter", type="category"), axis("prior deviation [sd]")
    else:
        traces += bars(view, before, after, axes=("x4", "y4"))
        x4, y4 = bar_axes(view, before)
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


def _panels(
    curves: Curves, tried: str
) -> tuple[dict[str, object], dict[str, object], dict[str, object]]:
    """Return the axes of response, residual and final residual, stacked."""
    window = _first_window(curves)
    times: dict[str, Any] = {"domain": [0.0, HALF_WIDTH], "range": window}
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
        "yaxis2": axis(f"residual [{unit}]", domain=heights[1], anchor="x2"),
    }
    if tried:
        more["xaxis3"] = axis("time [ms]", **times, matches="x", anchor="y3")
        more["yaxis3"] = axis(f"final [{unit}]", domain=heights[2], anchor="x3")
    return x, y, more


def _first_window(curves: Curves) -> list[float]:
    """Return the initial time window [ms]."""
    power = np.cumsum(curves.residual_before**2)
    start = float(curves.time[0])
    reach = start + SHORTEST_WINDOW
    if power[-1] > 0:
        reach = float(curves.time[int(np.searchsorted(power, SHOWN * power[-1]))])
    span = min(max(1.3 * (reach - start), SHORTEST_WINDOW), LONGEST_WINDOW)
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


def _residual(curves: Curves, tried: str) -> list[Trace]:
    time, axes = 1e3 * curves.time, ("x2", "y2")
    traces = [] if tried else _noise_band(curves, axes)
    traces.append(
        line(time, curves.residual_before, "", color=BEFORE, axes=axes, legend=False)
    )
    if tried:
        traces.append(
            line(time, curves.residual_after, "", color=AFTER, axes=axes, legend=False)
        )
    return traces


def _left(curves: Curves, tried: str) -> list[Trace]:
    if not tried:
        return []
    axes = ("x3", "y3")
    after = line(
        1e3 * curves.time,
        curves.residual_after,
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
        for trace in band(ends, -wide, wide, "noise (± 2 sd)", color=GOOD)
    ]


def _headings(curves: Curves, view: str) -> list[dict[str, object]]:
    shared: dict[str, object] = {
        "xref": "paper",
        "yref": "paper",
        "showarrow": False,
        "xanchor": "left",
    }
    shared |= {"y": 0.95, "yanchor": "bottom"}
    left = f"record {curves.record}: {curves.channel}, {curves.condition}"
    right = "residual over noise, by frequency"
    if view == PRIORS:
        right = "prior deviation; acceptable up to 4 sd"
    elif view != "frequency":
        right = f"chi2/dof by {view}, all records"
    return [{**shared, "x": 0.0, "text": left}, {**shared, "x": 0.70, "text": right}]


def _deviation_bars(prior_deviations: Deviations, *, shown: bool) -> list[Trace]:
    """Return bars of each base parameter's prior deviation, before and after."""
    columns = ((0, BEFORE), (1, AFTER)) if shown else ((0, BEFORE),)
    return [
        {
            "type": "bar",
            "x": list(prior_deviations),
            "y": [
                float(f"{abs(deviation[column]):.4g}")
                for deviation in prior_deviations.values()
            ],
            "text": [
                f"{abs(deviation[column]):.2g}"
                for deviation in prior_deviations.values()
            ],
            "textposition": "outside",
            "cliponaxis": False,
            "showlegend": False,
            "marker": {"color": color},
            "xaxis": "x4",
            "yaxis": "y4",
        }
        for column, color in columns
    ]
