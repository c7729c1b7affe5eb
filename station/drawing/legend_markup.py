# SPDX-License-Identifier: MIT
"""Legends of figures: names beside samples of their lines, and scales of maps."""

from collections.abc import Mapping
from html import escape

import numpy as np

from jointbench.station.drawing.axis_scale import numbers_of
from jointbench.station.drawing.drawn_traces import (
    GLYPHS,
    attributes,
    map_range,
    text_of,
)
from jointbench.station.drawing.figure_parts import (
    FigureParts,
    Part,
    axis_title,
    part,
)
from jointbench.station.drawing.map_picture import VIRIDIS
from jointbench.station.drawing.palette import MODEL


def legend_entries(figure: Part) -> dict[str, str]:
    """Return the markup of each entry of a figure's legend, by its name."""
    layout, data = part(figure, "layout"), figure.get("data")
    traces = (
        [t for t in data if isinstance(t, Mapping)]
        if isinstance(data, list | tuple)
        else []
    )
    named = [t for t in traces if t.get("name") and t.get("showlegend") is not False]
    named = [t for t in named if t.get("type") not in ("heatmap",)]
    if layout.get("showlegend") is False:
        return {}
    found: dict[str, str] = {}
    for trace in named:
        found.setdefault(str(trace["name"]), _swatch(trace))
    return found


def figure_legend(parts: FigureParts) -> str:
    """Return the legend of a figure; a single name is left to the caption."""
    traces = [t for own in parts.columns for p in own for t in p.traces]
    found = legend_entries({"data": traces, "layout": parts.layout})
    least = 1 if parts.layout.get("showlegend") is True else 2
    return legend_markup(found) if len(found) >= least else ""


def legend_markup(entries: Mapping[str, str]) -> str:
    """Return a legend of entries by their names; empty without any."""
    if not entries:
        return ""
    listed = "".join(f"<li>{e}{text_of(name)}</li>" for name, e in entries.items())
    return f'<ul class="legend" aria-hidden="true">{listed}</ul>'


def _swatch(trace: Part) -> str:
    """Return the sample of a trace in a legend."""
    own, mark = part(trace, "line"), part(trace, "marker")
    mode = str(trace.get("mode", "lines+markers"))
    if trace.get("type") == "bar":
        return f"<i {attributes(mark.get('color'), 'sw block')}></i>"
    if "fill" in trace:
        return f"<i {attributes(trace.get('fillcolor'), 'sw area')}></i>"
    if "lines" in mode:
        dashed = " dashed" * (str(own.get("dash")) in ("dash", "dot"))
        return f"<i {attributes(own.get('color'), 'sw stroke' + dashed)}></i>"
    glyph = GLYPHS.get(str(mark.get("symbol")), "●")
    return (
        f"<i {attributes(mark.get('color'), 'sw glyph', otherwise=MODEL)}>{glyph}</i>"
    )


def bar_of_colours(parts: FigureParts) -> str:
    """Return the scale of the colours of a map; empty without one."""
    for own in parts.columns:
        for panel in own:
            for trace in panel.traces:
                rows = trace.get("z")
                if (
                    trace.get("type") == "heatmap"
                    and isinstance(rows, list | tuple)
                    and rows
                ):
                    values = np.stack([numbers_of(row) for row in rows])
                    low, high = map_range(trace, values)
                    unit = axis_title(part(trace, "colorbar"))
                    strip = escape(
                        f"background:linear-gradient(90deg,{','.join(VIRIDIS)})"
                    )
                    return (
                        f'<p class="scale">{low:.3g}<i style="{strip}"></i>{high:.3g} '
                        f"{text_of(unit)}</p>"
                    )
    return ""
