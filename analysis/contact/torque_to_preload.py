# SPDX-License-Identifier: MIT
"""Preload of a bolted joint from the torque on its bolts."""

import math
from dataclasses import dataclass

from jointbench.acquisition.basics.errors import BadData


@dataclass(frozen=True, slots=True)
class Preload:
    """A normal force with its uncertainty.

    Attributes:
        value: [N].
        sd: standard deviation, to first order [N].
    """

    value: float
    sd: float


def preload_from_torque(
    torque: float,
    *,
    diameter: float,
    bolts: int = 1,
    nut_factor: float = 0.2,
    torque_sd: float = 0.0,
    nut_factor_sd: float = 0.0,
    bolt_scatter: float = 0.0,
) -> Preload:
    """Convert a tightening torque to the total preload of all bolts.

    Args:
        torque: on each bolt [N m].
        diameter: nominal diameter of the bolts [m].
        bolts: number of bolts in the joint.
        nut_factor: K in F = T/(K d) [-]; about 0.2 dry, 0.15 oiled.
        torque_sd: error of the wrench, the same for all bolts [N m].
        nut_factor_sd: standard deviation of the mean nut factor, same for all bolts
            [-].
        bolt_scatter: relative scatter of the force from bolt to bolt [-]; independent,
            so it averages over the bolts.

    Returns:
        Sum over the bolts and its standard deviation.

    Raises:
        BadData: a number that is not positive, or a negative uncertainty.

    Source:
        Shigley, Mechanical Engineering Design, sec. 8-8, F = T/(K d).
    """
    for name, value in (
        ("torque", torque),
        ("diameter", diameter),
        ("bolts", bolts),
        ("nut_factor", nut_factor),
    ):
        if not (math.isfinite(value) and value > 0):
            raise BadData(f"{name} is {value:g}, it must be positive; give it in SI")
    for name, value in (
        ("torque_sd", torque_sd),
        ("nut_factor_sd", nut_factor_sd),
        ("bolt_scatter", bolt_scatter),
    ):
        if not (math.isfinite(value) and value >= 0):
            raise BadData(f"{name} is {value:g}, it cannot be negative; 0 is allowed")
    force = bolts * torque / (nut_factor * diameter)
    relative = math.hypot(
        torque_sd / torque, nut_factor_sd / nut_factor, bolt_scatter / math.sqrt(bolts)
    )
    return Preload(force, force * relative)
