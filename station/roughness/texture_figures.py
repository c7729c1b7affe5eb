# SPDX-License-Identifier: MIT
"""Standard parameters in reports: filtered traces, Abbott curve, table."""

from collections.abc import Sequence

import numpy as np

from jointbench.signal.roughness.uncertain_parameters import MeasuredTexture
from jointbench.station.drawing.palette import GUIDE, MEASURED, MEMBERS, MODEL
from jointbench.station.roughness.texture_request import TextureAnswer
from jointbench.station.roughness.texture_words import (
    COLUMNS,
    answer_lines,
    parameter_rows,
    title_words,
)
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import DataTable, Item, ItemGroup, Plot, Text
from jointbench.station.screen.plot_numbers import thin
from jointbench.station.screen.traces import line

_MOST_POINTS = 3000
_CURVE_POINTS = 201
_ABBOTT = (
    "Material ratio (Abbott) curve of the filtered heights, and the equivalent line of "
    "the central 40 % (dotted), whose fall from 0 to 100 % is the core height."
)


def texture_items(answers: Sequence[tuple[str, TextureAnswer | None]]) -> list[Item]:
    """Return figures and tables of the surfaces that have standard parameters.

    Args:
        answers: names of surfaces, and what was found; None where it is not asked for.
    """
    measured = [a.measured for _, a in answers if a is not None and a.measured]
    items: list[Item] = []
    for number, one in enumerate(measured):
        if one.texture.heights.ndim == 1:
            items.append(_traces(one, number))
    if measured:
        curves = tuple(_abbott(one, number) for number, one in enumerate(measured))
        items.append(ItemGroup(_ABBOTT, curves, "grid"))
    for name, answer in answers:
        if answer is None:
            continue
        if answer.measured is not None:
            rows = tuple(parameter_rows(answer.measured))
            table = DataTable(title_words(answer.measured), COLUMNS, rows)
            title = f"{name}: {len(rows)} standard parameters"
            items.append(ItemGroup(title, (table,)))
        items.append(Text(f"{name}: {'; '.join(answer_lines(answer))}."))
    return items


def _traces(measured: MeasuredTexture, number: int) -> Plot:
    """Return the primary profile with its L-filter line, and the roughness below."""
    texture = measured.texture
    place = texture.spacing[0] * 1e3 * np.arange(texture.heights.size)
    rough = np.where(texture.valid, texture.heights, np.nan) * 1e6
    wave = texture.reference * 1e6
    known = np.isfinite(rough)
    span = float(np.ptp(rough[known])) if known.any() else 0.0
    down = float(np.nanmin(rough + wave) - np.nanmax(rough) - 0.1 * span)
    traces = [
        line(
            *thin(place[known], (rough + wave)[known], _MOST_POINTS),
            "primary profile",
            color=MEASURED,
            width=1,
        ),
        line(*thin(place, wave, _MOST_POINTS), "L-filter line", color=MODEL),
        line(
            *thin(place[known], (rough + down)[known], _MOST_POINTS),
            "roughness profile (moved down)",
            color=MEMBERS[0],
            width=1,
        ),
    ]
    section = place[-1] / texture.sections
    marks = [
        {
            "type": "line",
            "x0": k * section,
            "x1": k * section,
            "yref": "paper",
            "y0": 0,
            "y1": 1,
            "line": {"color": GUIDE, "width": 0.8, "dash": "dot"},
        }
        for k in range(1, texture.sections)
    ]
    caption = f"{title_words(measured)}: filtered traces; dotted lines bound sections."
    plot = figure(traces, axis("x [mm]"), axis("z [µm]"), shapes=marks)
    return Plot(f"texture-{number}", caption, plot, 340)


def _abbott(one: MeasuredTexture, number: int) -> Plot:
    """Return the material ratio curve of a surface with its equivalent line."""
    known = np.sort(one.texture.heights[one.texture.valid])[::-1] * 1e6
    ratio = np.linspace(0, 1, _CURVE_POINTS)
    place = np.clip(ratio * known.size - 0.5, 0, known.size - 1)
    height = np.interp(place, np.arange(known.size), known)
    traces = [line(100 * ratio, height, "measured, filtered", color=MEASURED)]
    letter = "R" if one.texture.heights.ndim == 1 else "S"
    ends = _core_line(one, letter)
    if ends is not None:
        traces.append(line([0, 100], ends, "line of the core", color=MODEL, dash="dot"))
    plot = figure(traces, axis("material ratio [%]"), axis("z [µm]"))
    return Plot(f"abbott-plot-{number}", one.surface, plot, 300)


def _core_line(one: MeasuredTexture, letter: str) -> list[float] | None:
    """Return the ends of the equivalent line [um], through its crossing at mr1."""
    core, first = one.named(f"{letter}k").value, one.named(f"{letter}mrk1").value
    if core is None or first is None:
        return None
    known = np.sort(one.texture.heights[one.texture.valid])[::-1]
    top = float(known[min(int(first * known.size), known.size - 1)])
    return [1e6 * top, 1e6 * (top - core)]
