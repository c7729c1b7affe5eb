# SPDX-License-Identifier: MIT
"""Small vocabulary of plots: plain dictionaries in plotly.js's own figure format."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Trace = Mapping[str, object]
Figure = Mapping[str, object]
_Values = NDArray[np.floating[Any]]

PALETTE = ("#0b5cab", "#d1495b", "#2a9d8f", "#e09f3e", "#7b4b94", "#5b6b7b")
GREY = "#8a97a5"
_SIGNIFICANT_DIGITS = 6
FONT = "system-ui, 'Segoe UI', Roboto, sans-serif"


def numbers(values: Any) -> list[float | None]:
    """Return numbers rounded for plotting; what is not finite leaves a gap."""
    array = np.asarray(values, dtype=np.float64)
    return [
        float(f"{v:.{_SIGNIFICANT_DIGITS}g}") if np.isfinite(v) else None for v in array
    ]


def line(
    x: Any,
    y: Any,
    name: str,
    *,
    color: str = PALETTE[0],
    dash: str = "solid",
    width: float = 1.6,
    axes: tuple[str, str] = ("x", "y"),
    legend: bool = True,
) -> Trace:
    """Return a line."""
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers(x),
        "y": numbers(y),
        "name": name,
        "showlegend": legend,
        "line": {"color": color, "width": width, "dash": dash},
        "xaxis": axes[0],
        "yaxis": axes[1],
    }


def markers(
    x: Any,
    y: Any,
    name: str,
    *,
    color: str = PALETTE[0],
    symbol: str = "circle",
    size: float = 7,
    axes: tuple[str, str] = ("x", "y"),
    error: Any = None,
) -> Trace:
    """Return points, with symmetric error bars when `error` is given."""
    trace: dict[str, object] = {
        "type": "scatter",
        "mode": "markers",
        "x": numbers(x),
        "y": numbers(y),
        "name": name,
        "marker": {"color": color, "size": size, "symbol": symbol},
        "xaxis": axes[0],
        "yaxis": axes[1],
    }
    if error is not None:
        trace["error_y"] = {"array": numbers(error), "thickness": 1, "width": 2}
    return trace


def band(x: Any, low: Any, high: Any, name: str, *, color: str) -> list[Trace]:
    """Return a shaded interval between two curves."""
    edge = {"color": color, "width": 0}
    base = {"type": "scatter", "mode": "lines", "x": numbers(x), "hoverinfo": "skip"}
    return [
        {**base, "y": numbers(low), "line": edge, "showlegend": False},
        {
            **base,
            "y": numbers(high),
            "line": edge,
            "name": name,
            "fill": "tonexty",
            "fillcolor": color,
        },
    ]


def heatmap(x: Any, y: Any, z: NDArray[np.float64], unit: str) -> Trace:
    """Return a map of values, rows along y."""
    return {
        "type": "heatmap",
        "x": numbers(x),
        "y": numbers(y),
        "z": [numbers(row) for row in z],
        "colorscale": "Viridis",
        "colorbar": {"title": {"text": unit}, "thickness": 12},
    }


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


def thin(x: _Values, y: _Values, most: int) -> tuple[_Values, _Values]:
    """Thin a long line to about `most` points and keep its envelope (min and max)."""
    if x.size <= most:
        return x, y
    group = -(-x.size // (most // 2))
    whole = x.size - x.size % group
    rows = y[:whole].reshape(-1, group)
    start = np.arange(rows.shape[0]) * group
    pair = np.sort(
        np.stack([start + rows.argmin(1), start + rows.argmax(1)], 1), axis=1
    )
    keep = np.unique(np.append(pair.ravel(), x.size - 1))
    return x[keep], y[keep]
