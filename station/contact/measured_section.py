# SPDX-License-Identifier: MIT
"""The laws of measured surfaces in a report: table, reasons and a picture."""

from itertools import cycle

import numpy as np

from jointbench.analysis.contact.spectral.measured_laws import LawCurve
from jointbench.station.contact.measured_prediction import MeasuredPrediction
from jointbench.station.contact.measured_words import (
    COLUMNS,
    law_rows,
    law_title,
    surface_lines,
    verdict_lines,
)
from jointbench.station.drawing.palette import GUIDE, LAW, MEMBERS
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Section,
    Text,
)
from jointbench.station.screen.traces import Trace, band, line

_COLOURS = (LAW, *MEMBERS)
_CAPTION = (
    "Normal stiffness per apparent area over nominal pressure. Thick: the law applies; "
    "dotted: outside its range. Bands: 95 %; of fractal laws, from the measured sample "
    "as reference area to the whole apparent area."
)


def measured_section(found: MeasuredPrediction) -> Section:
    """Return the section of a report on the laws of measured surfaces."""
    rows = tuple(law_rows(found))
    items: list[Item] = [
        Plot("law-curves", _CAPTION, law_figure(found), height=520),
        DataTable(law_title(found), COLUMNS, rows, frozenset({"no"})),
    ]
    items += [Text(said) for said in (*surface_lines(found), *verdict_lines(found))]
    return Section("measured-laws", "Laws of measured surfaces", tuple(items))


def law_figure(found: MeasuredPrediction) -> Figure:
    """Return stiffness per area against pressure, for all laws, with bands."""
    traces: list[Trace] = []
    for curve, color in zip(found.curve, cycle(_COLOURS), strict=False):
        traces += _curve(curve, color)
    marks = [
        {
            "type": "line",
            "x0": load / found.case.area,
            "x1": load / found.case.area,
            "yref": "paper",
            "y0": 0,
            "y1": 1,
            "line": {"color": GUIDE, "width": 1, "dash": "dash"},
        }
        for load in found.preloads
    ]
    return figure(
        traces,
        axis("nominal pressure [Pa]", log=True),
        axis("stiffness per area [N/m³]", log=True),
        shapes=marks,
    )


def _curve(curve: LawCurve, color: str) -> list[Trace]:
    shown = curve.stiffness > 0
    pressure = curve.pressure[shown]
    low, high = band(
        pressure,
        curve.low[shown],
        curve.high[shown],
        f"{curve.law}, 95 %",
        color=color,
    )
    inside = np.array([not said for said in curve.outside])[shown]
    k = curve.stiffness[shown]
    return [
        low,
        {**high, "showlegend": False},
        line(pressure, k, curve.law, color=color, dash="dot", width=1.4),
        line(
            pressure,
            np.where(inside, k, np.nan),
            f"{curve.law} applies",
            color=color,
            width=3.2,
            legend=False,
        ),
    ]
