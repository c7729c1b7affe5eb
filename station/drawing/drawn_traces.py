# SPDX-License-Identifier: MIT
"""Traces of a panel as SVG, and the marks and numbers that lie over it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.drawing.axis_scale import AxisScale, numbers_of
from jointbench.station.drawing.css_colours import colour_attributes
from jointbench.station.drawing.drawn_intervals import interval_ends
from jointbench.station.drawing.figure_parts import part
from jointbench.station.drawing.map_picture import legible_on, map_address
from jointbench.station.drawing.palette import MODEL
from jointbench.station.drawing.svg_paths import (
    HEIGHT,
    WIDTH,
    area_path,
    bars_path,
    dots_path,
    level_spans_path,
    line_path,
    on_grid,
    spans_path,
)

GLYPHS = {
    "diamond": "◆",
    "x": "×",
    "triangle-down": "▼",
    "square-open": "□",
    "circle-open": "○",
    "arrow-bar-up": "↥",
}
"""Marks that are written; all others are dots."""
_DASHES = {"dash": "6 4", "dot": "1.5 3.5", "dashdot": "6 3 1.5 3"}
_MOST_GLYPHS = 400
_MOST_NUMBERS = 400
MOST_ACROSS_ON_PHONE = 10
"""Columns of a map whose numbers and names a phone has room for."""
_BAR_WIDTH = 0.8


@dataclass(frozen=True, slots=True)
class Drawn:
    """What a trace adds to its panel: SVG, and HTML over it."""

    svg: str = ""
    over: str = ""


def text_of(value: object) -> str:
    """Return a text of a figure for the report: escaped, every character shown."""
    return escape(visible(str(value)))


def attributes(
    trace_colour: object, kind: str, *, otherwise: str = MODEL, style: str = ""
) -> str:
    """Return the class and style attributes of a drawn element."""
    name, own = colour_attributes(trace_colour, otherwise=otherwise)
    styles = ";".join(one for one in (own, style) if one)
    said = f' style="{escape(styles)}"' if styles else ""
    return f'class="{" ".join(filter(None, (kind, name)))}"{said}'


def drawn_traces(
    traces: Sequence[Mapping[str, object]],
    scales: Mapping[str, AxisScale],
    layout: Mapping[str, object],
) -> Drawn:
    """Draw the traces of one panel, areas and maps below lines, lines below points.

    Args:
        traces: of the panel, in the order of the figure.
        scales: by the name of the axis.
        layout: of the figure: how bars stand.
    """
    svg, over = [], []
    bars = [t for t in traces if t.get("type") == "bar"]
    if bars:
        made = _bars(bars, scales, stacked=layout.get("barmode") == "stack")
        svg.append(made.svg)
        over.append(made.over)
    for number, trace in enumerate(traces):
        x, y = _axes(trace, scales)
        if trace.get("type") == "heatmap":
            made = _map(trace, x, y)
        elif trace.get("type", "scatter") in ("scatter", "scattergl"):
            made = _scatter(trace, traces[number - 1] if number else None, x, y)
        else:
            continue
        svg.append(made.svg)
        over.append(made.over)
    return Drawn("".join(svg), "".join(over))


def _axes(
    trace: Mapping[str, object], scales: Mapping[str, AxisScale]
) -> tuple[AxisScale, AxisScale]:
    return scales[str(trace.get("xaxis") or "x")], scales[
        str(trace.get("yaxis") or "y")
    ]


def _scatter(
    trace: Mapping[str, object],
    before: Mapping[str, object] | None,
    x: AxisScale,
    y: AxisScale,
) -> Drawn:
    mode = str(trace.get("mode", "lines+markers"))
    own, mark = part(trace, "line"), part(trace, "marker")
    across, up = _same_length(x.places(trace.get("x")), y.places(trace.get("y")))
    svg, over = [], []
    if trace.get("fill") == "tonexty" and before is not None:
        low = y.places(before.get("y"))
        _, low = _same_length(across, low)
        path = area_path(across[: low.size], low, up[: low.size])
        color = trace.get("fillcolor", own.get("color"))
        plain = str(color).startswith("rgba")
        svg.append(f'<path {attributes(color, "area" + " own" * plain)} d="{path}"/>')
    width = own.get("width", 1.6)
    thick = float(width) if isinstance(width, int | float) else 1.6
    if "lines" in mode and thick > 0:
        dash = _DASHES.get(str(own.get("dash")), "")
        style = f"stroke-width:{thick:g}" + (f";stroke-dasharray:{dash}" * bool(dash))
        said = attributes(own.get("color"), "ln", style=style)
        svg.append(f'<path {said} d="{line_path(across, up)}"/>')
    color = mark.get("color", own.get("color"))
    svg += [
        f'<path {attributes(color, "ln span")} d="{path}"/>'
        for path in _spans(trace, across, up, x, y)
    ]
    if "markers" in mode:
        made = _marks(mark, color, across, up)
        svg.append(made.svg)
        over.append(made.over)
    if "text" in mode:
        over.append(_texts(trace, across, up))
    return Drawn("".join(svg), "".join(over))


def _spans(
    trace: Mapping[str, object],
    across: FloatArray,
    up: FloatArray,
    x: AxisScale,
    y: AxisScale,
) -> Iterator[str]:
    """Yield the paths of the intervals of points, upright and level."""
    upright, level = interval_ends(trace), interval_ends(trace, "x")
    if upright is not None:
        low, high = (y.places(end.tolist()) for end in upright)
        yield spans_path(across, np.nan_to_num(low, nan=-1.0), high)
    if level is not None:
        left, right = (x.places(end.tolist()) for end in level)
        yield level_spans_path(np.nan_to_num(left, nan=-1.0), right, up)


def _same_length(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    size = min(x.size, y.size)
    return x[:size], y[:size]


def _marks(
    mark: Mapping[str, object], color: object, x: FloatArray, y: FloatArray
) -> Drawn:
    size = mark.get("size", 7)
    wide = float(size) if isinstance(size, int | float) else 7.0
    glyph = GLYPHS.get(str(mark.get("symbol")))
    if glyph is None or x.size > _MOST_GLYPHS:
        said = attributes(color, "dots", style=f"stroke-width:{min(wide, 14):g}")
        return Drawn(f'<path {said} d="{dots_path(x, y)}"/>')
    across, down, known = on_grid(x, y)
    written = [
        f"<i {attributes(color, 'mk', style=_at(a, b, f'font-size:{wide + 5:g}px'))}>"
        f"{glyph}</i>"
        for a, b in zip(across[known].tolist(), down[known].tolist(), strict=True)
    ]
    return Drawn("", "".join(written))


def _at(across: int, down: int, more: str = "") -> str:
    return f"--x:{across};--y:{down}" + (f";{more}" if more else "")


def _texts(trace: Mapping[str, object], x: FloatArray, y: FloatArray) -> str:
    texts = trace.get("text")
    listed = list(texts) if isinstance(texts, list | tuple) else []
    stated = trace.get("textposition", "top")
    sides = stated if isinstance(stated, list | tuple) else [stated] * len(listed)
    across, down, known = on_grid(x, y)
    return "".join(
        f'<b class="tx {_side(str(side))}" style="{_at(int(a), int(b))}">'
        f"{text_of(t).strip()}</b>"
        for a, b, ok, t, side in zip(across, down, known, listed, sides, strict=False)
        if ok and str(t).strip()
    )


def _side(stated: str) -> str:
    """Return the class of a text by its ``textposition``."""
    if stated.startswith("bottom"):
        return "below"
    return "left" if "left" in stated else "right" if "right" in stated else "above"


def _bars(
    bars: Sequence[Mapping[str, object]],
    scales: Mapping[str, AxisScale],
    *,
    stacked: bool,
) -> Drawn:
    svg, over = [], []
    base: dict[str, float] = {}
    each = _BAR_WIDTH / (1 if stacked else len(bars))
    for number, bar in enumerate(bars):
        x, y = _axes(bar, scales)
        names = bar.get("x")
        listed = list(names) if isinstance(names, list | tuple) else []
        heights = numbers_of(bar.get("y"))
        step = 1.0 / (x.high - x.low)
        if not x.names and len(listed) > 1:
            step *= float(np.min(np.diff(np.sort(numbers_of(listed)))))
        left = -0.5 * _BAR_WIDTH + (0 if stacked else number * each)
        places = x.places(listed)
        texts = bar.get("text")
        said = list(texts) if isinstance(texts, list | tuple) else []
        color = part(bar, "marker").get("color")
        for at, (place, height) in enumerate(zip(places, heights, strict=False)):
            below = base.get(str(listed[at]), 0.0) if stacked else 0.0
            ends = y.places([below, below + height])
            low = 0.0 if y.log or not np.isfinite(ends[0]) else float(ends[0])
            high = float(ends[1])
            base[str(listed[at])] = below + float(height)
            if not (np.isfinite(place) and np.isfinite(high)):
                continue
            a, b = place + left * step, place + (left + each) * step
            path = bars_path(np.array([a]), np.array([b]), low, high)
            words = said[at] if at < len(said) else f"{height:.4g}"
            title = text_of(f"{listed[at]}, {bar.get('name', '')}: {words}")
            kind = attributes(color, "bar")
            svg.append(f'<path {kind} d="{path}"><title>{title}</title></path>')
            if said and bar.get("textposition", "auto") != "none" and at < len(said):
                middle = round(0.5 * (a + b) * WIDTH)
                top = round((1 - min(high, 1.0)) * HEIGHT)
                place_ = _at(middle, top)
                over.append(
                    f'<b class="tx above" style="{place_}">{text_of(said[at])}</b>'
                )
    return Drawn("".join(svg), "".join(over))


def _map(trace: Mapping[str, object], x: AxisScale, y: AxisScale) -> Drawn:
    rows = trace.get("z")
    if not isinstance(rows, list | tuple) or not rows:
        return Drawn()
    values = np.stack([numbers_of(row) for row in rows])
    low, high = map_range(trace, values)
    down = y.places(trace.get("y"))
    across = x.places(trace.get("x"))
    shown = values if _falls(down) else values[::-1]
    left, right = _outer(across)
    bottom, top = _outer(down)
    (x0, x1), (y0, y1), _ = on_grid(np.array([left, right]), np.array([bottom, top]))
    picture = (
        f'<image href="{map_address(shown, low, high)}" x="{x0}" y="{y1}" '
        f'width="{x1 - x0}" height="{y0 - y1}" preserveAspectRatio="none"/>'
    )
    return Drawn(picture, _map_numbers(trace, values, (across, down), (low, high)))


def map_range(trace: Mapping[str, object], values: FloatArray) -> tuple[float, float]:
    """Return the values of the first and the last colour of a map."""
    known = values[np.isfinite(values)]
    ends = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    low, high = trace.get("zmin"), trace.get("zmax")
    return (
        float(low) if isinstance(low, int | float) else ends[0],
        float(high) if isinstance(high, int | float) else ends[1],
    )


def _falls(places: FloatArray) -> bool:
    """Return whether the first row of a map lies at the top."""
    return places.size > 1 and bool(places[0] > places[-1])


def _outer(places: FloatArray) -> tuple[float, float]:
    low, high = float(np.min(places)), float(np.max(places))
    half = 0.5 * (high - low) / max(places.size - 1, 1) or 0.5
    return low - half, high + half


def _map_numbers(
    trace: Mapping[str, object],
    values: FloatArray,
    places: tuple[FloatArray, FloatArray],
    ends: tuple[float, float],
) -> str:
    texts = trace.get("text")
    if not isinstance(texts, list | tuple) or values.size > _MOST_NUMBERS:
        return ""
    span = max(ends[1] - ends[0], 1e-300)
    kind = "tx cell dense" if values.shape[1] > MOST_ACROSS_ON_PHONE else "tx cell"
    found = []
    for row, (cells, up) in enumerate(zip(texts, places[1], strict=False)):
        for column, (cell, along) in enumerate(zip(cells, places[0], strict=False)):
            share = (values[row, column] - ends[0]) / span
            at = _at(round(along * WIDTH), round((1 - up) * HEIGHT))
            found.append(
                f'<b class="{kind}" style="{at};color:{legible_on(share)}">'
                f"{text_of(cell)}</b>"
            )
    return "".join(found)
