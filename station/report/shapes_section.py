# SPDX-License-Identifier: MIT
"""The report's section on mode shapes: drawn, animated, compared."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.modal.modal_mass import NormalisedShapes, mass_normalise
from jointbench.signal.modal.shape_checks import check_shapes
from jointbench.station.drawing.palette import GUIDE, MODEL
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.report.figures.small_multiples import small_multiples
from jointbench.station.schemas.geometry_file import DrawnShapes, Geometry, draw_shapes
from jointbench.station.screen.figures import Figure, figure
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.plot_numbers import numbers
from jointbench.station.screen.traces import heatmap

# Largest movement as a share of the size of what is drawn.
_AMPLITUDE = 0.15
_FEWEST_POINTS = 2
_HEIGHT = 250
_MOST_NUMBERS = 12
"""Modes up to which the MAC is written into its map."""


def shapes_section(chain: ModalChain, geometry: Geometry | None) -> Section:
    """Return the shapes drawn, their agreement with each other, and how real they are.

    Raises:
        BadData: the geometry lacks a point.
    """
    directions = {
        channel.name: channel.direction
        for recording in chain.recordings
        for channel in recording.channels
        if channel.direction
    }
    drawn = draw_shapes(chain.result.model, geometry, directions)
    items: list[Item] = []
    if len(drawn.names) < _FEWEST_POINTS:
        items.append(Text("One point was measured: there is no shape to draw."))
    else:
        items += small_multiples(_title(drawn), _drawings(chain, drawn), "shapes")
        items.append(_mac(chain))
    items.append(_table(chain))
    return Section("shapes", "Mode shapes", tuple(items))


def _title(drawn: DrawnShapes) -> str:
    where = (
        "on the geometry given"
        if drawn.measured
        else "points in a row in measured order; --geometry gives their positions"
    )
    return (
        f"Mode shapes, {where}: at rest, displaced, and half a cycle later (dotted). "
        "Play moves a shape; drag to rotate."
    )


def _drawings(chain: ModalChain, drawn: DrawnShapes) -> list[Plot]:
    """Return a scene of each mode."""
    extent = float(np.max(np.ptp(drawn.place, axis=0))) or 1.0
    scene = _scene(drawn, extent)
    plots = []
    for mode, frequency in enumerate(chain.result.model.natural_frequency):
        motion = _AMPLITUDE * extent * drawn.motion[mode]
        data = [
            _wire(drawn, drawn.place, "at rest", GUIDE, 2),
            _wire(drawn, drawn.place + motion.real, "shape", MODEL, 5),
        ]
        swing = {
            "trace": 1,
            "real": _coordinates(drawn, motion.real),
            "imaginary": _coordinates(drawn, motion.imag),
        }
        drawing = {**figure(data, {}, {}, scene=scene), "swing": swing}
        caption = f"mode {mode + 1}: {frequency:.6g} Hz"
        plots.append(Plot(f"shapes-plot-{mode + 1}", caption, drawing, _HEIGHT))
    return plots


def _coordinates(drawn: DrawnShapes, place: FloatArray) -> dict[str, object]:
    """Return all lines as one, with a gap after each; then all points."""
    gap = np.full(3, np.nan)
    rows = [row for a, b in drawn.lines for row in (place[a], place[b], gap)]
    rows += [row for point in place for row in (point, gap)]
    table = np.array(rows)
    return {name: numbers(table[:, i]) for i, name in enumerate("xyz")}


def _wire(
    drawn: DrawnShapes, place: FloatArray, name: str, color: str, width: int
) -> Figure:
    return {
        "type": "scatter3d",
        "mode": "lines+markers",
        "name": name,
        "hoverinfo": "skip",
        "connectgaps": False,
        "line": {"color": color, "width": width},
        "marker": {"color": color, "size": 3},
        **_coordinates(drawn, place),
    }


def _scene(drawn: DrawnShapes, extent: float) -> Figure:
    """Return axes with room for the motion."""
    unit = f" [{drawn.unit}]" if drawn.measured else ""
    room = 1.2 * _AMPLITUDE * extent
    low, high = drawn.place.min(axis=0) - room, drawn.place.max(axis=0) + room
    axes = {
        f"{name}axis": {
            "title": {"text": f"{name}{unit}"},
            "range": [float(low[i]), float(high[i])],
            "visible": drawn.measured,
        }
        for i, name in enumerate("xyz")
    }
    return {**axes, "aspectmode": "data", "dragmode": "turntable"}


def _mac(chain: ModalChain) -> Plot:
    model = chain.result.model
    number = np.arange(1, model.natural_frequency.size + 1)
    mac = check_shapes(model.shapes).mac
    ticks = {"dtick": 1}
    trace = {**heatmap(number, number, mac, "MAC [-]"), "zmin": 0, "zmax": 1}
    if number.size <= _MOST_NUMBERS:
        trace |= {"text": [[f"{value:.2f}" for value in row] for row in mac]}
    plot = figure(
        [trace],
        {"title": {"text": "mode"}, **ticks},
        {
            "title": {"text": "mode"},
            "scaleanchor": "x",
            "autorange": "reversed",
            **ticks,
        },
    )
    caption = (
        "Modal assurance criterion between all shapes: 1 on the diagonal; high values "
        "off the diagonal are modes that the measured points cannot distinguish."
    )
    return Plot("mac-plot", caption, plot, 380)


def _table(chain: ModalChain) -> DataTable:
    model = chain.result.model
    checks = check_shapes(model.shapes)
    masses = _masses(chain)
    rows = tuple(
        (
            str(i + 1),
            f"{frequency:.6g}",
            f"{checks.collinearity[i]:.4f}",
            f"{np.degrees(checks.deviation[i]):.2f}",
            "-" if masses is None else f"{masses.modal_mass[i]:.4g}",
            "-" if masses is None else f"{np.degrees(masses.phase[i]):.1f}",
        )
        for i, frequency in enumerate(model.natural_frequency)
    )
    return DataTable(
        "Complexity of the shapes: modal phase collinearity MPC (1 for a real mode), "
        "mean phase deviation MPD (0 for a real mode); modal mass from the driving "
        "point, scaled to a largest component of 1, and the phase there (0 for a real "
        "mode and a collocated sensor).",
        (
            "mode",
            "frequency [Hz]",
            "MPC [-]",
            "MPD [deg]",
            "modal mass [kg]",
            "phase [deg]",
        ),
        rows,
    )


def _masses(chain: ModalChain) -> NormalisedShapes | None:
    """Return the mass-normalised shapes, or None without a driving point."""
    try:
        return mass_normalise(chain.result.model)
    except BadData:
        return None
