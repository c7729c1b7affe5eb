# SPDX-License-Identifier: MIT
"""One panel of a figure: SVG that stretches, marks and titles that do not."""

from collections.abc import Mapping, Sequence

import numpy as np

from jointbench.station.drawing.axis_scale import (
    AxisScale,
    axis_marks,
    numbers_of,
    plain_number,
)
from jointbench.station.drawing.drawn_traces import (
    MOST_ACROSS_ON_PHONE,
    attributes,
    drawn_traces,
    text_of,
)
from jointbench.station.drawing.figure_parts import (
    FigureParts,
    PanelParts,
    Part,
    axis_title,
    part,
)
from jointbench.station.drawing.palette import GUIDE
from jointbench.station.drawing.svg_paths import HEIGHT, WIDTH

_LEAST_HEIGHT = 64
_FLATTEST = 6.0
_MOST_ON_PHONE = 4
"""Marks along a panel that a phone has room for; else every second is left out."""


def margins(parts: FigureParts, column: Sequence[PanelParts]) -> str:
    """Return the style of a column: letters of the longest marks at left and right.

    Args:
        parts: of the figure.
        column: its panels, which share their left and right edges.
    """
    left = [t for p in column for _, t in axis_marks(parts.scales[p.key[1]], p.y)]
    right = [
        text
        for p in column
        if p.over is not None
        for _, text in axis_marks(parts.scales[p.over[0]], p.over[1])
    ]
    wide, over = (max((len(t) for t in one), default=0) for one in (left, right))
    return f"--w:{min(max(wide, 1), 18)};--r:{over}"


def panel_markup(parts: FigureParts, panel: PanelParts, tall: int) -> str:
    """Return one panel: axes, marks, traces.

    Args:
        parts: of the figure.
        panel: of it.
        tall: height of all panels of a column [px].
    """
    x, y = parts.scales[panel.key[0]], parts.scales[panel.key[1]]
    drawn = drawn_traces(panel.traces, parts.scales, parts.layout)
    below, above = _shapes(parts, panel, x, y)
    high = max(round(tall * (panel.span[1] - panel.span[0])), _LEAST_HEIGHT)
    x_marks = axis_marks(x, panel.x)
    y_marks = axis_marks(y, panel.y)
    size = f"height:{high}px"
    equal = panel.y.get("scaleanchor") or panel.x.get("scaleanchor")
    most = ""
    if equal:
        plain = not (x.names or y.names)
        ratio = (x.high - x.low) / (y.high - y.low) if plain else 1.0
        ratio = min(max(ratio, 1 / _FLATTEST), _FLATTEST)
        size = f"aspect-ratio:{ratio:.4g}"
        most = f' style="max-width:{ratio * high + 50:.0f}px"'
    over = over_title = ""
    if panel.over is not None:
        name, settings = panel.over
        marks = axis_marks(parts.scales[name], settings)
        over = _y_marks(marks, "over")
        over_title = f'<span class="yt over">{text_of(axis_title(settings))}</span>'
    grid = _grid(x_marks, y_marks, names=bool(x.names))
    labels = panel.last and panel.x.get("showticklabels") is not False
    last = _x_marks(x_marks, x) if labels else ""
    title = (
        f'<p class="xt">{text_of(axis_title(panel.x))}</p>'
        if labels and axis_title(panel.x)
        else ""
    )
    return (
        f'<div class="panel"{most} {_ends(x, y)}{_reach(panel, x)}>'
        f'<p class="yts"><span class="yt">{text_of(axis_title(panel.y))}</span>'
        f"{over_title}</p>"
        f'<div class="rowed">{_y_marks(y_marks)}<div class="box" style="{size}">'
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" preserveAspectRatio="none" '
        f'aria-hidden="true">{grid}{below}{drawn.svg}{above}</svg>'
        f"{drawn.over}{_notes(parts, panel, x, y)}</div>{over}</div>{last}{title}</div>"
    )


def _ends(x: AxisScale, y: AxisScale) -> str:
    """Return the ends of both axes for the script that zooms."""
    if x.names or y.names or x.turned or y.turned:
        return ""
    return " ".join(
        f'data-{name}="{s.low:.9g} {s.high:.9g} {int(s.log)}"'
        for name, s in (("x", x), ("y", y))
    )


def _reach(panel: PanelParts, x: AxisScale) -> str:
    """Return how far the traces go beyond an axis whose range is set."""
    if "range" not in panel.x or x.names or x.turned:
        return ""
    places = [x.places(trace.get("x")) for trace in panel.traces]
    every = np.concatenate([p[np.isfinite(p)] for p in places] or [np.zeros(0)])
    if not every.size or (every.min() >= 0.0 and every.max() <= 1.0):
        return ""
    low, high = min(float(every.min()), 0.0), max(float(every.max()), 1.0)
    return f' data-reach="{max(low, -20.0):.4g} {min(high, 20.0):.4g}"'


def _grid(
    x_marks: list[tuple[float, str]], y_marks: list[tuple[float, str]], *, names: bool
) -> str:
    across = "".join(f"M{round(p * WIDTH)} 0V{HEIGHT}" for p, _ in x_marks if not names)
    up = "".join(f"M0 {round((1 - p) * HEIGHT)}H{WIDTH}" for p, _ in y_marks)
    return f'<path class="grid gx" d="{across}"/><path class="grid gy" d="{up}"/>'


def _y_marks(marks: list[tuple[float, str]], side: str = "") -> str:
    written = "".join(
        f'<span style="--y:{round((1 - p) * HEIGHT)}">{text_of(t)}</span>'
        for p, t in marks
    )
    return f'<div class="ym {side}">{written}</div>'


def _x_marks(marks: list[tuple[float, str]], scale: AxisScale) -> str:
    """Return the marks below a panel; names stand at a slant where they are long."""
    letters = sum(len(t) for _, t in marks)
    kind = "xm slant" if scale.names and letters > 40 else "xm"
    kind += " dense" * (len(marks) > MOST_ACROSS_ON_PHONE)
    many = len(marks) > _MOST_ON_PHONE
    written = "".join(
        f'<span style="--x:{round(p * WIDTH)}"{" class=odd" * (many and k % 2)}>'
        f"{text_of(t)}</span>"
        for k, (p, t) in enumerate(marks)
    )
    long = max((len(t) for _, t in marks), default=0)
    return f'<div class="{kind}" style="--l:{min(long, 24)}">{written}</div>'


def _shapes(
    parts: FigureParts, panel: PanelParts, x: AxisScale, y: AxisScale
) -> tuple[str, str]:
    """Return lines and boxes of the layout that lie in a panel, below and above."""
    found: dict[bool, list[str]] = {True: [], False: []}
    shapes = parts.layout.get("shapes")
    for shape in shapes if isinstance(shapes, list | tuple) else []:
        if not isinstance(shape, Mapping):
            continue
        own_x, own_y = str(shape.get("xref", "x")), str(shape.get("yref", "y"))
        if not ({own_x, own_y} - {"paper"} <= set(panel.key)):
            continue
        across = _span(shape, "x", x if own_x != "paper" else None)
        up = _span(shape, "y", y if own_y != "paper" else None)
        if not np.isfinite([*across, *up]).all():
            continue
        (x0, x1), (y0, y1) = (
            [round(p * WIDTH) for p in across],
            [round((1 - p) * HEIGHT) for p in up],
        )
        line = part(shape, "line")
        if shape.get("type") == "rect":
            fill = shape.get("fillcolor")
            kind = attributes(fill, "area" + " own" * str(fill).startswith("rgba"))
            drawn = f'<path {kind} d="M{x0} {y0}H{x1}V{y1}H{x0}z"/>'
        else:
            dash = {"dash": "6 4", "dot": "1.5 3.5"}.get(str(line.get("dash")), "")
            style = (
                f"stroke-width:{plain_number(line.get('width'), 1.0):g}"
                + f";stroke-dasharray:{dash}" * bool(dash)
            )
            kind = attributes(line.get("color"), "ln", otherwise=GUIDE, style=style)
            drawn = f'<path {kind} d="M{x0} {y0}L{x1} {y1}"/>'
        found[shape.get("layer") == "below"].append(drawn)
    return "".join(found[True]), "".join(found[False])


def _span(shape: Part, side: str, scale: AxisScale | None) -> list[float]:
    ends = [shape.get(f"{side}0", 0), shape.get(f"{side}1", 1)]
    if scale is None:
        return [float(one) for one in numbers_of(ends)]
    return [float(one) for one in scale.places(ends)]


def _notes(parts: FigureParts, panel: PanelParts, x: AxisScale, y: AxisScale) -> str:
    """Return the annotations at places of a panel."""
    notes = parts.layout.get("annotations")
    found = []
    for note in notes if isinstance(notes, list | tuple) else []:
        if not isinstance(note, Mapping) or note.get("xref") == "paper":
            continue
        if (note.get("xref", "x"), note.get("yref", "y")) != panel.key:
            continue
        across, up = x.places([note.get("x")])[0], y.places([note.get("y")])[0]
        if np.isfinite(across) and np.isfinite(up):
            at = f"--x:{round(across * WIDTH)};--y:{round((1 - up) * HEIGHT)}"
            found.append(
                f'<b class="tx" style="{at}">{text_of(note.get("text", ""))}</b>'
            )
    return "".join(found)
