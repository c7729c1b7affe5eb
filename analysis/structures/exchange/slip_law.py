# SPDX-License-Identifier: MIT
"""Laws of slip and of damping for other programs: parallel sliders, or a power of v."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError

SLIDERS = 12
"""Parallel sliders of an Iwan law: the loop is within 2 % of the continuous one."""
SPEEDS = 21
"""Points of a table of force over speed."""
# Smallest edge of the sliders of an Iwan law, as a share of the largest slip.
_LEAST_SLIP = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class SliderLaw:
    """Springs with sliders in parallel (Jenkins elements) in one direction.

    Attributes:
        name: of the effect.
        stiffness: of each slider, a share of that of the joint [N/m], shape (n,).
        slip_force: at which each slips [N], shape (n,).
        remarks: parameters with standard deviations, a line each.
    """

    name: str
    stiffness: FloatArray
    slip_force: FloatArray
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "slip_force")

    @property
    def total(self) -> float:
        """Stiffness of all sliders before slip [N/m]."""
        return float(self.stiffness.sum())


@dataclass(frozen=True, slots=True)
class SpeedLaw:
    """A damping force c |v|^p sgn v in one direction.

    Attributes:
        name: of the effect.
        coefficient: c [N (s/m)^p].
        exponent: p [-].
        remarks: parameters with standard deviations, a line each.
    """

    name: str
    coefficient: float
    exponent: float
    remarks: tuple[str, ...] = ()

    def table(self, largest: float) -> tuple[FloatArray, FloatArray]:
        """Return speeds up to `largest` [m/s] and forces [N]."""
        speed = np.linspace(-largest, largest, SPEEDS)
        force = self.coefficient * np.abs(speed) ** self.exponent * np.sign(speed)
        return speed, force


def law_of(
    name: str, values: Mapping[str, float], remarks: tuple[str, ...] = ()
) -> SliderLaw | SpeedLaw:
    """Return the law of a named effect.

    Args:
        name: of the effect in the catalogue of `gap`.
        values: its reported parameters in SI units.
        remarks: on them, for the files.

    Raises:
        UsageError: there is no such law.

    Source:
        Segalman 2005, J. Appl. Mech. 72, 752, eqs. (14), (26) to (32).
    """
    if name == "jenkins":
        k, force = np.array([values["kt"]]), np.array([values["Fs"]])
        return SliderLaw(name, k, force, remarks)
    if name in {"iwan", "iwan_segalman"}:
        # `iwan` counts chi from one below Segalman's.
        power = values["chi"] + (2.0 if name == "iwan" else 1.0)
        beta = 0.0 if name == "iwan" else values.get("beta", 0.0)
        k, slip = _iwan(values["kt"], values["phimax"], power, beta)
        return SliderLaw(name, k, k * slip, remarks)
    if name == "power_damping":
        return SpeedLaw(name, values["c"], values["p"], remarks)
    if name == "quadratic_damping":
        return SpeedLaw(name, values["c"], 2.0, remarks)
    raise UsageError(
        f"the law {name!r} has no springs with sliders and no power of speed; jenkins, "
        "iwan, iwan_segalman, power_damping and quadratic_damping can be written"
    )


def _iwan(
    total: float, largest: float, power: float, beta: float
) -> tuple[FloatArray, FloatArray]:
    """Return stiffness [N/m] and slip displacement [m] of the sliders.

    The stiffness below a slip displacement phi grows as phi^power: Segalman's chi + 1.
    """
    count = SLIDERS - (beta > 0)
    edges = np.concatenate([[0.0], np.geomspace(_LEAST_SLIP, 1.0, count)])
    share = np.diff(edges**power)
    centre = np.diff(edges ** (power + 1.0)) / share * power / (power + 1.0)
    if beta > 0:
        share = np.append(share, beta) / (1.0 + beta)
        centre = np.append(centre, 1.0)
    return total * share, largest * centre
