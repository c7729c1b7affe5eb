# SPDX-License-Identifier: MIT
"""Checks while the part is still on the bench: driving points and reciprocity."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray
from jointbench.acquisition.records.recordings import Channel
from jointbench.signal.frf.frf import Frf
from jointbench.station.measure.plan import Condition

WRONG_SIGN_LIMIT = 0.05
"""Share of the imaginary part of a driving point that may have the wrong sign [-]."""
RESONANT_SHARE = 1e-3
"""Least share of an FRF in its imaginary part where something resonates [-]."""
RECIPROCITY_LIMIT = 0.1
"""Rms difference of two FRFs that should be one, over their rms [-]."""


@dataclass(frozen=True, slots=True)
class Check:
    """One check.

    Attributes:
        name: what was checked.
        value: the number found.
        limit: above which it fails.
        words: one line.
    """

    name: str
    value: float
    limit: float
    words: str

    @property
    def passed(self) -> bool:
        """Whether the value is within its limit."""
        return self.value <= self.limit


@dataclass(slots=True)
class CheckBook:
    """Averages of one torque and level, and the checks that each new one allows.

    Points without a sensor have no check and are not kept.

    Attributes:
        channels: of responses and hammer.
    """

    channels: tuple[Channel, ...]
    _averages: dict[str, Frf] = field(default_factory=dict)
    _present: tuple[float | None, float | None] = (None, None)

    def enter(self, condition: Condition, frf: Frf) -> tuple[Check, ...]:
        """Keep an average; check its driving point and every pair now complete."""
        present, point = (condition.torque, condition.level), condition.point
        if present != self._present:
            self._averages, self._present = {}, present
        if _response_at(self.channels, point) is not None:
            self._averages[point] = replace(frf, coherence=None, variance=None)
        pairs = reciprocity(self._averages, self.channels)
        new = [check for check in pairs if point in check.name.split()]
        driving = driving_point(frf, self.channels, point)
        return tuple(new) if driving is None else (driving, *new)


def driving_point(frf: Frf, channels: tuple[Channel, ...], point: str) -> Check | None:
    """Check that force and acceleration at one point point the same way.

    The imaginary part of a driving-point accelerance is positive at every resonance:
    the structure takes energy in, it gives none. A sensor upside down, or a hit
    beside the sensor, shows at once. A part that does not resonate, like a mass to
    calibrate on, has no such sign: None.

    Source:
        Ewins, Modal Testing (2000), sec. 3.9 (checks of driving-point FRFs).
    """
    row = _response_at(channels, point)
    if row is None:
        return None
    response = frf.response[row, 0, _band(frf)]
    imaginary = response.imag
    if np.sum(imaginary**2) < RESONANT_SHARE * np.sum(np.abs(response) ** 2):
        return None
    wrong = float(np.sum(imaginary[imaginary < 0] ** 2) / np.sum(imaginary**2))
    return Check(
        f"driving point {point}",
        wrong,
        WRONG_SIGN_LIMIT,
        f"{100 * wrong:.2g} % of the imaginary part has the wrong sign",
    )


def reciprocity(
    averages: Mapping[str, Frf], channels: tuple[Channel, ...]
) -> tuple[Check, ...]:
    """Check that a pair of points answers alike whichever of them is struck.

    Args:
        averages: FRF of each point that was struck, at one torque and level.
        channels: of the responses and the hammer.
    """
    found = []
    points = sorted(averages)
    for i, one in enumerate(points):
        for other in points[i + 1 :]:
            rows = _response_at(channels, one), _response_at(channels, other)
            if rows[0] is None or rows[1] is None:
                continue
            if not np.array_equal(averages[one].frequency, averages[other].frequency):
                continue  # the operator changed the length of a block in between
            inside = _band(averages[one]) & _band(averages[other])
            forth = averages[one].response[rows[1], 0, inside]
            back = averages[other].response[rows[0], 0, inside]
            found.append(_compare(one, other, forth, back))
    return tuple(found)


def _compare(one: str, other: str, forth: ComplexArray, back: ComplexArray) -> Check:
    scale = np.sqrt(0.5 * np.mean(np.abs(forth) ** 2 + np.abs(back) ** 2))
    differ = float(np.sqrt(np.mean(np.abs(forth - back) ** 2)) / scale)
    return Check(
        f"reciprocity {one} - {other}",
        differ,
        RECIPROCITY_LIMIT,
        f"the two FRFs differ by {100 * differ:.2g} % rms",
    )


def _response_at(channels: tuple[Channel, ...], point: str) -> int | None:
    responses = [c for c in channels if c.quantity.is_motion]
    rows = [i for i, channel in enumerate(responses) if channel.point == point]
    return rows[0] if len(rows) == 1 else None


def _band(frf: Frf) -> BoolArray:
    low, high = frf.usable_band or (frf.frequency[0], frf.frequency[-1])
    inside: BoolArray = (frf.frequency >= low) & (frf.frequency <= high)
    return inside
