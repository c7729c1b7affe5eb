# SPDX-License-Identifier: MIT
"""Forces between two bodies beyond the linear spring and damper, in continuous time.

With r = x_second - x_first a positive force of the law attracts the bodies; the
elongation rate is v. A law with memory has one state, or a bank of sliders.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import sqrt, tanh
from typing import NamedTuple

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.simulators.mechanics.sliders import (
    TABLE_POINTS,
    UNKNOWN,
    SliderBank,
    loading_table,
)


class LawKind(IntEnum):
    """Kind of a law; the comment gives the force and the order of its parameters."""

    ODD_POWER = 0  # k r |r|^(p-1): k [N/m^p], p
    SQUARE = 1  # k2 r^2: k2 [N/m^2]
    ROOT = 2  # k r / (r^2 + e^2)^(1/4): k [N/m^0.5], e [m]
    STOP = 3  # k max(r - g, 0): k [N/m], g [m]
    COULOMB = 4  # Fc tanh(v/v0): Fc [N], v0 [m/s]
    SQUARE_DAMPING = 5  # c v |v|: c [N s^2/m^2]
    MAXWELL = 6  # w' = k v - w/tau, force w: k [N/m], tau [s]
    BOUC_WEN = 7  # w' = v (1 - |w/zy|^n (b sgn(v w) + g)), force k w: k, n, b, g, zy
    SLIDERS = 8  # a `SliderBank`
    DRIFT = 9  # k r t/T: k [N/m], T [s]
    DEAD_ZONE_DAMPING = 10  # c v q/(1 + q), q = (r/g)^8: c [N s/m], g [m]
    SLOT = 11  # k (r -+ g) beyond +-g, else 0: k [N/m], g [m]


@dataclass(frozen=True, slots=True, eq=False)
class JointLaw:
    """One law between two bodies.

    Attributes:
        kind: which law.
        first: index of a body, or -1 for the ground.
        second: index of the other body.
        parameters: in the order `LawKind` states.
        sliders: for `LawKind.SLIDERS`.
    """

    kind: LawKind
    first: int
    second: int
    parameters: tuple[float, ...] = ()
    sliders: SliderBank | None = None


class LawArrays(NamedTuple):
    """Laws as arrays for the stepper; slider columns are consecutive."""

    kind: IntArray  # (n_laws,)
    ends: IntArray  # (n_laws, 2) first and second body
    parameters: FloatArray  # (n_laws, 5)
    bank: IntArray  # (n_laws, 2) first slider of the law and one past its last
    sliders: FloatArray  # (2, n_sliders) slip force [N], 1/slip displacement [1/m]
    table: FloatArray  # (n_laws, TABLE_POINTS, 2)
    table_step: FloatArray  # (n_laws,)


def pack_laws(laws: Sequence[JointLaw]) -> LawArrays:
    """Convert laws to the arrays of the stepper."""
    count = len(laws)
    parameters = np.zeros((count, 5))
    table, table_step = np.zeros((count, TABLE_POINTS, 2)), np.ones(count)
    bank = np.zeros((count, 2), dtype=np.int64)
    sliders = [np.zeros((2, 0))]
    for i, law in enumerate(laws):
        parameters[i, : len(law.parameters)] = law.parameters
        if law.sliders is not None:
            table[i], table_step[i] = loading_table(law.sliders.sharpness)
            slip = law.sliders.slip
            bank[i] = sum(block.shape[1] for block in sliders)
            bank[i, 1] += slip.size
            sliders.append(np.stack((law.sliders.stiffness * slip, 1 / slip)))
    return LawArrays(
        kind=np.array([law.kind for law in laws], dtype=np.int64),
        ends=np.array(
            [(law.first, law.second) for law in laws], dtype=np.int64
        ).reshape(count, 2),
        parameters=parameters,
        bank=bank,
        sliders=np.concatenate(sliders, axis=1),
        table=table,
        table_step=table_step,
    )


def resting_sliders(laws: LawArrays) -> FloatArray:
    """Return the memory of unloaded sliders: u and place, shape (2, n_sliders)."""
    memory = np.zeros((2, laws.sliders.shape[1]))
    memory[1] = UNKNOWN
    return memory


@compiled(error_model="numpy")
def _elastic_force(kind: int, p: Sequence[float], r: float, time: float) -> float:
    """Return the part of a law's force that depends on the elongation r [m] only."""
    if kind == LawKind.ODD_POWER:
        return p[0] * r * float(abs(r) ** (p[1] - 1))
    if kind == LawKind.SQUARE:
        return p[0] * r * r
    if kind == LawKind.ROOT:
        return p[0] * r / sqrt(sqrt(r * r + p[1] * p[1]))
    if kind == LawKind.STOP:
        return p[0] * max(r - p[1], 0.0)
    if kind == LawKind.SLOT:
        return p[0] * (max(r - p[1], 0.0) + min(r + p[1], 0.0))
    if kind == LawKind.DRIFT:
        return p[0] * r * time / p[1]
    return 0.0


@compiled(error_model="numpy")
def _viscous_force(
    kind: int, p: Sequence[float], r: float, v: float, w: float
) -> float:
    """Return the part that depends on the elongation rate v [m/s] or the state w."""
    if kind == LawKind.COULOMB:
        return p[0] * tanh(v / p[1])
    if kind == LawKind.SQUARE_DAMPING:
        return p[0] * v * abs(v)
    if kind == LawKind.DEAD_ZONE_DAMPING:
        square = (r / p[1]) * (r / p[1])
        q = square * square * square * square
        return p[0] * v * q / (1 + q)
    if kind == LawKind.MAXWELL:
        return w
    if kind == LawKind.BOUC_WEN:
        return p[0] * w
    return 0.0


@compiled(error_model="numpy")
def law_force(
    kind: int, p: Sequence[float], r: float, v: float, w: float, time: float
) -> float:
    """Return the force of a law without sliders [N]."""
    return _elastic_force(kind, p, r, time) + _viscous_force(kind, p, r, v, w)


@compiled(error_model="numpy")
def state_rate(kind: int, p: Sequence[float], v: float, w: float) -> float:
    """Return dw/dt of a law with a state."""
    if kind == LawKind.MAXWELL:
        return p[0] * v - w / p[1]
    if kind == LawKind.BOUC_WEN:
        turn = (p[2] if v * w > 0 else -p[2]) + p[3]
        return v * (1 - float(abs(w / p[4]) ** p[1]) * turn)
    return 0.0
