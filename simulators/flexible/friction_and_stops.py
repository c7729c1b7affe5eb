# SPDX-License-Identifier: MIT
"""Joint laws beyond the linear spring and damper, at the ports of a structure."""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.compiled import compiled
from jointbench.simulators.flexible.bolt_friction import (
    FrictionState,
    friction_state,
    move_friction,
    roomy,
)

_NUMBERS = 5
"""Most parameters of a law."""


class PortLawKind(IntEnum):
    """Kind of a law; the comment gives the force on a motion r and its parameters."""

    FRICTION = 0  # k (S - r): k [N/m], phi [m], `Yielding`, its exponents [-]
    STOP = 1  # k max(r - g, 0): k [N/m], g [m]
    CUBIC = 2  # k r^3: k [N/m^3]
    QUADRATIC = 3  # k r^2: k [N/m^2]
    SQUARE_DAMPING = 4  # c v |v|: c [N s^2/m^2]
    SLOT = 5  # k (r -+ g) beyond +-g: k [N/m], g [m]
    LIFT_OFF = 6  # -k max(r - g, 0): k [N/m], g [m]; the spring acts up to g alone


@dataclass(frozen=True, slots=True, eq=False)
class BoltLaw:
    """One law at one port.

    Attributes:
        kind: which law.
        row: motion of the port by each coordinate, shape (n_all,).
        parameters: as `PortLawKind` states.
    """

    kind: PortLawKind
    row: FloatArray
    parameters: tuple[float, ...]

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "row")


@dataclass(frozen=True, slots=True, eq=False)
class LawBank:
    """All laws of a structure as arrays.

    Attributes:
        rows: shape (n_laws, n_all).
        kinds: shape (n_laws,).
        parameters: shape (n_laws, 5); zeros beyond those of a law.
    """

    rows: FloatArray
    kinds: IntArray
    parameters: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "rows", "kinds", "parameters")


def law_bank(laws: tuple[BoltLaw, ...], size: int) -> LawBank | None:
    """Return laws as arrays, None for no law.

    Args:
        laws: of the ports.
        size: number of coordinates; those beyond the rows of a law do not move it.
    """
    if not laws:
        return None
    rows, parameters = np.zeros((len(laws), size)), np.zeros((len(laws), _NUMBERS))
    for row, numbers, law in zip(rows, parameters, laws, strict=True):
        row[: law.row.size] = law.row
        numbers[: len(law.parameters)] = law.parameters
    kinds = np.array([law.kind for law in laws], dtype=np.int64)
    return LawBank(rows, kinds, parameters)


class _LawArrays(NamedTuple):
    """The arrays of a bank, as a compiled function takes them."""

    kinds: IntArray
    parameters: FloatArray


class PortMemory:
    """State of the laws of many hits: the last motion and that of friction."""

    def __init__(self, laws: LawBank, hits: int) -> None:
        self._arrays = _LawArrays(laws.kinds, laws.parameters)
        count = laws.kinds.size
        self._last = np.zeros((count, hits))
        self._friction: dict[int, FrictionState] = {
            int(law): friction_state(hits)
            for law in np.flatnonzero(laws.kinds == PortLawKind.FRICTION)
        }
        self._stages = np.zeros((2 * count, hits))
        self.force = np.zeros((count, hits))

    def stage_forces(self, motion: FloatArray) -> FloatArray:
        """Return the forces at both stages [N], shape (2 n_laws, n_hits).

        Friction is moved straight from the begin of the step to each stage.

        Args:
            motion: displacement and velocity at the first stage, then at the second,
                shape (4 n_laws, n_hits).
        """
        n = self._arrays.kinds.size
        for stage in (0, 1):
            point, out = motion[2 * n * stage :], self._stages[n * stage :][:n]
            self._move(self._last, point, out, kept=False)
        return self._stages

    def commit(self, motion: FloatArray, end: FloatArray) -> None:
        """Move the laws over both stages to the end of the step.

        Args:
            motion: as in `stage_forces`.
            end: displacement and velocity at the end, shape (2 n_laws, n_hits).
        """
        n = self._arrays.kinds.size
        before = self._last
        self._friction = {law: roomy(own) for law, own in self._friction.items()}
        for point in (motion[: 2 * n], motion[2 * n :], end):
            self._move(before, point, self.force, kept=True)
            before = point[:n]
        self._last = end[:n].copy()

    def _move(
        self, before: FloatArray, point: FloatArray, force: FloatArray, *, kept: bool
    ) -> None:
        """Write the forces of all laws after a move; friction keeps it if asked."""
        n = self._arrays.kinds.size
        _forces(self._arrays, point[:n], point[n : 2 * n], force)
        for law, own in self._friction.items():
            numbers, motion = self._arrays.parameters[law], (before[law], point[law])
            move_friction(numbers, motion, own, force[law], kept)


def forces_along(law: BoltLaw, path: FloatArray) -> FloatArray:
    """Return the force of a law along a path of its port [N], at rest before it.

    Args:
        law: which does not depend on the velocity.
        path: motion [m], shape (n,).
    """
    port = LawBank(
        np.ones((1, 1)),
        np.array([law.kind], dtype=np.int64),
        np.array([[*law.parameters, *[0.0] * (_NUMBERS - len(law.parameters))]]),
    )
    memory, found = PortMemory(port, 1), np.zeros(path.size)
    for k, r in enumerate(path):
        point = np.array([[r], [0.0]])
        memory.commit(np.vstack((point, point)), point)
        found[k] = memory.force[0, 0]
    return found


@compiled(error_model="numpy")
def _forces(laws: _LawArrays, r: FloatArray, v: FloatArray, force: FloatArray) -> None:
    """Write the forces of all laws without memory."""
    for law in range(laws.kinds.size):
        kind, k, g = laws.kinds[law], laws.parameters[law, 0], laws.parameters[law, 1]
        for h in range(r.shape[1]):
            x = r[law, h]
            if kind == PortLawKind.STOP:
                force[law, h] = k * max(x - g, 0.0)
            elif kind == PortLawKind.CUBIC:
                force[law, h] = k * x * x * x
            elif kind == PortLawKind.QUADRATIC:
                force[law, h] = k * x * x
            elif kind == PortLawKind.SQUARE_DAMPING:
                force[law, h] = k * v[law, h] * abs(v[law, h])
            elif kind == PortLawKind.SLOT:
                force[law, h] = k * (max(x - g, 0.0) + min(x + g, 0.0))
            elif kind == PortLawKind.LIFT_OFF:
                force[law, h] = -k * max(x - g, 0.0)
