# SPDX-License-Identifier: MIT
"""``jointbench pressure``: the pressure over a joint, and its stiffness from it."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.pressure.joint_pressure import (
    JointPressure,
    PressureCase,
    joint_pressure,
)
from jointbench.station.files.output_paths import check_outputs, write_text
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.structure_model import StructureModel, structure_of
from jointbench.station.pressure.contact_interface_law import law_of_model
from jointbench.station.pressure.pressure_report import pressure_report
from jointbench.station.pressure.pressure_text import (
    COLUMNS,
    points_csv,
    pressure_json,
    pressure_lines,
    total_rows,
)
from jointbench.station.screen.page import write_report
from jointbench.station.screen.terminal import console, table, working, write_json


def pressure_of(model: Path) -> JointPressure:
    """Compute the pressure over the joint of a model file.

    Args:
        model: structure model (TOML) with a table [pressure].

    Raises:
        BadData: the model lacks what is needed, or nothing presses the joint.
        UsageError: the joint is not named.
    """
    settings = read_toml(model, StructureModel)
    given = settings.pressure
    if given is None:
        raise BadData(
            f"{model}: no table [pressure]; give [[pressure.bolts]] or gravity, and "
            "[pressure.law]"
        )
    names = settings.parametric_joints
    joint = given.joint or (names[0] if len(names) == 1 else None)
    if joint not in names:
        raise UsageError(f"pressure.joint is {given.joint!r}; name one of {names}")
    case = PressureCase(
        settings.joints[joint].between,
        tuple(one.bolt(f"bolt {n}") for n, one in enumerate(given.bolts, 1)),
        law_of_model(settings, model.parent),
        None if given.gravity is None else np.array(given.gravity),
        given.preload_sd,
        given.reference_area_sd,
        given.crown,
    )
    return joint_pressure(structure_of(settings, model.parent), joint, case)


def run_pressure(
    model: Path,
    *,
    report: Path | None,
    points: Path | None,
    json_target: str | None,
) -> None:
    """Compute the pressure over a joint, show it, and write what is asked for.

    Args:
        model: structure model (TOML) with a table [pressure].
        report: to be written (.html).
        points: table of the points to write (.csv).
        json_target: JSON to write.
    """
    check_outputs([model], [json_target, report, points])
    with working("meshing, condensing, solving the contact"):
        found = pressure_of(model)
    screen = console(json_target)
    screen.print(table("Joint by its pressure", COLUMNS, total_rows(found)))
    for said in pressure_lines(found):
        screen.print(f"  {said}", markup=False)
    if points is not None:
        write_text(points, points_csv(found))
    if report is not None:
        write_report(pressure_report(found, model.name), report)
    write_json(json_target, pressure_json(found))
