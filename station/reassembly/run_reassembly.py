# SPDX-License-Identifier: MIT
"""``jointbench reassembly``: a joint over its assemblies."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UnitError, UsageError
from jointbench.acquisition.basics.units import parse_value
from jointbench.analysis.gap.reassembly.changed_joint import (
    JointChange,
    Reassembly,
    compare_assemblies,
)
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.joint_states.joint_state_files import read_joints
from jointbench.station.reassembly.reassembly_json import reassembly_json
from jointbench.station.reassembly.reassembly_text import (
    SCATTER_COLUMNS,
    headline,
    next_columns,
    next_rows,
    remedy,
    scatter_rows,
)
from jointbench.station.screen.terminal import console, table, working, write_json


@dataclass(frozen=True, slots=True)
class ReassemblyOutputs:
    """Where results go.

    Attributes:
        report: HTML, or None.
        json: JSON, or None.
    """

    report: Path | None = None
    json: str | None = None


def reassembly_of(
    joints: Sequence[Path], level: Sequence[str], *, opened: bool
) -> Reassembly:
    """Compare the assemblies of a joint.

    Args:
        joints: joint over its preload (TOML), and later sessions of it.
        level: torques or preloads of the prediction with units; none for those
            measured.
        opened: whether the joint was opened before the latest assembly.

    Raises:
        BadData: a file breaks a rule, or there is one assembly only.
        UsageError: a level has another quantity than those measured.
    """
    data = read_joints(joints).data
    kind = "torque" if np.isfinite(data.states.torque).all() else "force"
    asked: FloatArray | None = None
    if level:
        asked = np.array(sorted(_level(one, kind) for one in level))
    return compare_assemblies(data, level=asked, reassembled=opened)


def _level(text: str, kind: str) -> float:
    """Return a torque or a preload above zero.

    Raises:
        UsageError: it is none.
    """
    try:
        found = parse_value(text, kind)
    except UnitError as error:
        raise UsageError(f"--level: {error}") from error
    if not (np.isfinite(found) and found > 0.0):
        raise UsageError(f"--level is {text!r}; give one above zero, such as '30 N m'")
    return found


def run_reassembly(
    joints: Sequence[Path],
    *,
    level: Sequence[str],
    opened: bool,
    outputs: ReassemblyOutputs,
) -> bool:
    """Compare the assemblies of a joint, show and write the comparison.

    Args:
        joints: joint over its preload (TOML), and later sessions of it.
        level: torques or preloads of the prediction with units; none for those
            measured.
        opened: whether the joint was opened before the latest assembly.
        outputs: where results go.

    Returns:
        Whether the joint has not changed.

    Raises:
        BadData: a file breaks a rule, or there is one assembly only.
    """
    check_outputs(joints, [outputs.json, outputs.report])
    with working("comparing assemblies"):
        found = reassembly_of(joints, level, opened=opened)
    screen = console(outputs.json)
    screen.print(headline(found), style="bold")
    if remedy(found):
        screen.print(remedy(found))
    columns = ("", *(name.value for name in found.quantities))
    turned = zip(
        SCATTER_COLUMNS[1:], *(r[1:] for r in scatter_rows(found)), strict=True
    )
    screen.print(table("Scatter and latest assembly", columns, list(turned), words={0}))
    title = "The next assembly, median and 95 % interval"
    screen.print(table(title, next_columns(found), next_rows(found)))
    write_json(outputs.json, reassembly_json(found))
    if outputs.report is not None:
        from jointbench.station.reassembly.reassembly_report import (
            write_reassembly_report,
        )

        write_reassembly_report(outputs.report, joints[0].stem, found)
        screen.print(f"report: {outputs.report}", soft_wrap=True)
    return found.change is not JointChange.CHANGED
