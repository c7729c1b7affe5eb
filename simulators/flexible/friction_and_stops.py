# SPDX-License-Identifier: MIT
"""Joint laws beyond the linear spring and damper, at the ports of a structure.

Friction is a bank of Bouc-Wen sliders, u' = r'/phi (1 - |u| (|u| + u sgn r')/2): on
the loading branch u = tanh(r/phi), which is advanced exactly, and unloading is elastic.

Source:
    Wen, J. Eng. Mech. Div. 102 (1976) 249, eq. (2) with n = 2; Segalman, J. Appl. Mech.
    72 (2005) 752 for the distribution of the sliders.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.compiled import compiled

SLIDERS = 10  # of a power law, geometrically spaced
_DECADES = 2.5  # from the weakest to the strongest of them


class PortLawKind(IntEnum):
    """Kind of a law; the comment gives the force on a motion r and its parameters."""

    FRICTION = 0  # k (sum of w phi u - r): k [N/m]; sliders with w, phi
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
        parameters: two of them, as `PortLawKind` states.
        weights: share of each slider in the stiffness [-], shape (n_sliders,).
        slips: displacement at which each slider slips [m], shape (n_sliders,).
    """

    kind: PortLawKind
    row: FloatArray
    parameters: tuple[float, float]
    weights: FloatArray | None = None
    slips: FloatArray | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "row", "weights", "slips")


@dataclass(frozen=True, slots=True, eq=False)
class LawBank:
    """All laws of a structure as arrays.

    Attributes:
        rows: shape (n_laws, n_all).
        kinds: shape (n_laws,).
        parameters: shape (n_laws, 2).
        first: slider of each law, and one past the last one, shape (n_laws + 1,).
        sliders: weight times slip displacement [m], and its inverse [1/m], shape (2,
            n_sliders).
    """

    rows: FloatArray
    kinds: IntArray
    parameters: FloatArray
    first: IntArray
    sliders: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "rows", "kinds", "parameters", "first", "sliders")


def law_bank(laws: tuple[BoltLaw, ...], size: int) -> LawBank | None:
    """Return laws as arrays, None for no law.

    Args:
        laws: of the ports.
        size: number of coordinates; those beyond the rows of a law do not move it.
    """
    if not laws:
        return None
    rows = np.zeros((len(laws), size))
    sliders: list[FloatArray] = [np.zeros((2, 0))]
    first = [0]
    for row, law in zip(rows, laws, strict=True):
        row[: law.row.size] = law.row
        if law.weights is not None and law.slips is not None:
            sliders.append(np.stack((law.weights * law.slips, 1 / law.slips)))
        first.append(sum(block.shape[1] for block in sliders))
    return LawBank(
        rows,
        np.array([law.kind for law in laws], dtype=np.int64),
        np.array([law.parameters for law in laws]),
        np.array(first, dtype=np.int64),
        np.hstack(sliders),
    )


def power_law_sliders(phimax: float, chi: float) -> tuple[FloatArray, FloatArray]:
    """Return weights [-] and slip displacements [m] of sliders in a power law.

    Args:
        phimax: largest slip displacement [m].
        chi: stiffness per slip displacement grows as phi^(chi + 1) [-], chi > -2.
    """
    edges = phimax * np.geomspace(10**-_DECADES, 1.0, SLIDERS + 1)
    edges[0] = 0.0
    weights = np.diff((edges / phimax) ** (chi + 2))
    moments = np.diff((edges / phimax) ** (chi + 3)) * (chi + 2) / (chi + 3)
    return weights, phimax * moments / weights


class _LawArrays(NamedTuple):
    """The arrays of a bank, as a compiled function takes them."""

    kinds: IntArray
    parameters: FloatArray
    first: IntArray
    sliders: FloatArray


class PortMemory:
    """State of the laws of many hits: the last motion and the sliders."""

    def __init__(self, laws: LawBank, hits: int) -> None:
        self._arrays = _LawArrays(laws.kinds, laws.parameters, laws.first, laws.sliders)
        count = laws.kinds.size
        self._last = np.zeros((count, hits))
        self._sliders = np.zeros((laws.sliders.shape[1], hits))
        self._scratch = np.zeros_like(self._sliders)
        self._stages = np.zeros((2 * count, hits))
        self.force = np.zeros((count, hits))

    def stage_forces(self, motion: FloatArray) -> FloatArray:
        """Return the forces at both stages [N], shape (2 n_laws, n_hits).

        Args:
            motion: displacement and velocity at the first stage, then at the second,
                shape (4 n_laws, n_hits).
        """
        n = self._arrays.kinds.size
        self._scratch[:] = self._sliders
        before = self._last
        for stage in (0, 1):
            r, v = motion[2 * n * stage :][:n], motion[2 * n * stage + n :][:n]
            out = self._stages[n * stage :][:n]
            _forces(self._arrays, before, r, v, self._scratch, out)
            before = r
        return self._stages

    def commit(self, motion: FloatArray, end: FloatArray) -> None:
        """Move the sliders over both stages to the end of the step.

        Args:
            motion: as in `stage_forces`.
            end: displacement and velocity at the end, shape (2 n_laws, n_hits).
        """
        n = self._arrays.kinds.size
        before = self._last
        points = (motion[: 2 * n], motion[2 * n :], end)
        for point in points:
            r, v = point[:n], point[n:]
            _forces(self._arrays, before, r, v, self._sliders, self.force)
            before = point[:n]
        self._last = end[:n].copy()


@compiled(error_model="numpy", fastmath={"contract", "nnan", "ninf"})
def _friction(
    table: FloatArray,
    before: FloatArray,
    r: FloatArray,
    sliders: FloatArray,
    force: FloatArray,
) -> None:
    """Move the sliders of one law and return their sum less the motion [m].

    Without branches, so that all hits are moved together.
    """
    for h in range(r.size):
        force[h] = -r[h]
    for i in range(table.shape[1]):
        scale, inverse = table[0, i], table[1, i]
        for h in range(r.size):
            u = sliders[i, h]
            s = (r[h] - before[h]) * inverse
            turned = u * s < 0.0
            elastic = turned and abs(s) <= abs(u)
            rest = s + u if turned else s
            start = 0.0 if turned else u
            # tanh(a + b) by its addition formula; tanh(b) as a quotient.
            square = rest * rest
            turn = rest * (15.0 + square) / (15.0 + 6.0 * square)
            turn = min(max(turn, -1.0), 1.0)
            loaded = (start + turn) / (1.0 + start * turn)
            u = rest if elastic else loaded
            sliders[i, h] = u
            force[h] += scale * u


@compiled(error_model="numpy")
def _forces(
    laws: _LawArrays,
    before: FloatArray,
    r: FloatArray,
    v: FloatArray,
    sliders: FloatArray,
    force: FloatArray,
) -> None:
    """Move all sliders from one motion to another and return the forces of all laws."""
    for law in range(laws.kinds.size):
        kind, k, g = laws.kinds[law], laws.parameters[law, 0], laws.parameters[law, 1]
        if kind == PortLawKind.FRICTION:
            low, high = laws.first[law], laws.first[law + 1]
            table, own = laws.sliders[:, low:high], sliders[low:high]
            _friction(table, before[law], r[law], own, force[law])
            force[law] *= k
            continue
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
            else:
                force[law, h] = -k * max(x - g, 0.0)
