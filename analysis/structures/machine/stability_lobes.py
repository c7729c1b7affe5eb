# SPDX-License-Identifier: MIT
"""Stability lobes: the width of cut above which a machine chatters.

Each tooth (or turn of the wheel) cuts the wave that the one before has left. With
chip thickness h = h0 - y(t) + y(t - T), force K_s b h and oriented receptance G:
1 + K_s b G (1 - exp(-j omega T)) = 0.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_positive, require_shape
from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze

_TURN = 2.0 * np.pi
_MOST_LOBES = 300


@dataclass(frozen=True, slots=True, eq=False)
class StabilityLobes:
    """Widths of cut at the limit of stability.

    Attributes:
        limit: largest width that is stable at every speed [m]; infinity if the real
            part of the receptance is nowhere negative.
        frequency: of the chatter at that width [Hz]; nan if there is none.
        speed: of the spindle, ascending [1/s], shape (n_speeds,).
        width: largest stable width at each speed [m], shape (n_speeds,); infinity
            where no lobe reaches.
    """

    limit: float
    frequency: float
    speed: FloatArray
    width: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "speed", "width")


def stability_lobes(
    frequency: FloatArray,
    receptance: ComplexArray,
    coefficient: float,
    speed: FloatArray,
    *,
    teeth: int = 1,
) -> StabilityLobes:
    """Return the stability limit of a cut of one degree of freedom.

    Args:
        frequency: lines, ascending [Hz], shape (n_lines,).
        receptance: along the chip thickness, from a unit cutting force: u_h' H u_f
            [m/N], shape (n_lines,).
        coefficient: cutting force over chip area [N/m^2].
        speed: of the spindle, ascending [1/s], shape (n_speeds,).
        teeth: that follow each other in one turn; one for a wheel.

    Returns:
        The limit at every speed, and that of each speed.

    Source:
        Tlusty and Polacek 1963, ASME Production Engineering Research Conf., 465-474;
        Altintas and Budak 1995, CIRP Annals 44, 357-362; Altintas, Manufacturing
        Automation (2012), sec. 4.2.
    """
    require_positive("teeth", teeth)
    limit, chatter = stability_limit(frequency, receptance, coefficient)
    width = np.full(speed.size, np.inf)
    if not np.isfinite(limit):
        return StabilityLobes(limit, chatter, speed, width)
    each = _widths(frequency, receptance, coefficient)
    # The wave lags by epsilon, where G (1 - exp(-j epsilon)) is real and negative.
    lag = np.mod(2.0 * np.angle(receptance) + 3.0 * np.pi, _TURN)
    top = int(np.ceil(frequency[-1] / (teeth * speed[0])))
    # So many lobes at low speed leave no room between them.
    width[speed * teeth * _MOST_LOBES < frequency[-1]] = limit
    for lobe in range(min(top, _MOST_LOBES) + 1):
        turns = teeth * (lag / _TURN + lobe)
        own = frequency / np.where(turns > 0.0, turns, np.inf)
        for run in _monotone_runs(np.where(np.isfinite(each), own, np.nan)):
            place, value = own[run], each[run]
            if place[0] > place[-1]:
                place, value = place[::-1], value[::-1]
            low, high = np.searchsorted(speed, [place[0], place[-1]])
            inside = np.s_[low : high + 1]
            found = np.interp(speed[inside], place, value, np.inf, np.inf)
            width[inside] = np.minimum(width[inside], found)
    return StabilityLobes(limit, chatter, speed, width)


def stability_limit(
    frequency: FloatArray, receptance: ComplexArray, coefficient: float
) -> tuple[float, float]:
    """Return the largest width that is stable at every speed.

    Args:
        frequency: lines, ascending [Hz], shape (n_lines,).
        receptance: along the chip thickness, from a unit cutting force [m/N], shape
            (n_lines,).
        coefficient: cutting force over chip area [N/m^2].

    Returns:
        Width [m] and frequency of the chatter [Hz]; infinity and nan if the real part
        is nowhere negative.
    """
    require_positive("coefficient", coefficient)
    require_shape("receptance", receptance, (frequency.size,))
    each = _widths(frequency, receptance, coefficient)
    at = int(np.argmin(each))
    if not np.isfinite(each[at]):
        return np.inf, np.nan
    return float(each[at]), float(frequency[at])


def _widths(
    frequency: FloatArray, receptance: ComplexArray, coefficient: float
) -> FloatArray:
    """Return the width at the limit for chatter at each line [m]."""
    unstable = (receptance.real < 0.0) & (frequency > 0.0)
    real = np.where(unstable, receptance.real, -1.0)
    return np.where(unstable, -0.5 / (coefficient * real), np.inf)


def _monotone_runs(values: FloatArray) -> list[slice]:
    """Return the stretches of two or more numbers that only rise or only fall."""
    direction = np.sign(np.diff(values))
    bounds = np.flatnonzero(direction[1:] != direction[:-1]) + 1
    edges = np.concatenate([[0], bounds, [direction.size]])
    kept = np.isfinite(direction[edges[:-1]]) & (direction[edges[:-1]] != 0.0)
    return [
        slice(low, high + 1)
        for low, high in zip(
            edges[:-1][kept].tolist(), edges[1:][kept].tolist(), strict=True
        )
    ]
