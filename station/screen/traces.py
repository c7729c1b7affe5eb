# SPDX-License-Identifier: MIT
"""Traces of a figure as plain dictionaries: lines, points, bands and maps.

Keys are those of plotly.js, of which `station.drawing` draws this part: `scatter`,
`bar`, `heatmap`, `scatter3d` and `mesh3d` on linear, logarithmic and category axes.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.station.drawing.palette import (
    GOOD,
    GUIDE,
    LAW,
    MEMBERS,
    MODEL,
    REFUSED,
)
from jointbench.station.screen.plot_numbers import numbers

Trace = Mapping[str, object]
PALETTE = (MODEL, REFUSED, GOOD, LAW, *MEMBERS[:2])
"""Roles by number, for figures of other packages; see `drawing.palette`."""
GREY = GUIDE


def line(
    x: Any,
    y: Any,
    name: str,
    *,
    color: str = MODEL,
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
    color: str = MODEL,
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
