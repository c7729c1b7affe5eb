# SPDX-License-Identifier: MIT
"""The pressure over a joint, and its stiffness from it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointbench.analysis.structures.pressure.joint_pressure import JointPressure
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.pressure.pressure_text import (
    COLUMNS,
    headline,
    pressure_json,
    pressure_lines,
    total_rows,
)
from jointbench.station.pressure.run_pressure import pressure_of


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PressedJoint(Shown):
    """A joint by its pressure.

    Attributes:
        result: pressures at the points, totals with intervals, open share.
    """

    result: JointPressure

    def to_dict(self) -> dict[str, Any]:
        """Return totals as plain data, as ``pressure --json`` writes them."""
        return pressure_json(self.result)

    @property
    def view(self) -> ResultView:
        """What presses, and the totals beside those of an even pressure."""
        found = self.result
        said = tuple(pressure_lines(found)[1:])
        return ResultView(headline(found), COLUMNS, tuple(total_rows(found)), said)


def pressure(model: str | Path) -> PressedJoint:
    """Compute the pressure over a joint of meshed bodies.

    Args:
        model: structure model (TOML) with a table [pressure]: bolts, weight, law.

    Returns:
        Pressures, and the joint's stiffness and damping from a law at the local
        pressure, beside those of an even pressure.

    Raises:
        BadData: the model lacks what is needed, a bolt is not on the bodies, or nothing
            presses the joint.
    """
    return PressedJoint(pressure_of(Path(model)))
