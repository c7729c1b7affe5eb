# SPDX-License-Identifier: MIT
"""The report on a machine: modes, energies, receptance, lobes, motion, shapes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.session import software_version
from jointbench.analysis.structures.machine.machine_result import (
    AXES,
    MachineResult,
    ToolMotion,
    VariantResult,
)
from jointbench.analysis.structures.machine.reduce_machine import ReducedMachine
from jointbench.station.drawing.palette import GUIDE, MODEL
from jointbench.station.machine.machine_shapes import shape_plots
from jointbench.station.machine.machine_text import (
    TextTable,
    bound_sentences,
    chatter_sentences,
    cost_table,
    glued_table,
    mode_sentences,
    mode_table,
    motion_table,
    shape_table,
    tool_table,
)
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Report,
    Section,
    Text,
    Tile,
)
from jointbench.station.screen.plot_numbers import thin
from jointbench.station.screen.traces import Trace, band, heatmap, line

_GLUED, _JOINTED = GUIDE, MODEL
_MOST_POINTS = 4000
_SMALL_SHARE = 0.005
"""Share of the energy below which a region is left out [-]."""
_SHAPES = 4


def write_machine_report(
    path: Path, name: str, machine: ReducedMachine, result: MachineResult
) -> None:
    """Write one offline HTML report about a machine.

    Args:
        path: to write.
        name: of the model.
        machine: reduced, for the shapes.
        result: of it.
    """
    motion = motion_table(result)
    sections = [
        Section(
            "modes",
            "Modes",
            (
                *(Text(one) for one in mode_sentences(result)),
                _table(mode_table(result)),
                _table(shape_table(result)),
                _table(glued_table(result)),
            ),
        ),
        Section("energy", "Strain energy", tuple(_energies(result))),
        Section(
            "tool",
            "Receptance at the tool",
            (
                _table(tool_table(result)),
                *(Text(one) for one in bound_sentences(result)),
                *_receptances(result),
            ),
        ),
        Section("joints", "Cost of each joint", (_table(cost_table(result)),)),
        Section(
            "chatter",
            "Stability lobes",
            (*(Text(one) for one in chatter_sentences(result)), *_lobes(result)),
        ),
        Section(
            "motion",
            "Motion under the loads",
            () if motion is None else (_table(motion), *_motions(result)),
        ),
        Section("shapes", "Mode shapes", tuple(_shapes(machine, result))),
    ]
    report = Report(
        title=f"Machine {name}",
        lead="The same bodies with rigid joints (glued) and with springs and dampers "
        "(jointed).",
        software=software_version(),
        simulated=False,
        tiles=_tiles(result),
        sections=tuple(section for section in sections if section.items),
    )
    write_report(report, path)


def _table(given: TextTable) -> DataTable:
    return DataTable(given.title, given.columns, given.rows)


def _tiles(result: MachineResult) -> tuple[Tile, ...]:
    soft, rigid = result.jointed, result.glued
    weakest = soft.modes.energy.weakest(0)[0]
    joints = {one.name for one in result.costs}
    softest = int(np.argmax(np.diag(soft.tool.static)))
    ratio = soft.tool.static[softest, softest] / rigid.tool.static[softest, softest]
    tiles = [
        Tile(
            "first mode",
            f"{soft.modes.natural_frequency[0]:.4g} Hz",
            f"glued {rigid.modes.natural_frequency[0]:.4g} Hz",
        ),
        Tile(
            "weakest region, mode 1",
            ("joint " if weakest in joints else "") + weakest,
            f"glued {rigid.modes.energy.weakest(0)[0]}",
        ),
        Tile(
            f"static compliance {AXES[softest]}",
            f"{1e9 * soft.tool.static[softest, softest]:.3g} nm/N",
            f"{ratio:.2f} x glued",
        ),
    ]
    if soft.chatter is not None and np.isfinite(soft.chatter.limit):
        note = f"at {soft.chatter.frequency:.4g} Hz"
        tiles.append(Tile("chatter limit", f"{1e3 * soft.chatter.limit:.3g} mm", note))
    return tuple(tiles)


def _energies(result: MachineResult) -> list[Item]:
    found: list[Item] = []
    for word, one in (("jointed", result.jointed), ("glued", result.glued)):
        energy = one.modes.energy
        names = [
            f"{at + 1}: {value:.4g} Hz"
            for at, value in enumerate(one.modes.natural_frequency)
        ]
        shown = [
            at
            for at in range(len(energy.regions))
            if energy.share[:, at].max() > _SMALL_SHARE
        ]
        share = 100 * energy.share[:, shown].T
        trace: Trace = {
            **heatmap([], [], share, "%"),
            "x": names,
            "y": [energy.regions[at] for at in shown],
            "text": [[f"{value:.0f}" for value in row] for row in share],
            "zmin": 0,
            "zmax": 100,
        }
        rows = axis("body or joint", type="category") | {"autorange": "reversed"}
        plot = figure([trace], axis("mode", type="category"), rows)
        caption = f"Share of bodies and joints in the strain energy [%], {word}."
        height = 120 + 30 * len(shown)
        found.append(Plot(f"energy-{word}", caption, plot, height))
    return found


def _receptances(result: MachineResult) -> list[Item]:
    found: list[Item] = []
    soft, rigid = result.jointed.tool, result.glued.tool
    for at, name in enumerate(AXES):
        traces: list[Trace] = []
        if soft.interval is not None:
            low, high = 1e9 * soft.interval[:, at]
            label = "jointed, 95 % of the joints' uncertainty"
            traces += band(soft.frequency, low, high, label, color=MODEL)
        traces.append(_receptance_line(rigid.frequency, rigid.response[at, at], False))
        traces.append(_receptance_line(soft.frequency, soft.response[at, at], True))
        plot = figure(
            traces,
            axis("frequency [Hz]", log=True),
            axis("receptance [nm/N]", log=True),
        )
        found.append(Plot(f"receptance-{name}", f"Tool, {name} to {name}", plot))
    return found


def _receptance_line(
    frequency: FloatArray,
    response: np.ndarray[tuple[int, ...], np.dtype[np.complex128]],
    soft: bool,
) -> Trace:
    color, name = (_JOINTED, "jointed") if soft else (_GLUED, "glued")
    return line(frequency, 1e9 * np.abs(response), name, color=color)


def _lobes(result: MachineResult) -> list[Item]:
    traces: list[Trace] = []
    found = [("glued", result.glued, _GLUED), ("jointed", result.jointed, _JOINTED)]
    for word, one, color in found:
        lobes = one.chatter
        if lobes is None or not np.isfinite(lobes.limit):
            continue
        speed = 60 * lobes.speed
        traces.append(line(speed, 1e3 * lobes.width, word, color=color))
        limit = np.full(2, 1e3 * lobes.limit)
        label = f"{word}, every speed"
        traces.append(
            line(speed[[0, -1]], limit, label, color=color, dash="dot", width=1)
        )
    if not traces:
        return []
    if result.limit_interval is not None and result.jointed.chatter is not None:
        low, high = (np.full(2, 1e3 * one) for one in result.limit_interval)
        ends = 60 * result.jointed.chatter.speed[[0, -1]]
        label = "jointed, every speed, 95 %"
        traces = [*band(ends, low, high, label, color=MODEL), *traces]
    plot = figure(
        traces, axis("spindle speed [1/min]"), axis("width of cut [mm]", log=True)
    )
    caption = "Stable below the lines: width of cut over spindle speed"
    return [Plot("lobes", caption, plot)]


def _motions(result: MachineResult) -> list[Item]:
    soft, rigid = result.jointed.motion, result.glued.motion
    if soft is None or rigid is None:
        return []
    found: list[Item] = []
    for at, name in enumerate(AXES):
        plot = figure(
            [
                _motion_line(soft, at, "jointed", _JOINTED),
                _motion_line(rigid, at, "glued", _GLUED),
            ],
            axis("time [s]"),
            axis(f"displacement {name} [um]"),
        )
        found.append(Plot(f"motion-{name}", f"Tool along {name}", plot, 280))
    found.append(_begin_plot(soft, rigid))
    return found


def _motion_line(motion: ToolMotion, at: int, name: str, color: str) -> Trace:
    time, value = thin(motion.time, motion.displacement[at], _MOST_POINTS)
    return line(time, 1e6 * value, name, color=color, width=1)


def _begin_plot(soft: ToolMotion, rigid: ToolMotion) -> Item:
    """Return the first part of the axis that moves most."""
    at = int(np.argmax(soft.largest))
    count = min(soft.time.size, 400)
    traces = [
        line(one.time[:count], 1e6 * one.displacement[at, :count], name, color=color)
        for one, name, color in ((soft, "jointed", _JOINTED), (rigid, "glued", _GLUED))
    ]
    plot = figure(traces, axis("time [s]"), axis(f"displacement {AXES[at]} [um]"))
    return Plot("motion-begin", f"Tool along {AXES[at]}, the first samples", plot, 280)


def _shapes(machine: ReducedMachine, result: MachineResult) -> list[Item]:
    found: list[Item] = []
    variants: Sequence[tuple[str, VariantResult]] = (
        ("jointed", result.jointed),
        ("glued", result.glued),
    )
    for at in range(min(_SHAPES, result.jointed.modes.natural_frequency.size)):
        for word, one in variants:
            plot: Figure = shape_plots(machine, one.modes.shapes[:, at], result.turn)
            caption = (
                f"{word}, {one.modes.natural_frequency[at]:.4g} Hz: "
                f"{one.modes.motion.text(at)}; drag to rotate"
            )
            found.append(Plot(f"shape-{word}-{at}", caption, plot, 420))
    return found
