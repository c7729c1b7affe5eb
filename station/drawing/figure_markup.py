# SPDX-License-Identifier: MIT
"""A figure as markup: SVG that stretches with the window, and text that does not."""

from collections.abc import Mapping, Sequence

from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.drawing.axis_scale import plain_number
from jointbench.station.drawing.drawn_traces import text_of
from jointbench.station.drawing.figure_parts import (
    FigureParts,
    PanelParts,
    Part,
    axis_title,
    figure_parts,
)
from jointbench.station.drawing.legend_markup import bar_of_colours, figure_legend
from jointbench.station.drawing.panel_markup import margins, panel_markup
from jointbench.station.drawing.solid_markup import is_solid, solid_markup

_AROUND = 84
"""Height of titles and marks around the panel of a figure [px]."""
_MOST_NAMED = 3


def figure_markup(figure: Part, *, height: int, caption: str = "") -> tuple[str, str]:
    """Return a figure as markup, and what it shows in words.

    Args:
        figure: `data` and `layout`, in the form of `screen.figures`.
        height: of the whole figure [px].
        caption: of the figure, which begins the words.
    """
    if is_solid(figure):
        return solid_markup(figure, height=height), caption
    parts = figure_parts(figure)
    tall = max(height - _AROUND, 90)
    columns = "".join(
        f'<div class="column" style="--share:{own[0].width:.3g};{margins(parts, own)}">'
        + "".join(
            heading + panel_markup(parts, one, tall)
            for heading, one in zip(_headings(parts, own), own, strict=True)
        )
        + "</div>"
        for own in parts.columns
    )
    around = f'<div class="columns">{columns}</div>'
    shown = f"{figure_legend(parts)}{around}{bar_of_colours(parts)}"
    return shown, _words(parts, caption)


def _words(parts: FigureParts, caption: str) -> str:
    """Return what the figure shows: axes and names."""
    panels = [p for own in parts.columns for p in own]
    axes = [
        f"{axis_title(p.y)} over {axis_title(p.x) or 'the same axis'}"
        for p in panels
        if axis_title(p.y)
    ]
    names = dict.fromkeys(
        str(t["name"]) for p in panels for t in p.traces if t.get("name")
    )
    listed = list(names)
    shown = ", ".join(listed[: 2 * _MOST_NAMED])
    more = f" and {len(listed) - 2 * _MOST_NAMED} more" * (
        len(listed) > 2 * _MOST_NAMED
    )
    words = [caption.rstrip(".")] if caption else []
    words += [f"Axes: {'; '.join(dict.fromkeys(axes))}"] if axes else []
    words += [f"Shown: {shown}{more}"] if listed else []
    return visible(". ".join(words))


def _headings(parts: FigureParts, own: Sequence[PanelParts]) -> list[str]:
    """Return the annotations above each panel of a column: those nearest to its top."""
    found = [""] * len(own)
    notes = parts.layout.get("annotations")
    starts = [column[0].column for column in parts.columns]
    for note in notes if isinstance(notes, list | tuple) else []:
        if not isinstance(note, Mapping) or note.get("xref") != "paper":
            continue
        across, up = plain_number(note.get("x"), 0.0), plain_number(note.get("y"), 1.0)
        nearest = min(starts, key=lambda start: abs(start - across))
        if nearest == own[0].column and note.get("text"):
            tops = [abs(panel.span[1] - up) for panel in own]
            words = f'<p class="heading">{text_of(note["text"])}</p>'
            found[tops.index(min(tops))] += words
    if len(starts) > 1 and not found[0] and _has_headings(parts):
        found[0] = '<p class="heading"></p>'
    return found


def _has_headings(parts: FigureParts) -> bool:
    notes = parts.layout.get("annotations")
    listed = notes if isinstance(notes, list | tuple) else []
    return any(isinstance(n, Mapping) and n.get("xref") == "paper" for n in listed)
