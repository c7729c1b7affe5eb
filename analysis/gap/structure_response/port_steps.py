# SPDX-License-Identifier: MIT
"""The compiled time integration of modes and laws, hits side by side.

Complex values are held as real and imaginary parts. Hits are the last axis, so that all
of them are moved by the same instructions; only sliders are side by side themselves.
Sums of arrays are loops: an expression of arrays takes half a second to compile.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled

_Laws = tuple[IntArray, FloatArray, FloatArray, FloatArray, FloatArray, IntArray]
"""Kinds, sizes, gaps, slips, weights and number of sharp sliders of the ports."""
_Steps = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""Factor of a step; what forces at its begin and its end move along straight lines, at
its end along a parabola, and constant ones."""
_Ports = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""Drive, motion, velocity, push and instantaneous receptances."""


@compiled(fastmath=True)
def _slide(
    laws: _Laws,
    scale: FloatArray,
    motion: tuple[FloatArray, FloatArray, FloatArray],
    stretch: tuple[FloatArray, FloatArray],
    d: FloatArray,
) -> None:
    """Write the forces of sliders, and their stretch.

    A sharp slider holds up to its limit, then slips. A gradual one follows u' = r' /
    phi (1 - |u| (|u| + u sgn r') / 2): elastic while it is unloaded, and along tanh
    (r / phi) while it is loaded, by the addition formula of tanh; the tangent of a
    step is its Pade approximant, exact to 1e-4 up to a half of phi.

    Args:
        laws: of the ports; each has its sharp sliders first.
        scale: of the slips, shape (n_ports, n_hits).
        motion: of the ports before and after the step, and velocity after it.
        stretch: before the step, and after it (written), shape
            (n_ports, n_hits, n_sliders); [m], of gradual sliders over their slip
            displacement.
        d: forces beyond the linear springs (written), shape (n_ports, n_hits).
    """
    kinds, sizes, slips, weights, sharp = laws[0], laws[1], laws[3], laws[4], laws[5]
    old, new, _ = motion
    before, after = stretch
    for p in range(d.shape[0]):
        if kinds[p] != 0:
            continue
        for h in range(d.shape[1]):
            moved, held, own = new[p, h] - old[p, h], 0.0, scale[p, h]
            for i in range(sharp[p]):
                limit = own * slips[p, i]
                e = min(max(before[p, h, i] + moved, -limit), limit)
                after[p, h, i] = e
                held += weights[p, i] * e
            d[p, h] = sizes[p] * (held - new[p, h])
        for i in range(sharp[p], slips.shape[1]):
            for h in range(d.shape[1]):  # without branches: hits side by side
                limit = scale[p, h] * slips[p, i]
                step, way = (new[p, h] - old[p, h]) / limit, 1.0
                if step < 0.0:
                    way = -1.0
                u, moved = way * before[p, h, i], way * step
                rest, start = moved + min(u, 0.0), max(u, 0.0)
                loading = max(rest, 0.0)
                square = loading * loading
                turn = min(loading * (15.0 + square) / (15.0 + 6.0 * square), 1.0)
                u = way * (min(rest, 0.0) + (start + turn) / (1.0 + start * turn))
                after[p, h, i] = u
                d[p, h] += sizes[p] * limit * weights[p, i] * u


@compiled(fastmath=True)
def _port_forces(
    laws: _Laws,
    scale: FloatArray,
    motion: tuple[FloatArray, FloatArray, FloatArray],
    stretch: tuple[FloatArray, FloatArray],
    d: FloatArray,
) -> None:
    """Write the force of each law, and the stretch of its sliders.

    Args:
        laws: kinds, sizes, gaps, slips, weights and number of sharp sliders.
        scale: of the slips of each port, shape (n_ports, n_hits).
        motion: of the ports before and after the step, and velocity after it.
        stretch: of the sliders before the step, and after it (written), shape
            (n_ports, n_hits, n_sliders).
        d: force of each port (written), shape (n_ports, n_hits).
    """
    kinds, sizes, gaps = laws[0], laws[1], laws[2]
    r, v = motion[1], motion[2]
    _slide(laws, scale, motion, stretch, d)
    for p in range(d.shape[0]):
        size, gap = sizes[p], gaps[p]
        if kinds[p] == 1:
            for h in range(d.shape[1]):
                d[p, h] = size * max(r[p, h] - gap, 0.0)
        elif kinds[p] == 2:
            for h in range(d.shape[1]):
                d[p, h] = size * r[p, h] * r[p, h] * r[p, h]
        elif kinds[p] == 3:
            for h in range(d.shape[1]):
                d[p, h] = size * r[p, h] * r[p, h]
        elif kinds[p] == 4:
            for h in range(d.shape[1]):
                d[p, h] = size * v[p, h] * abs(v[p, h])


@compiled(fastmath=True)
def _rests(
    steps: _Steps,
    ports: _Ports,
    x: FloatArray,
    sliders: tuple[FloatArray, FloatArray, FloatArray],
    now: tuple[FloatArray, FloatArray],
    hit: int,
) -> bool:
    """Return whether no slider of a hit can slip again.

    With constant forces each mode decays about its rest, so the sum of its magnitudes
    bounds the motion of every port from now on.

    Args:
        steps: of all modes.
        ports: as in `integrate_hits`.
        x: modal coordinates without the forces at the end of the step.
        sliders: slips, stretch, and scale of the slips.
        now: motion of the ports and their forces, shape (n_ports, n_hits) each.
        hit: which.
    """
    late, gain = steps[3], steps[4]
    shown, push = ports[1], ports[3]
    slips, stretch, scale = sliders
    motion, d = now
    n_ports, n_poles = shown.shape[0], late.shape[1]
    centre, reach = np.zeros(n_ports), np.zeros(n_ports)
    for j in range(n_poles):
        u, v = 0.0, 0.0
        for q in range(n_ports):
            u += push[0, q, j] * d[q, hit]
            v += push[1, q, j] * d[q, hit]
        re = gain[0, j] * u - gain[1, j] * v
        im = gain[0, j] * v + gain[1, j] * u
        off = x[j, hit] + late[0, j] * u - late[1, j] * v - re
        out = x[n_poles + j, hit] + late[0, j] * v + late[1, j] * u - im
        size = np.sqrt(off**2 + out**2)
        for p in range(n_ports):
            one, two = shown[p, j], shown[p, n_poles + j]
            centre[p] += one * re + two * im
            reach[p] += np.sqrt(one**2 + two**2) * size
    for p in range(n_ports):
        for i in range(slips.shape[1]):
            middle = stretch[p, hit, i] + centre[p] - motion[p, hit]
            if abs(middle) + reach[p] > scale[p, hit] * slips[p, i]:
                return False
    return True


@compiled(fastmath=True)
def _propagate(grow: FloatArray, added: FloatArray, x: FloatArray) -> None:
    """Move all modes through one step, with the forces of the ports before it.

    Args:
        grow: factor of each mode, shape (2, n_poles).
        added: modal coordinates by these forces, shape of x.
        x: modal coordinates (changed), shape (2 n_poles, n_hits).
    """
    n_poles = grow.shape[1]
    for j in range(n_poles):
        c, s, k = grow[0, j], grow[1, j], n_poles + j
        for h in range(x.shape[1]):
            re, im = x[j, h], x[k, h]
            x[j, h] = c * re - s * im + added[j, h]
            x[k, h] = c * im + s * re + added[k, h]


@compiled(fastmath=True)
def _strike(
    steps: _Steps,
    struck: FloatArray,
    force: tuple[FloatArray, FloatArray],
    x: FloatArray,
) -> None:
    """Add what the hammer moves in one step.

    Args:
        steps: of all modes.
        struck: modal force of each hit per N, shape (2, n_poles, n_hits).
        force: before and after the step [N], shape (n_hits,) each.
        x: modal coordinates (changed).
    """
    early, late = steps[1], steps[2]
    f0, f1 = force
    n_poles = early.shape[1]
    for j in range(n_poles):
        a, b, c, d = early[0, j], late[0, j], early[1, j], late[1, j]
        for h in range(f0.size):
            u, v = struck[0, j, h], struck[1, j, h]
            re, im = a * f0[h] + b * f1[h], c * f0[h] + d * f1[h]
            x[j, h] += u * re - v * im
            x[n_poles + j, h] += u * im + v * re


@compiled(fastmath=True)
def _add(share: float, d: FloatArray, to: FloatArray) -> None:
    """Add a share of the forces of all ports, shape (n_ports, n_hits)."""
    for p in range(d.shape[0]):
        for h in range(d.shape[1]):
            to[p, h] += share * d[p, h]


@compiled(fastmath=True)
def _follow(d: FloatArray, pair: FloatArray) -> None:
    """Put the forces of the ports before those of the step before, and guess the next.

    The guess continues a straight line, so that one correction is as good as two.
    """
    n_ports = d.shape[0]
    for p in range(n_ports):
        for h in range(d.shape[1]):
            now, before = d[p, h], pair[p, h]
            pair[n_ports + p, h] = before
            pair[p, h] = now
            d[p, h] = 2.0 * now - before


@compiled(fastmath=True)
def _respond(
    instant: FloatArray, d: FloatArray, base: FloatArray, new: FloatArray
) -> None:
    """Write the motion of the ports with the forces at the end of the step.

    Args:
        instant: receptances of the ports within a step, shape (n_ports, n_ports).
        d: forces of the ports, shape (n_ports, n_hits).
        base: motion without them, same shape.
        new: motion (written), same shape.
    """
    for p in range(d.shape[0]):
        for h in range(d.shape[1]):
            new[p, h] = base[p, h]
        for q in range(d.shape[0]):
            factor = instant[p, q]
            for h in range(d.shape[1]):
                new[p, h] += factor * d[q, h]


@compiled(fastmath=True)
def _between(
    force: FloatArray, at: tuple[int, int, int], f0: FloatArray, f1: FloatArray
) -> None:
    """Write the force before and after one part of a sample.

    Args:
        force: [N], shape (n_samples, n_hits).
        at: sample, part of it, and parts of a sample.
        f0: before the part (written), shape (n_hits,).
        f1: after it (written), same shape.
    """
    t, part, parts = at
    for h in range(f0.size):
        rise = (force[t + 1, h] - force[t, h]) / parts
        f0[h] = force[t, h] + part * rise
        f1[h] = f0[h] + rise


@compiled()
def _depends_on_speed(kinds: IntArray) -> bool:
    """Return whether a law depends on the velocity of its port."""
    for kind in kinds:
        if kind == 4:
            return True
    return False


@compiled()
def _last_force(force: FloatArray) -> int:
    """Return the last sample with a force, 0 if there is none."""
    end = int(force.shape[0]) - 1
    while end > 0:
        for h in range(force.shape[1]):
            if force[end, h] != 0.0:
                return end
        end -= 1
    return end


@compiled(fastmath=True)
def integrate_hits(
    steps: _Steps,
    ports: _Ports,
    laws: _Laws,
    scale: FloatArray,
    hits: tuple[FloatArray, FloatArray],
    numbers: tuple[int, int, int],
    found: FloatArray,
) -> None:
    """Integrate hits side by side; `found` receives the forces.

    Args:
        steps: of all modes.
        ports: as in `integrate_hits`.
        laws: of the ports.
        scale: of the slips, shape (n_ports, n_hits).
        hits: modal force of each hit per N, shape (2, n_poles, n_hits), and force [N],
            shape (n_samples, n_hits).
        numbers: steps per sample, corrections per step, and samples between two
            questions whether the sliders rest (0: never).
        found: zeros, shape (n_samples, n_ports, n_hits).
    """
    drive, shown, speeds, instant = ports[0], ports[1], ports[2], ports[4]
    parts, corrections, asked = numbers
    struck, force = hits
    slips = laws[3]
    n_samples, n_ports, n_hits = found.shape
    x = np.zeros((drive.shape[0], n_hits))
    added = np.zeros((drive.shape[0], n_hits))
    first = np.zeros((n_ports, n_hits, slips.shape[1]))
    last = np.zeros((n_ports, n_hits, slips.shape[1]))
    d, old = np.zeros((n_ports, n_hits)), np.zeros((n_ports, n_hits))
    pair = np.zeros((2 * n_ports, n_hits))
    base, new = np.zeros((n_ports, n_hits)), np.zeros((n_ports, n_hits))
    drift, speed = np.zeros((n_ports, n_hits)), np.zeros((n_ports, n_hits))
    f0, f1 = np.zeros(n_hits), np.zeros(n_hits)
    moving, end = _depends_on_speed(laws[0]), _last_force(force)
    for t in range(n_samples - 1):
        for part in range(parts):
            _follow(d, pair)
            np.dot(drive, pair, added)
            _propagate(steps[0], added, x)
            if t <= end:
                _between(force, (t, part, parts), f0, f1)
                _strike(steps, struck, (f0, f1), x)
            np.dot(shown, x, base)
            if moving:
                np.dot(speeds, x, drift)
            for _ in range(corrections):
                _respond(instant[0], d, base, new)
                if moving:
                    _respond(instant[1], d, drift, speed)
                _port_forces(laws, scale, (old, new, speed), (first, last), d)
            first, last, old, new = last, first, new, old
            share = (part + 1) / parts
            _add(share / parts, d, found[t + 1])
            if share < 1.0:
                _add((1.0 - share) / parts, d, found[t])
        if asked > 0 and t > end and t % asked == 0:
            resting = True
            for h in range(n_hits):
                sliders = (slips, first, scale)
                if not _rests(steps, ports, x, sliders, (old, d), h):
                    resting = False
                    break
            if resting:
                _add(0.5 * (1.0 - 1.0 / parts), d, found[t + 1])
                for later in range(t + 2, n_samples):
                    _add(1.0, d, found[later])
                break
