# SPDX-License-Identifier: MIT
"""Two marble plates on a bolted joint: the specimen of the simulated chassis.

Each plate bends in ten elastic modes and moves in three rigid ones; four bolts join the
contact surfaces with springs and dampers, normal and tangential, that depend on the
torque; the lower plate is supported by foam.
"""

from dataclasses import dataclass, field
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.mechanics.modal_response import Poles
from jointbench.simulators.mechanics.plate_modes import (
    PlateDesign,
    PlateModes,
    deflection,
    plate_modes,
    slope,
)

ELASTIC_MODES = 10
REFERENCE_TORQUE = 20.0  # [N m]
# Places as a share of length and width; "t" is the upper plate, "b" the lower one.
POINTS = MappingProxyType(
    {
        "1": ("t", 0.03, 0.05),
        "2": ("t", 0.97, 0.07),
        "3": ("t", 0.66, 0.93),
        "4": ("t", 0.36, 0.90),
        "5": ("t", 0.60, 0.33),
        "6": ("b", 0.02, 0.95),
        "7": ("b", 0.95, 0.90),
    }
)
_BOLTS = ((0.15, 0.2), (0.85, 0.2), (0.15, 0.8), (0.85, 0.8))
_FEET = ((0.1, 0.1), (0.9, 0.1), (0.1, 0.9), (0.9, 0.9))


@dataclass(frozen=True, slots=True)
class PlatesDesign:
    """Parameters of the specimen.

    Attributes:
        plate: of both plates.
        damping_ratio: of the elastic modes of a free plate [-].
        normal_stiffness: of the joint at a bolt at 20 N m [N/m].
        tangential_stiffness: of the joint at a bolt at 20 N m [N/m].
        stiffness_exponent: the joint's stiffness grows as torque to this power [-].
        joint_damping: of the joint at a bolt, each direction [N s/m].
        foam_stiffness: of each of four feet [N/m].
        foam_damping: of each of four feet [N s/m].
    """

    plate: PlateDesign = field(default_factory=PlateDesign)
    damping_ratio: float = 0.0012
    normal_stiffness: float = 3e7
    tangential_stiffness: float = 2.5e8
    stiffness_exponent: float = 0.4
    joint_damping: float = 60.0
    foam_stiffness: float = 2.5e4
    foam_damping: float = 150.0


@lru_cache(maxsize=8)
def free_plate(design: PlateDesign) -> PlateModes:
    """Return the modes of one free plate of the specimen."""
    return plate_modes(design, elastic=ELASTIC_MODES)


def natural_frequencies(design: PlatesDesign, torque: float) -> FloatArray:
    """Return the natural frequencies of the specimen at a torque [Hz], ascending."""
    values = np.linalg.eigvals(_state_matrix(design, torque))
    upper = values[values.imag > 0]
    return np.sort(np.abs(upper)) / (2 * np.pi)


@lru_cache(maxsize=64)
def plates_poles(
    design: PlatesDesign, torque: float, *, struck: str, outputs: tuple[str, ...]
) -> Poles:
    """Return the poles of the specimen for a force out of plane.

    Args:
        design: the specimen.
        torque: on each bolt [N m].
        struck: point under the hammer, one of `POINTS`.
        outputs: points of the accelerometers.

    Raises:
        UsageError: there is no such point, or the torque is not above zero.
    """
    matrix = _state_matrix(design, torque)
    values, vectors = np.linalg.eig(matrix)
    size = matrix.shape[0] // 2
    load = _place(design, struck)
    rows = np.array([_place(design, point) for point in outputs])
    rows = rows.reshape(len(outputs), size)
    entry = np.linalg.solve(vectors, np.concatenate((np.zeros(size), load)))
    upper = np.flatnonzero(values.imag > 0)
    # Acceleration is the lower half of the state's derivative.
    exits = rows @ (matrix[size:] @ vectors[:, upper])
    return Poles(values[upper], (exits * entry[upper]).T, rows @ load)


def _place(design: PlatesDesign, point: str) -> FloatArray:
    """Return the deflection of all coordinates at a point, lower plate first."""
    if point not in POINTS:
        raise UsageError(
            f"the plates have no point {point!r}; there are {', '.join(POINTS)}"
        )
    plate, along, across = POINTS[point]
    modes = free_plate(design.plate)
    own = deflection(modes, along * design.plate.length, across * design.plate.width)
    rest = np.zeros_like(own)
    return np.concatenate((rest, own) if plate == "t" else (own, rest))


def _state_matrix(design: PlatesDesign, torque: float) -> FloatArray:
    """Return the matrix of the state (displacement, velocity) in free-plate modes."""
    if not (np.isfinite(torque) and torque > 0):
        raise UsageError(f"torque is {torque!r} N m; give one above zero")
    omega = np.tile(free_plate(design.plate).omega, 2)
    stiffness, damping = np.diag(omega**2), np.diag(2 * design.damping_ratio * omega)
    share = (torque / REFERENCE_TORQUE) ** design.stiffness_exponent
    for bolt in _BOLTS:
        normal, slips = _relative(design, *bolt)
        stiffness += share * design.normal_stiffness * np.outer(normal, normal)
        stiffness += share * design.tangential_stiffness * slips.T @ slips
        damping += design.joint_damping * (np.outer(normal, normal) + slips.T @ slips)
    for foot in _FEET:
        own, _ = _at(design, *foot)
        lower = np.concatenate((own, np.zeros_like(own)))
        stiffness += design.foam_stiffness * np.outer(lower, lower)
        damping += design.foam_damping * np.outer(lower, lower)
    size = omega.size
    return np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness, -damping]])


def _relative(
    design: PlatesDesign, along: float, across: float
) -> tuple[FloatArray, FloatArray]:
    """Return opening, shape (n,), and slip along x and y, shape (2, n).

    The contact surfaces are half a thickness from the mid-planes of their plates, so
    that rotation of a plate causes slip.
    """
    own, turn = _at(design, along, across)
    half = design.plate.thickness / 2
    return np.concatenate((-own, own)), np.hstack((-half * turn, -half * turn))


def _at(
    design: PlatesDesign, along: float, across: float
) -> tuple[FloatArray, FloatArray]:
    modes = free_plate(design.plate)
    x, y = along * design.plate.length, across * design.plate.width
    return deflection(modes, x, y), slope(modes, x, y)
