# SPDX-License-Identifier: MIT
"""A figure taken apart: one panel for each pair of axes, in columns and rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from jointbench.station.drawing.axis_scale import AxisScale, axis_scale
from jointbench.station.drawing.drawn_intervals import interval_ends

Part = Mapping[str, object]
_EMPTY: Part = {}


@dataclass(frozen=True, slots=True)
class PanelParts:
    """What one panel shows.

    Attributes:
        key: axes of the panel, for example ("x2", "y2").
        traces: on them, and on axes drawn over them.
        x: settings of the axis along the panel.
        y: settings of the axis up the panel.
        over: name and settings of an axis drawn over `y`, at the right.
        column: place of the left edge in the figure, 0 to 1.
        span: lower and upper edge in the figure, 0 to 1.
        width: share of the width of the figure.
        last: whether the axis along the panel is written below it.
    """

    key: tuple[str, str]
    traces: tuple[Part, ...]
    x: Part
    y: Part
    over: tuple[str, Part] | None
    column: float
    span: tuple[float, float]
    width: float
    last: bool = True


@dataclass(frozen=True, slots=True)
class FigureParts:
    """A figure on axes.

    Attributes:
        layout: of the figure.
        columns: panels of each column from top to bottom, the left column first.
        scales: by the name of the axis.
    """

    layout: Part
    columns: tuple[tuple[PanelParts, ...], ...]
    scales: Mapping[str, AxisScale] = field(default_factory=dict)


def part(container: Part, key: str) -> Part:
    """Return a part of a figure that must be a mapping, else an empty one."""
    found = container.get(key)
    return found if isinstance(found, Mapping) else _EMPTY


def axis_title(settings: Part) -> str:
    """Return the title of an axis or of a scale of colours; empty without one."""
    found = settings.get("title")
    text = found.get("text", "") if isinstance(found, Mapping) else found
    return str(text) if text else ""


def figure_parts(figure: Part) -> FigureParts:
    """Take a figure apart.

    Args:
        figure: `data` and `layout`, in the form of `screen.figures`.
    """
    layout = part(figure, "layout")
    data = figure.get("data")
    listed = data if isinstance(data, list | tuple) else []
    traces = [t for t in listed if isinstance(t, Mapping)]
    groups: dict[tuple[str, str], list[Part]] = {}
    for trace in traces:
        x, y = _name(trace, "xaxis", "x"), _name(trace, "yaxis", "y")
        under = part(layout, _layout_key(y)).get("overlaying")
        key = (x, under if isinstance(under, str) else y)
        groups.setdefault(key, []).append(trace)
    panels = [_panel(layout, key, tuple(own)) for key, own in groups.items()]
    return FigureParts(layout, _columns(panels), _scales(layout, traces))


def _name(trace: Part, key: str, otherwise: str) -> str:
    found = trace.get(key)
    return found if isinstance(found, str) and found else otherwise


def _layout_key(name: str) -> str:
    """Return the key of an axis in the layout: y2 is at yaxis2."""
    return f"{name[:1]}axis{name[1:]}"


def _domain(settings: Part) -> tuple[float, float]:
    found = settings.get("domain")
    if isinstance(found, list | tuple) and len(found) == 2:
        return float(found[0]), float(found[1])
    return 0.0, 1.0


def _panel(layout: Part, key: tuple[str, str], traces: tuple[Part, ...]) -> PanelParts:
    x, y = (part(layout, _layout_key(one)) for one in key)
    others = {_name(t, "yaxis", "y") for t in traces} - {key[1]}
    over = next(iter(sorted(others)), None)
    left, right = _domain(x)
    return PanelParts(
        key,
        traces,
        x,
        y,
        None if over is None else (over, part(layout, _layout_key(over))),
        left,
        _domain(y),
        right - left,
    )


def _columns(panels: Sequence[PanelParts]) -> tuple[tuple[PanelParts, ...], ...]:
    """Return panels by column; only the last of one axis writes its marks."""
    places = sorted({round(p.column, 3) for p in panels})
    found = []
    for place in places:
        own = [p for p in panels if round(p.column, 3) == place]
        own.sort(key=lambda p: -p.span[1])
        shared = [_root(p) for p in own]
        found.append(
            tuple(
                PanelParts(
                    *(p.key, p.traces, p.x, p.y, p.over, p.column, p.span, p.width),
                    last=shared[k] not in shared[k + 1 :],
                )
                for k, p in enumerate(own)
            )
        )
    return tuple(found)


def _root(panel: PanelParts) -> str:
    """Return the axis along a panel, or the one that it follows."""
    follows = panel.x.get("matches")
    return follows if isinstance(follows, str) else panel.key[0]


def _scales(layout: Part, traces: Sequence[Part]) -> dict[str, AxisScale]:
    """Return the scale of every axis; axes that match share one."""
    values: dict[str, list[object]] = {}
    barred: set[str] = set()
    dotted: set[str] = set()
    for trace in traces:
        for side in "xy":
            name = _name(trace, f"{side}axis", side)
            follows = part(layout, _layout_key(name)).get("matches")
            root = follows if isinstance(follows, str) else name
            values.setdefault(root, []).extend(_extent(trace, side))
            if trace.get("type") == "bar" and side == "y":
                barred.add(root)
            points = "markers" in str(trace.get("mode", "")) or side == "y"
            if points and trace.get("type") != "heatmap":
                dotted.add(root)
    stacked = layout.get("barmode") == "stack"
    scales = {
        name: axis_scale(
            part(layout, _layout_key(name)),
            own,
            room=0.05 if name in dotted else 0.0,
            zero=name in barred or stacked,
        )
        for name, own in values.items()
    }
    for trace in traces:
        for side in "xy":
            name = _name(trace, f"{side}axis", side)
            follows = part(layout, _layout_key(name)).get("matches")
            if isinstance(follows, str) and follows in scales:
                scales[name] = scales[follows]
    return scales


def _extent(trace: Part, side: str) -> list[object]:
    """Return what an axis must show of a trace: its values, and their intervals."""
    if trace.get("type") == "heatmap":
        return [_edges(trace.get(side))]
    found: list[object] = [trace.get(side)]
    ends = interval_ends(trace, side)
    if ends is not None:
        found += [end.tolist() for end in ends]
    return found


def _edges(values: object) -> object:
    """Return the outer edges of the cells of a map, or the names of its categories."""
    if not isinstance(values, list | tuple) or len(values) < 1:
        return values
    if any(isinstance(v, str) for v in values):
        return values
    first, last = float(values[0]), float(values[-1])
    half = 0.5 * (last - first) / max(len(values) - 1, 1) or 0.5
    return [first - half, last + half]
