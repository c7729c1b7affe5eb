# SPDX-License-Identifier: MIT
"""Bodies and wires in three dimensions: a still view, and data to turn and move them.

The still view is SVG and is what prints. The script of the report draws the same data
on a canvas as soon as somebody turns the view or lets a shape move.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.drawing.axis_scale import numbers_of, plain_number
from jointbench.station.drawing.drawn_traces import attributes, text_of
from jointbench.station.drawing.figure_parts import Part, part
from jointbench.station.drawing.legend_markup import legend_entries, legend_markup
from jointbench.station.drawing.map_picture import map_colour
from jointbench.station.drawing.palette import GUIDE, MODEL

_SOLID = ("mesh3d", "scatter3d")
_EYE = (1.25, -1.6, 1.1)
_HALF = 2000
"""Units from the middle of a scene to its edge."""
_LIGHT = np.array([0.35, -0.55, 0.76])
_SHADES = 6
_TINTS = 16


@dataclass(frozen=True, slots=True, eq=False)
class SceneView:
    """How a scene is looked at: its middle, its scale, and the axes of the picture."""

    middle: FloatArray
    scale: float
    axes: FloatArray

    def of(self, points: FloatArray) -> FloatArray:
        """Return points right, up and towards the eye, shape (n, 3), in whole units."""
        return np.asarray((points - self.middle) * self.scale @ self.axes.T)


def is_solid(figure: Part) -> bool:
    """Return whether a figure is a scene in three dimensions."""
    return any(t.get("type") in _SOLID for t in _traces(figure))


def solid_markup(figure: Part, *, height: int) -> str:
    """Return a scene as markup.

    Args:
        figure: `data` of bodies and wires, `layout` with the scene, and optionally
            `swing`: the moving part of one wire.
        height: of the picture [px].
    """
    traces = _traces(figure)
    scene = part(part(figure, "layout"), "scene")
    swing = part(figure, "swing")
    points = [_points(t) for t in traces]
    view = _view(scene, points)
    every = np.concatenate([*points, *_swung(swing, points)])
    extent = view.of(every[_known(every)])
    drawn = [_drawn(t, p, view) for t, p in zip(traces, points, strict=True)]
    if swing:
        drawn.insert(0, _opposite(swing, traces, points, view))
    low, high = extent[:, :2].min(axis=0) - 120, extent[:, :2].max(axis=0) + 120
    box = f"{low[0]:.0f} {-high[1]:.0f} {high[0] - low[0]:.0f} {high[1] - low[1]:.0f}"
    data = _data(traces, points, view, swing)
    text = json.dumps(data, separators=(",", ":"))
    safe = text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
    return (
        f'{_legend(traces)}<div class="solid" style="height:{height}px">'
        f'<svg viewBox="{box}" preserveAspectRatio="xMidYMid meet" aria-hidden="true">'
        f"{''.join(drawn)}</svg>"
        f'<script type="application/json" class="scene">{safe}</script></div>'
        f"{_axes_words(scene, points)}"
    )


def _traces(figure: Part) -> list[Part]:
    data = figure.get("data")
    return (
        [t for t in data if isinstance(t, Mapping)]
        if isinstance(data, list | tuple)
        else []
    )


def _points(trace: Part) -> FloatArray:
    columns = [numbers_of(trace.get(key)) for key in "xyz"]
    size = min(c.size for c in columns)
    return np.stack([c[:size] for c in columns], axis=1)


def _known(points: FloatArray) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    return np.asarray(np.isfinite(points).all(axis=1))


def _view(scene: Part, points: Sequence[FloatArray]) -> SceneView:
    eye = part(part(scene, "camera"), "eye")
    given = [eye.get(k, e) for k, e in zip("xyz", _EYE, strict=True)]
    towards = numbers_of(given)
    towards = towards / float(np.linalg.norm(towards))
    right = np.array([-towards[1], towards[0], 0.0])
    right /= max(float(np.linalg.norm(right)), 1e-12)
    axes = np.stack([right, np.cross(towards, right), towards])
    every = np.concatenate(points)
    every = every[_known(every)]
    low, high = every.min(axis=0), every.max(axis=0)
    half = 0.5 * float(np.linalg.norm(high - low)) or 1.0
    return SceneView(0.5 * (low + high), _HALF / half, axes)


def _drawn(trace: Part, points: FloatArray, view: SceneView) -> str:
    if trace.get("type") == "mesh3d":
        return _mesh(trace, points, view)
    mode = str(trace.get("mode", "lines"))
    flat = view.of(points)
    color = part(trace, "line").get("color", part(trace, "marker").get("color"))
    found = ""
    if "lines" in mode:
        style = f"stroke-width:{0.6 * _width(trace):g}"
        said = attributes(color, "ln", style=style)
        found += f'<path {said} d="{_wire(flat)}"/>'
    if "markers" in mode:
        size = plain_number(part(trace, "marker").get("size"), 4.0)
        kept = flat[_known(points)]
        said = attributes(color, "dots", style=f"stroke-width:{size + 1:g}")
        found += f'<path {said} d="{_dots(kept)}"/>'
    if "text" in mode:
        for place, word in zip(flat, _listed(trace.get("text")), strict=False):
            said = attributes(color, "st")
            at = f'x="{place[0]:.0f}" y="{-place[1] - 60:.0f}"'
            found += f"<text {said} {at}>{text_of(word)}</text>"
    return found


def _wire(flat: FloatArray) -> str:
    found, pen = [], "M"
    for x, y, _ in flat.tolist():
        if x != x or y != y:
            pen = "M"
            continue
        found.append(f"{pen}{x:.0f} {-y:.0f}")
        pen = "L"
    return "".join(found)


def _dots(flat: FloatArray) -> str:
    return "".join(f"M{x:.0f} {-y:.0f}h0" for x, y, _ in flat.tolist())


def _swung(swing: Part, points: Sequence[FloatArray]) -> list[FloatArray]:
    """Return the moving wire half a cycle later; nothing where none moves."""
    if not swing:
        return []
    at = int(str(swing.get("trace", 0)))
    return [points[at] - 2.0 * _points(part(swing, "real"))]


def _opposite(
    swing: Part, traces: Sequence[Part], points: Sequence[FloatArray], view: SceneView
) -> str:
    """Return the moving wire half a cycle later, thin."""
    at = int(str(swing.get("trace", 0)))
    flat = view.of(_swung(swing, points)[0])
    color = part(traces[at], "line").get("color")
    said = attributes(color, "ln", style="stroke-width:1.4;stroke-dasharray:1.5 3.5")
    return f'<path {said} d="{_wire(flat)}"/>'


def _mesh(trace: Part, points: FloatArray, view: SceneView) -> str:
    """Return triangles from the far to the near, as few paths as colours allow."""
    corners = _corners(trace)
    flat = view.of(points)
    depth = flat[corners, 2].mean(axis=1)
    shade = _shade(points, corners)
    tint = _tint(trace, corners)
    whole = np.rint(flat).astype(int)
    style = f"opacity:{_opacity(trace):g}" if "opacity" in trace else ""
    color = trace.get("color")
    found: list[str] = []
    last, path = None, ""
    for at in np.argsort(depth).tolist():
        look = (int(shade[at]), -1 if tint is None else int(tint[at]))
        if look != last and path:
            found.append(_facets(last, path, color, style))
            path = ""
        a, b, c = whole[corners[at], :2].tolist()
        path += f"M{a[0]} {-a[1]}L{b[0]} {-b[1]} {c[0]} {-c[1]}z"
        last = look
    if path:
        found.append(_facets(last, path, color, style))
    return "".join(found)


def _facets(look: tuple[int, int] | None, path: str, color: object, style: str) -> str:
    assert look is not None
    light = 0.62 + 0.38 * look[0] / (_SHADES - 1)
    if look[1] < 0:
        said = attributes(color, "body", otherwise=GUIDE, style=style)
        return f'<path {said} d="{path}"/>'
    red, green, blue = (round(light * v) for v in map_colour(look[1] / (_TINTS - 1)))
    return (
        f'<path class="facet" style="--c:#{red:02x}{green:02x}{blue:02x}" d="{path}"/>'
    )


def _corners(trace: Part) -> np.ndarray[tuple[int, ...], np.dtype[np.intp]]:
    return np.stack([numbers_of(trace.get(k)).astype(np.intp) for k in "ijk"], axis=1)


def _shade(
    points: FloatArray, corners: np.ndarray[tuple[int, ...], np.dtype[np.intp]]
) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    a, b, c = (points[corners[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    light = np.abs(normal @ _LIGHT) / np.maximum(length, 1e-300)
    return np.asarray(np.rint(light * (_SHADES - 1)), np.int64)


def _tint(
    trace: Part, corners: np.ndarray[tuple[int, ...], np.dtype[np.intp]]
) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]] | None:
    if "intensity" not in trace:
        return None
    low, high = plain_number(trace.get("cmin"), 0), plain_number(trace.get("cmax"), 1)
    share = (numbers_of(trace["intensity"]) - low) / max(high - low, 1e-300)
    mean = np.clip(share[corners].mean(axis=1), 0, 1)
    return np.asarray(np.rint(mean * (_TINTS - 1)), np.int64)


def _data(
    traces: Sequence[Part], points: Sequence[FloatArray], view: SceneView, swing: Part
) -> dict[str, object]:
    """Return a scene for the script: whole numbers about the middle."""
    found: list[dict[str, object]] = []
    for at, (trace, place) in enumerate(zip(traces, points, strict=True)):
        one: dict[str, object] = {"p": _whole(place - view.middle, view.scale)}
        color = part(trace, "line").get("color", part(trace, "marker").get("color"))
        if trace.get("type") == "mesh3d":
            corners = _corners(trace)
            one |= {"t": corners.ravel().tolist(), "s": _shade(place, corners).tolist()}
            tint = _tint(trace, corners)
            one |= {"c": tint.tolist()} if tint is not None else {}
            one |= {"o": _opacity(trace)} if "opacity" in trace else {}
            color = trace.get("color")
        else:
            one |= {"m": str(trace.get("mode", "lines"))}
            one |= {"w": _width(trace)}
            one |= {"l": _listed(trace.get("text"))}
        one["k"] = attributes(color, "k", otherwise=MODEL if "t" not in one else GUIDE)
        if swing and at == int(str(swing.get("trace", 0))):
            one["re"] = _whole(_points(part(swing, "real")), view.scale)
            one["im"] = _whole(_points(part(swing, "imaginary")), view.scale)
        found.append(one)
    return {"axes": np.round(view.axes, 4).tolist(), "half": _HALF, "parts": found}


def _whole(points: FloatArray, scale: float) -> list[int | None]:
    return [
        round(v) if np.isfinite(v) else None for v in (points * scale).ravel().tolist()
    ]


def _listed(texts: object) -> list[str]:
    found = texts if isinstance(texts, list | tuple) else []
    return [visible(str(one)) for one in found]


def _width(trace: Part) -> float:
    return plain_number(part(trace, "line").get("width"), 2.0)


def _opacity(trace: Part) -> float:
    return min(max(plain_number(trace.get("opacity"), 1.0), 0.0), 1.0)


def _legend(traces: Sequence[Part]) -> str:
    wires = [t for t in traces if t.get("type") == "scatter3d"]
    found = legend_entries({"data": wires, "layout": {}})
    return legend_markup(found) if len(found) > 1 else ""


def _axes_words(scene: Part, points: Sequence[FloatArray]) -> str:
    """Return the extents along the axes that are titled and shown."""
    every = np.concatenate(points)
    every = every[_known(every)]
    words = []
    for k, key in enumerate("xyz"):
        settings = part(scene, f"{key}axis")
        if settings.get("visible") is False or not settings:
            continue
        title = part(settings, "title").get("text", key)
        words.append(f"{title}: {every[:, k].min():.3g} to {every[:, k].max():.3g}")
    return f'<p class="scale">{text_of("; ".join(words))}</p>' if words else ""
