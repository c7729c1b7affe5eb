# SPDX-License-Identifier: MIT
"""Friction laws of bolted interfaces, moved along the motion of a port.

A law has a stiffness k and a slip displacement phi, its limiting force over k. Of the
three ways to yield, a bench draws one and its exponents:

- By Richard and Abbott, loading follows S(r) = r / (1 + (r / phi)^n)^(1 / n).
- By Ciavarella and Jaeger, tangential contact is a difference of normal contacts with
  a force ~ depth^m: S(r) = phi (1 - (1 - r / (m phi))^m) up to r = m phi; m = 3/2 is
  Mindlin's sphere, m = 1 a flat punch.
- By Bouc and Wen, u' = r' / phi (1 - |u|^n (b + (1 - b) sgn(u r'))), S = phi u.

The first two turn back by Masing's rules: from a turning point the curve is that of
loading at twice its size, and a closed loop is forgotten. The turning points of each
hit are remembered, so no slider and no step size enters.

Source:
    Richard and Abbott 1975, J. Eng. Mech. Div. 101, 511; Ciavarella 1998, Int. J.
    Solids Struct. 35, 2349; Wen 1976, J. Eng. Mech. Div. 102, 249; Erlicher and Point
    2004, C. R. Mecanique 332, 51 (b from 1/2 to 1 loses energy in every loop);
    Jayakumar 1987, thesis, Caltech, sec. 2.2 (Masing's rules for any path).
"""

from enum import IntEnum
from math import ceil

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled

FIRST_TURNS = 64
"""Turning points that are held of each hit at first."""
_LARGEST_MOVE = 0.125  # slip displacements in one Runge-Kutta step of Bouc and Wen
_UNLOADING_MOVE = 0.0175  # the same where u may pass 0, at which its rate has a kink


class Yielding(IntEnum):
    """How a law yields; the comment gives its exponents."""

    RICHARD_ABBOTT = 0  # n
    CONTACT = 1  # m
    BOUC_WEN = 2  # n, b


FrictionState = tuple[FloatArray, FloatArray, IntArray]
"""Turning points of each hit, motion and S [m], shape (n_hits, 2, n_turns); S, or u of
Bouc and Wen, shape (n_hits,); number of turning points and sense of motion, shape (2,
n_hits)."""


def friction_state(hits: int) -> FrictionState:
    """Return the state of one law at rest."""
    turns = np.zeros((hits, 2, FIRST_TURNS))
    return turns, np.zeros(hits), np.zeros((2, hits), dtype=np.int64)


def roomy(state: FrictionState) -> FrictionState:
    """Return a state with room for further turning points."""
    turns, value, ways = state
    room = turns.shape[2]
    if int(ways[0].max(initial=0)) + FIRST_TURNS // 4 < room:
        return state
    return np.concatenate([turns, np.zeros_like(turns)], axis=2), value, ways


@compiled(error_model="numpy")
def loading_curve(way: int, r: float, phi: float, exponent: float) -> float:
    """Return S at a motion r >= 0 of the first loading [m].

    Args:
        way: to yield, by Richard and Abbott or as contact.
        r: motion [m].
        phi: slip displacement [m].
        exponent: n or m [-].
    """
    x = r / phi
    if way == Yielding.RICHARD_ABBOTT:
        return float(r * (1.0 + x**exponent) ** (-1.0 / exponent))
    left = 1.0 - x / exponent
    return float(phi if left <= 0.0 else phi * (1.0 - left**exponent))


@compiled(error_model="numpy")
def _masing(
    way: int,
    numbers: tuple[float, float],
    path: tuple[float, float, float],
    ways: tuple[int, int],
    turns: FloatArray,
) -> tuple[float, int, int]:
    """Move a law with Masing's rules; what lies beyond its turning points may change.

    Args:
        way: to yield.
        numbers: phi [m] and the exponent [-].
        path: motion before and after the move, and S before it [m].
        ways: number of turning points, and sense of the motion before the move.
        turns: motion and S at the turning points [m], shape (2, n_turns).

    Returns:
        S [m], number of turning points, and sense of the motion.
    """
    phi, exponent = numbers
    old, new, before = path
    depth, sense = ways
    if new == old:
        return before, depth, sense
    onward = 1 if new > old else -1
    if onward == -sense:
        turns[0, depth], turns[1, depth] = old, before
        depth += 1
    # A loop that closes is forgotten with both its turning points.
    while depth >= 2 and (new - turns[0, depth - 2]) * onward >= 0.0:
        depth -= 2
    if depth == 1 and new * onward >= abs(turns[0, 0]):
        depth = 0
    if depth == 0:
        s = loading_curve(way, abs(new), phi, exponent)
        return (s if new >= 0.0 else -s), depth, onward
    r, s = turns[0, depth - 1], turns[1, depth - 1]
    rise = 2.0 * loading_curve(way, 0.5 * abs(new - r), phi, exponent)
    return float(s + onward * rise), depth, onward


@compiled(error_model="numpy")
def _rate(u: float, sense: float, exponent: float, share: float) -> float:
    """Return du per motion over phi, of Bouc and Wen."""
    same = 1.0 if u * sense >= 0.0 else -1.0
    return float(1.0 - abs(u) ** exponent * (share + (1.0 - share) * same))


@compiled(error_model="numpy")
def _bouc_wen(u: float, move: float, exponent: float, share: float) -> float:
    """Return u after a move over phi, by Runge-Kutta steps."""
    largest = _UNLOADING_MOVE if u * move < 0.0 else _LARGEST_MOVE
    count = max(1, ceil(abs(move) / largest))
    h, sense = move / count, 1.0 if move >= 0.0 else -1.0
    for _ in range(count):
        a = _rate(u, sense, exponent, share)
        b = _rate(u + 0.5 * h * a, sense, exponent, share)
        c = _rate(u + 0.5 * h * b, sense, exponent, share)
        d = _rate(u + h * c, sense, exponent, share)
        u = min(max(u + h / 6.0 * (a + 2.0 * b + 2.0 * c + d), -1.0), 1.0)
    return u


@compiled(error_model="numpy")
def move_friction(
    numbers: FloatArray,
    motion: tuple[FloatArray, FloatArray],
    state: FrictionState,
    force: FloatArray,
    kept: bool,
) -> None:
    """Write the force of a law less that of its spring, for all hits.

    Args:
        numbers: k [N/m], phi [m], way to yield, its exponent, and b of Bouc and Wen.
        motion: before and after the move [m], shape (n_hits,) each.
        state: before the move; after it if it is kept.
        force: k (S - r) [N] (written), shape (n_hits,).
        kept: whether the state moves.
    """
    k, phi, exponent, share = numbers[0], numbers[1], numbers[3], numbers[4]
    way = int(numbers[2])
    old, new = motion
    turns, value, ways = state
    for h in range(force.size):
        if way == Yielding.BOUC_WEN:
            own = _bouc_wen(value[h], (new[h] - old[h]) / phi, exponent, share)
            s, depth, sense = phi * own, ways[0, h], ways[1, h]
        else:
            path, at = (old[h], new[h], value[h]), (ways[0, h], ways[1, h])
            s, depth, sense = _masing(way, (phi, exponent), path, at, turns[h])
            own = s
        if kept:
            value[h], ways[0, h], ways[1, h] = own, depth, sense
        force[h] = k * (s - new[h])
