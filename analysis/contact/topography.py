# SPDX-License-Identifier: MIT
"""Profile and surface geometry: interference and radius of an asperity."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Topography:
    """Kind of fractal surface, which sets an asperity's interference and radius.

    With the excess e = D - `lowest_dimension`, both kinds obey the same formulas:
    interference delta = c a^((1-e)/2), a = `shape` R delta, and a distribution of
    contact areas n(a) = q a_l^q a^(-q-1) with q = (1+e)/2.

    Attributes:
        name: ``"profile"`` or ``"surface"``.
        lowest_dimension: lower limit of the fractal dimension [-].
        shape: g in a = g R delta [-].
        log_interference: ln c of excess [-], roughness G [m] and gamma [-].
    """

    name: str
    lowest_dimension: float
    shape: float
    log_interference: Callable[[FloatArray, FloatArray, float], FloatArray]


def _profile_interference(
    excess: FloatArray, roughness: FloatArray, gamma: float
) -> FloatArray:
    """Return ln c of delta = c a^((2-D)/2) (Appl. Sci. 2023, 13, 11680, eq. 15)."""
    return np.asarray(excess * np.log(roughness))


def _surface_interference(
    excess: FloatArray, roughness: FloatArray, gamma: float
) -> FloatArray:
    """Return ln c of delta = c a^((3-D)/2) (the same paper, eq. 38)."""
    constant = (
        (5 - 3 * excess) / 2 * math.log(2)
        + (excess - 1) / 2 * math.log(math.pi)
        + 0.5 * math.log(math.log(gamma))
    )
    return np.asarray(excess * np.log(roughness) + constant)


PROFILE = Topography("profile", 1.0, math.pi**2, _profile_interference)
SURFACE = Topography("surface", 2.0, math.pi, _surface_interference)
