# SPDX-License-Identifier: MIT
"""Figures as plain dictionaries in plotly.js's own format: axes and layout."""

from collections.abc import Mapping, Sequence

from jointbench.station.screen.traces import Trace

Figure = Mapping[str, object]

FONT = "system-ui, 'Segoe UI', Roboto, sans-serif"


def axis(title: str, *, log: bool = False, **more: object) -> dict[str, object]:
    """Return an axis with a title that names its unit."""
    result: dict[str, object] = {
        "title": {"text": title, "standoff": 8},
        "gridcolor": "#e8edf2",
        "zeroline": False,
        "linecolor": "#b8c2cc",
        "ticks": "outside",
        "tickcolor": "#b8c2cc",
        "automargin": True,
    }
    if log:
        result |= {"type": "log", "exponentformat": "power", "dtick": 1}
    return result | more


def figure(
    data: Sequence[Trace],
    x: Mapping[str, object],
    y: Mapping[str, object],
    **more: object,
) -> Figure:
    """Return a figure on one pair of axes; `more` adds or replaces layout keys."""
    layout: dict[str, object] = {
        "xaxis": dict(x),
        "yaxis": dict(y),
        "font": {"family": FONT, "size": 13, "color": "#1c2733"},
        "margin": {"l": 70, "r": 20, "t": 30, "b": 50},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "#ffffff",
        "hovermode": "closest",
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": "#b8c2cc"},
        "legend": {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom"},
    }
    return {"data": list(data), "layout": layout | more}
