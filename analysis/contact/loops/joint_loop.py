# SPDX-License-Identifier: MIT
"""A quasi-static record of force over displacement of a joint, and its cycles."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_finite, require_shape
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData

_LEAST_SAMPLES = 40
"""Below, no branch has the samples that a tangent at its start takes."""
_TURN = 0.02
"""Way back, over the range of the record, that makes a reversal: a range of 1 to 50."""
_NOISE_TURN = 8.0
"""The same over the noise, so that noise makes none."""
_CLOSED = 0.1
"""Largest gap at the end of a cycle over its range."""
_MEDIAN = 0.6744898
"""Median of the size of a standard normal number."""


@dataclass(frozen=True, slots=True, eq=False)
class JointLoop:
    """Force over displacement of a joint that is loaded to and fro slowly.

    Attributes:
        displacement: of one contact surface against the other [m], shape (n,).
        force: that moves it, in the same direction [N], shape (n,).
    """

    displacement: FloatArray
    force: FloatArray

    def __post_init__(self) -> None:
        """Check shapes, numbers and size."""
        require_shape("displacement", self.displacement, (None,))
        require_shape("force", self.force, (len(self.displacement),))
        require_finite("displacement", self.displacement)
        require_finite("force", self.force)
        if len(self.force) < _LEAST_SAMPLES:
            raise BadData(
                f"the loop has {len(self.force)} samples; at least {_LEAST_SAMPLES} "
                "are needed, and some hundred for each cycle are better"
            )
        for name in ("displacement", "force"):
            if not np.ptp(getattr(self, name)) > 0:
                raise BadData(f"the {name} of the loop never changes; check its column")
        freeze(self, "displacement", "force")

    @property
    def noise(self) -> tuple[float, float]:
        """Sd of the noise of displacement [m] and of force [N]."""
        return _noise(self.displacement), _noise(self.force)


def _noise(values: FloatArray) -> float:
    """Return the sd of white noise on a record that changes slowly."""
    second = np.abs(np.diff(values, 2))
    return float(np.median(second) / (_MEDIAN * np.sqrt(6.0)))


@dataclass(frozen=True, slots=True)
class LoopCycle:
    """Samples at which a closed cycle begins, turns and ends."""

    start: int
    turn: int
    end: int


def loop_cycles(loop: JointLoop) -> tuple[LoopCycle, ...]:
    """Return the closed cycles of a record in their order.

    Loading for the first time, and the way from one amplitude to another, belong to
    none.

    Args:
        loop: any number of cycles at any amplitudes.

    Raises:
        BadData: none closes, or force and displacement have opposite signs.
    """
    turns = _reversals(loop)
    way = _way(loop)
    found, at = list[LoopCycle](), 0
    while at + 2 < len(turns):
        start, turn, end = turns[at : at + 3]
        wide = abs(way[turn] - way[start])
        if abs(way[end] - way[start]) <= _CLOSED * wide:
            found.append(LoopCycle(start, turn, end))
            at += 2
        else:
            at += 1
    if not found:
        raise BadData(
            f"the loop has {len(turns)} reversals and no closed cycle; load the joint "
            "to and fro between two ends at least one and a half times"
        )
    return tuple(found)


def _way(loop: JointLoop) -> FloatArray:
    """Return displacement and force together, each over its range, shape (n,)."""
    u, f = loop.displacement, loop.force
    if np.corrcoef(u, f)[0, 1] < 0:
        raise BadData(
            "the force falls where the displacement rises; change the sign of one of "
            "the columns"
        )
    return np.asarray(u / np.ptp(u) + f / np.ptp(f))


def _reversals(loop: JointLoop) -> list[int]:
    """Return the samples at which the way turns back, with the first and the last."""
    way = _way(loop)
    least = max(_TURN * float(np.ptp(way)), _NOISE_TURN * _noise(way))
    found, direction, furthest = [0], 0.0, 0
    for k, value in enumerate(way.tolist()):
        ahead = value - way[furthest]
        if direction == 0.0:
            if abs(ahead) > least:
                direction, furthest = float(np.sign(ahead)), k
        elif direction * ahead > 0:
            furthest = k
        elif -direction * ahead > least:
            found.append(furthest)
            direction, furthest = -direction, k
    return [*found, furthest]
