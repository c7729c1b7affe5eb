# SPDX-License-Identifier: MIT
"""Report section of loops of force and displacement: stiffness and losses."""

from collections.abc import Sequence

import numpy as np

from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.station.drawing.palette import MEMBERS
from jointbench.station.joint_states.loop_states import StateLoop
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import DataTable, Plot, Section
from jointbench.station.screen.traces import Trace, line, markers
from jointbench.station.screen.value_text import engineering

_MOST_POINTS = 3000
"""Samples of a loop that are drawn: more make no other picture."""
_LOOPS = (
    "Force over displacement as measured. Dashed: tangential stiffness right after a "
    "reversal, through the largest amplitude."
)
_LOSSES = (
    "Loss factor of each amplitude, energy of a cycle over 2 pi times the stored one, "
    "with 95 % intervals by noise and by the scatter of the cycles. A loss that noise "
    "hides is not shown."
)


def loop_sections(loops: Sequence[StateLoop]) -> tuple[Section, ...]:
    """Return loops, losses and their numbers; empty without loops.

    Args:
        loops: of a joint, in the order of its states.
    """
    if not loops:
        return ()
    columns = (
        *("loop", "amplitude", "cycles", "displacement [µm]"),
        *("energy of a cycle [J]", "loss factor"),
    )
    table = DataTable("Loops by amplitude.", columns, tuple(_rows(loops)))
    plots = [Plot("loops", _LOOPS, loops_figure(loops), 460)]
    if any(level.dissipates for one in loops for level in one.found.levels):
        plots.append(Plot("loop_losses", _LOSSES, losses_figure(loops), 420))
    title = "Loops of force and displacement"
    return (Section("loops", title, (*plots, table)),)


def loops_figure(loops: Sequence[StateLoop]) -> Figure:
    """Return force over displacement of every loop with its tangent.

    Args:
        loops: of a joint.
    """
    traces: list[Trace] = []
    for k, one in enumerate(loops):
        color, u, f = _color(k), one.loop.displacement, one.loop.force
        step = max(1, u.size // _MOST_POINTS)
        traces.append(
            line(1e6 * u[::step], f[::step], _label(one), color=color, width=1)
        )
        top = one.found.levels[-1]
        middle_u, middle_f = 0.5 * (u.max() + u.min()), 0.5 * (f.max() + f.min())
        ends = np.array([0.0, 2.0 * top.force])
        place = middle_u + top.displacement - ends / one.found.stiffness
        force = middle_f + top.force - ends
        traces.append(
            line(1e6 * place, force, "", color=color, dash="dash", width=1,
                 legend=False)
        )  # fmt: skip
    return figure(traces, axis("displacement [µm]"), axis("force [N]"))


def losses_figure(loops: Sequence[StateLoop]) -> Figure:
    """Return the loss factor over the amplitude of the force, a color for each loop.

    Args:
        loops: of a joint.
    """
    traces: list[Trace] = []
    for k, one in enumerate(loops):
        shown = [level for level in one.found.levels if level.dissipates]
        if not shown:
            continue
        loss = np.array([level.loss_factor for level in shown])
        sd = loss * np.array([level.energy_sd for level in shown])
        force = np.array([level.force for level in shown])
        traces.append(
            markers(
                *(force, loss, _label(one)),
                color=_color(k),
                error=CONTACT.interval_z * sd,
            )
        )
    return figure(
        traces,
        axis("amplitude of the tangential force [N]", log=True),
        axis("loss factor [-]", log=True),
    )


def _color(number: int) -> str:
    return MEMBERS[number % len(MEMBERS)]


def _label(one: StateLoop) -> str:
    """Return torque or preload of a loop, with the branch where it falls."""
    state = one.table
    falling = ", falling" if state.branch == "falling" else ""
    if state.torque is not None:
        return f"{engineering(state.torque, 'N m')}{falling}"
    return f"{engineering(state.preload or 0.0, 'N')}{falling}"


def _rows(loops: Sequence[StateLoop]) -> list[tuple[str, ...]]:
    """Return one row for each amplitude."""
    rows: list[tuple[str, ...]] = []
    for one in loops:
        for level in one.found.levels:
            percent = 100 * level.energy_sd
            loss = f"{level.loss_factor:.3g} ± {percent:.2g} %"
            rows.append(
                (
                    f"{one.name}, {_label(one)}",
                    engineering(level.force, "N"),
                    f"{level.cycles}",
                    f"{1e6 * level.displacement:.3g}",
                    f"{level.energy:.3g}",
                    loss if level.dissipates else "hidden by noise",
                )
            )
    return rows
