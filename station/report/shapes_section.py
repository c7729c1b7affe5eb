# SPDX-License-Identifier: MIT
"""The report's section on mode shapes: drawn, animated, compared."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.modal.modal_mass import NormalisedShapes, mass_normalise
from jointbench.signal.modal.shape_checks import check_shapes
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.schemas.geometry_file import DrawnShapes, Geometry, draw_shapes
from jointbench.station.screen.figures import FONT, Figure, figure
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.plot_numbers import numbers
from jointbench.station.screen.traces import GREY, PALETTE, heatmap

_FRAMES = 16
_MILLISECONDS = 60
_CYCLES = 30
# Largest movement as a share of the size of what is drawn.
_AMPLITUDE = 0.15
_FEWEST_POINTS = 2


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
        items += [_drawing(chain, drawn), _mac(chain)]
    items.append(_table(chain))
    return Section("shapes", "Mode shapes", tuple(items))


def _drawing(chain: ModalChain, drawn: DrawnShapes) -> Plot:
    extent = float(np.max(np.ptp(drawn.place, axis=0))) or 1.0
    moved = [_moved(drawn, mode, 0, extent) for mode in range(drawn.motion.shape[0])]
    still = _wire(drawn, drawn.place, "at rest", GREY, 2)
    frames = [
        {
            "name": f"{mode}-{k}",
            "traces": [1],
            "data": [_coordinates(drawn, _moved(drawn, mode, k, extent))],
        }
        for mode in range(drawn.motion.shape[0])
        for k in range(_FRAMES)
    ]
    drawing = figure(
        [still, _wire(drawn, moved[0], "shape", PALETTE[0], 5)],
        {},
        {},
        scene=_scene(drawn, extent),
        updatemenus=[_menu(chain)],
        legend={"x": 1.0, "xanchor": "right", "y": 1.0},
        margin={"l": 0, "r": 0, "t": 50, "b": 0},
    )
    where = (
        "on the geometry given"
        if drawn.measured
        else "points in a row in measured order; --geometry gives their positions"
    )
    caption = (
        f"Mode shapes, {where}. Select a mode above to animate it; drag to rotate."
    )
    return Plot("shapes-plot", caption, {**drawing, "frames": frames}, 480)


def _moved(drawn: DrawnShapes, mode: int, frame: int, extent: float) -> FloatArray:
    turn = np.exp(2j * np.pi * frame / _FRAMES)
    return np.asarray(
        drawn.place + _AMPLITUDE * extent * (drawn.motion[mode] * turn).real
    )


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
    """Return fixed axes, so that the view stays still during animation."""
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


def _menu(chain: ModalChain) -> Figure:
    """Return a menu with one entry per mode and one that stops the animation."""
    play = {
        "mode": "immediate",
        "frame": {"duration": _MILLISECONDS, "redraw": True},
        "transition": {"duration": 0},
    }
    entries: list[Figure] = [
        {
            "label": f"mode {mode + 1}: {frequency:.6g} Hz",
            "method": "animate",
            "args": [[f"{mode}-{k}" for k in range(_FRAMES)] * _CYCLES, play],
        }
        for mode, frequency in enumerate(chain.result.model.natural_frequency)
    ]
    stop = {"label": "stop", "method": "animate", "args": [[None], play]}
    return {
        "buttons": [*entries, stop],
        "x": 0.0,
        "y": 1.0,
        "xanchor": "left",
        "yanchor": "bottom",
        "font": {"family": FONT},
    }


def _mac(chain: ModalChain) -> Plot:
    model = chain.result.model
    number = np.arange(1, model.natural_frequency.size + 1)
    mac = check_shapes(model.shapes).mac
    ticks = {"dtick": 1, "constrain": "domain"}
    plot = figure(
        [{**heatmap(number, number, mac, "MAC [-]"), "zmin": 0, "zmax": 1}],
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
