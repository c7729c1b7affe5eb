# SPDX-License-Identifier: MIT
"""``jointbench machine``: a machine of many bodies and joints, glued and jointed."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.structures.machine.analyse_machine import analyse_machine
from jointbench.analysis.structures.machine.machine_request import (
    Cut,
    MachineRequest,
    TimeSpan,
)
from jointbench.analysis.structures.machine.machine_result import AXES, MachineResult
from jointbench.analysis.structures.machine.reduce_machine import (
    ReducedMachine,
)
from jointbench.station.files.output_paths import check_outputs, write_text
from jointbench.station.files.toml_file import read_toml
from jointbench.station.files.toml_text import load_toml
from jointbench.station.machine.machine_cache import reduced_machine_of
from jointbench.station.machine.machine_file import (
    TOOL,
    MachineModel,
    loads_of,
)
from jointbench.station.machine.machine_json import machine_json
from jointbench.station.machine.machine_text import (
    TextTable,
    cost_table,
    mode_table,
    motion_table,
    sentences,
    shape_table,
    tool_table,
)
from jointbench.station.screen.terminal import console, table, working, write_json


def run_machine(
    model: Path,
    *,
    report: Path | None,
    motion: Path | None,
    json_target: str | None,
    cache: Path | None = None,
) -> MachineResult:
    """Compute a machine, show and write the result.

    Args:
        model: the machine file.
        report: HTML report to write.
        motion: table of the transient to write.
        json_target: JSON to write.
        cache: folder that keeps reduced bodies.

    Returns:
        The result.

    Raises:
        UsageError: a motion is requested of a model without a transient.
    """
    check_outputs([model], [json_target, report, motion])
    settings = read_toml(model, MachineModel)
    if motion is not None and settings.transient is None:
        raise UsageError("--motion needs a table [transient] in the model")
    with working("meshing, reducing bodies"):
        reduced = reduced_machine_of(settings, model.parent, cache)
    with working("solving glued and jointed"):
        result = analyse_machine(reduced, request_of(settings, model.parent))
    show_machine(result, json_target)
    write_json(json_target, machine_json(result))
    if motion is not None:
        write_motion(motion, result)
    if report is not None:
        _write_report(report, model.name, reduced, result)
    return result


def run_any_machine(
    model: Path,
    *,
    report: Path | None,
    motion: Path | None,
    json_target: str | None,
    cache: Path | None = None,
) -> None:
    """Compute a machine of modelled bodies, or of bodies measured alone.

    Args:
        model: the file; a table [measured] without [bodies] means that all bodies are
            measured.
        report: HTML report to write.
        motion: table of the transient to write.
        json_target: JSON to write.
        cache: folder that keeps reduced bodies.

    Raises:
        UsageError: a motion is requested of measured bodies.
    """
    if not _describes_measured(model):
        run_machine(
            model, report=report, motion=motion, json_target=json_target, cache=cache
        )
        return
    if motion is not None:
        raise UsageError("--motion needs modelled bodies; these are measured")
    from jointbench.station.machine.run_measured import run_measured

    run_measured(model, report=report, json_target=json_target)


def _describes_measured(path: Path) -> bool:
    """Return whether all bodies of a file are measured."""
    try:
        found = load_toml(path)
    except (OSError, ValueError):
        return False  # the reader of the model refuses it
    return "measured" in found and "bodies" not in found


def request_of(settings: MachineModel, folder: Path) -> MachineRequest:
    """Return what a machine file asks for; its tables are relative to `folder`."""
    analysis, span, cut = settings.analysis, settings.transient, settings.chatter
    return MachineRequest(
        band_hz=analysis.band,
        modes=analysis.modes,
        lines=analysis.lines,
        samples=analysis.samples,
        seed=analysis.seed,
        tool=TOOL,
        loads=loads_of(settings, folder),
        span=None
        if span is None
        else TimeSpan(span.duration, span.step, span.begin, span.modes),
        cut=None
        if cut is None
        else Cut(cut.coefficient, cut.chip, cut.force, cut.speed, cut.teeth),
    )


def show_machine(result: MachineResult, json_target: str | None = None) -> None:
    """Print modes, shapes, receptances, costs of joints, chatter and motion."""
    screen = console(json_target)
    parts: list[TextTable | None] = [
        mode_table(result),
        shape_table(result),
        tool_table(result),
        cost_table(result),
        motion_table(result),
    ]
    for one in parts:
        if one is not None:
            screen.print(table(one.title, one.columns, one.rows, words=one.words))
    for sentence in sentences(result):
        screen.print(sentence, markup=False)


def write_motion(path: Path, result: MachineResult) -> None:
    """Write time and displacement of the tool, glued and jointed, as a table."""
    soft, rigid = result.jointed.motion, result.glued.motion
    if soft is None or rigid is None:
        return
    heads = [f"{word}_{axis} [m]" for word in ("glued", "jointed") for axis in AXES]
    values = np.concatenate([soft.time[None], rigid.displacement, soft.displacement])
    lines = [",".join(f"{one:.9g}" for one in row) for row in values.T.tolist()]
    write_text(path, "\n".join([",".join(["time [s]", *heads]), *lines, ""]))


def _write_report(
    path: Path, name: str, reduced: ReducedMachine, result: MachineResult
) -> None:
    from jointbench.station.machine.machine_report import write_machine_report

    write_machine_report(path, name, reduced, result)
