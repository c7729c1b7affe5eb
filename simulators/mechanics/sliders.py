# SPDX-License-Identifier: MIT
"""Smooth frictional sliders, moved exactly along any monotone displacement.

A slider of stiffness kt and slip force Fs follows dz/dr = kt (1 - |z/Fs|^n) while it
is loaded and dz/dr = kt while it is unloaded. With u = z/Fs and s = r kt/Fs the loaded
branch is the same curve u(s) for all sliders of one sharpness n, so a table of it
moves a slider over any distance without a step size.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze, read_only
from jointbench.acquisition.basics.compiled import compiled
from jointbench.acquisition.basics.errors import UsageError

TABLE_POINTS = 2048
UNKNOWN = -1.0  # place of a slider that has left the loading curve


@dataclass(frozen=True, slots=True, eq=False)
class SliderBank:
    """Parallel sliders of one sharpness.

    Attributes:
        stiffness: of each slider [N/m], shape (n,).
        slip: displacement at which a sharp slider would slip, Fs/kt [m], shape (n,).
        sharpness: exponent n of the transition [-].
    """

    stiffness: FloatArray
    slip: FloatArray
    sharpness: float

    def __post_init__(self) -> None:
        """Check the sizes and make the arrays read-only."""
        if self.sharpness < 1 or np.min(self.slip) <= 0:
            raise UsageError("sliders need a sharpness of 1 or more and positive slips")
        freeze(self, "stiffness", "slip")


def jenkins_bank(*, kt: float, slip_force: float, sharpness: float) -> SliderBank:
    """Return one slider of stiffness kt [N/m] that slips at a force [N].

    Source:
        Jenkins element, regularised; dz/dr = kt (1 - |z/Fs|^n).
    """
    return SliderBank(np.array([kt]), np.array([slip_force / kt]), sharpness)


def iwan_bank(
    *, kt: float, phimax: float, chi: float, sharpness: float, count: int = 24
) -> SliderBank:
    """Return sliders whose slip displacements phi follow a power law up to phimax.

    Args:
        kt: stiffness of all sliders together [N/m].
        phimax: largest slip displacement [m].
        chi: stiffness per slip displacement grows as phi^(chi + 1) [-], chi > -2.
        sharpness: of each slider [-].
        count: number of sliders; they share the range of phi evenly.

    Returns:
        The bank, each slider at the mean of its share of the distribution.

    Source:
        Segalman, J. Appl. Mech. 72 (2005) 752, without the jump at phimax. There chi
        is the exponent of the distribution of stiffness; here it is one less, as the
        development campaigns have it.
    """
    edges = np.linspace(0, phimax, count + 1)
    share = np.diff((edges / phimax) ** (chi + 2))
    moment = np.diff((edges / phimax) ** (chi + 3)) * (chi + 2) / (chi + 3)
    return SliderBank(kt * share, phimax * moment / share, sharpness)


@lru_cache(maxsize=64)
def loading_table(sharpness: float) -> tuple[FloatArray, float]:
    """Tabulate the loading curve u(s), u' = 1 - u^n, u(0) = 0.

    Args:
        sharpness: n [-].

    Returns:
        u and its rise per step at even steps of s, shape (TABLE_POINTS, 2), and the
        step [-]; the last u is 1 to within 1e-13.
    """
    step = (1 + 34 / sharpness) / (TABLE_POINTS - 1)
    value = _tabulate(sharpness, step)
    rise = step * (1 - value**sharpness)
    return read_only(np.stack((value, rise), axis=1)), step


@compiled(error_model="numpy")
def _tabulate(sharpness: float, step: float) -> FloatArray:
    parts = 8  # eight Runge-Kutta steps between table points: error below 1e-14
    h = step / parts
    table = np.zeros(TABLE_POINTS)
    u = 0.0
    for i in range(1, TABLE_POINTS):
        for _ in range(parts):
            a = 1 - u**sharpness
            b = 1 - (u + 0.5 * h * a) ** sharpness
            c = 1 - (u + 0.5 * h * b) ** sharpness
            d = 1 - (u + h * c) ** sharpness
            u = min(u + h / 6 * (a + 2 * b + 2 * c + d), 1.0)
        table[i] = u
    return table


@compiled(error_model="numpy")
def curve_value(place: float, table: FloatArray, step: float) -> float:
    """Return u at a place s >= 0 of the loading curve, by Hermite interpolation."""
    position = place / step
    i = int(position)
    if i >= table.shape[0] - 1:
        return 1.0
    t = position - i
    left, rise_left = table[i, 0], table[i, 1]
    right, rise_right = table[i + 1, 0], table[i + 1, 1]
    rise = right - left
    # Cubic Hermite polynomial written about its left end.
    bend = 3 * rise - 2 * rise_left - rise_right
    twist = rise_left + rise_right - 2 * rise
    return float(left) + t * (float(rise_left) + t * (float(bend) + t * float(twist)))


@compiled(error_model="numpy")
def curve_place(u: float, table: FloatArray, step: float) -> float:
    """Return the place s on the loading curve at which it has the value 0 <= u < 1."""
    low, high = 0, len(table) - 1
    if u >= table[high, 0]:
        return high * step
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle, 0] <= u:
            low = middle
        else:
            high = middle
    place = low * step
    for _ in range(6):
        slope = float(table[low, 1]) / step
        if slope < 1e-12:
            break
        place += (u - curve_value(place, table, step)) / slope
        place = min(max(place, low * step), (low + 1) * step)
    return place


@compiled(error_model="numpy")
def move_slider(
    u: float, place: float, distance: float, table: FloatArray, step: float
) -> tuple[float, float]:
    """Move one slider by a signed distance.

    Args:
        u: z/Fs at the start [-].
        place: its place on the loading curve [-], or `UNKNOWN`.
        distance: displacement over the slip displacement [-].
        table: loading curve and its rise.
        step: of the table [-].

    Returns:
        u and place after the move.
    """
    sign = 1.0 if distance >= 0 else -1.0
    value, ahead = sign * u, sign * distance
    if value < 0:
        back = min(ahead, -value)
        value += back
        ahead -= back
        if value < 0:
            return sign * value, UNKNOWN
        place = 0.0
    if ahead <= 0:
        return sign * value, place
    if place < 0:
        place = curve_place(value, table, step)
    place += ahead
    return sign * curve_value(place, table, step), place
