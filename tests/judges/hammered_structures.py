# SPDX-License-Identifier: MIT
"""Hammered structures, integrated in time from their matrices, and what they show.

Nothing is shared with the modal estimators: accelerations come from the equations of
motion in physical coordinates, stepped by the matrix exponential with the force linear
between steps; poles are eigenvalues of the state matrix. Every hit is aimed a little
off its point. The Cramer-Rao bound of a measurement limits the modes that it can show.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.signal

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording

RATE = 1024.0
BLOCK = 4096
BAND = (15.0, 400.0)
_STEPS_A_SAMPLE = 8
_PRETRIGGER = 40
# Noise of the force over the peak: 0.01 N on a hammer for 500 N.
_FORCE_NOISE = 2e-5


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """Equations of motion M x'' + C x' + K x = f with M = identity.

    Attributes:
        damping: C [1/s], shape (n, n).
        stiffness: K [1/s^2], shape (n, n).
        places: n points, as rows that map x to displacements, shape (n_points, n).
    """

    damping: FloatArray
    stiffness: FloatArray
    places: FloatArray

    def state_matrix(self) -> FloatArray:
        """Return A of z' = A z + B f, z = (x, x')."""
        n = self.stiffness.shape[0]
        return np.block(
            [[np.zeros((n, n)), np.eye(n)], [-self.stiffness, -self.damping]]
        )

    def poles(self) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Return poles by ascending frequency, x at each point, drive of each point.

        Receptance residues are the products of the last two, shape (n, n_points).
        """
        value, right = np.linalg.eig(self.state_matrix())
        left = np.linalg.inv(right)
        keep = np.flatnonzero(value.imag > 0.0)
        keep = keep[np.argsort(value.imag[keep])]
        n = self.stiffness.shape[0]
        return (
            value[keep],
            (self.places @ right[:n, keep]).T,
            left[keep, n:] @ self.places.T,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Strike:
    """Repeated hits at one point, with accelerometers at others.

    Attributes:
        point: index of the point that is hit.
        sensors: indices of the points that carry accelerometers.
        channels: names of their channels.
    """

    point: int
    sensors: tuple[int, ...]
    channels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Bench:
    """How it is measured.

    Attributes:
        hits: at each point.
        decibel: rms of a response over that of its noise [dB].
        aim: sd of the share of a hit that acts at each other point [-].
    """

    hits: int = 3
    decibel: float = 50.0
    aim: float = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """Recordings, and the noise on them.

    Attributes:
        recordings: one a hit.
        pairs: output and input point of each response, shape (n_responses, 2).
        line_variance: of each response's FRF from that hit alone, shape
            (n_responses, n_lines).
        frequency: of these lines [Hz].
    """

    recordings: tuple[Recording, ...]
    pairs: IntArray
    line_variance: FloatArray
    frequency: FloatArray


def prescribed(
    frequency: FloatArray,
    ratio: FloatArray,
    n_points: int,
    rng: np.random.Generator,
    *,
    coupling: float = 0.02,
) -> Structure:
    """Return a structure near given modes, its damping not quite proportional.

    Args:
        frequency: [Hz], shape (n,).
        ratio: damping ratios [-], shape (n,).
        n_points: that can be hit or measured.
        rng: of shapes and of the damping between modes.
        coupling: damping between two modes over the root of their own [-].
    """
    n = frequency.size
    turn = np.linalg.qr(rng.normal(size=(n, n)))[0]
    omega = 2.0 * np.pi * frequency
    own = 2.0 * ratio * omega
    between = rng.normal(size=(n, n)) * coupling * np.sqrt(np.outer(own, own))
    damping = np.diag(own) + 0.5 * (between + between.T) * (1.0 - np.eye(n))
    places = rng.normal(size=(n_points, n))
    return Structure(turn @ damping @ turn.T, (turn * omega**2) @ turn.T, places)


def square_membrane(
    side: int,
    lowest: float,
    ratio: float,
    imperfection: float,
    n_points: int,
    rng: np.random.Generator,
) -> Structure:
    """Return a square net of masses on strings: modes (m, n) and (n, m) coincide.

    Args:
        side: masses along each edge.
        lowest: natural frequency of mode (1, 1) [Hz].
        ratio: damping ratio of that mode, all others a little more [-].
        imperfection: relative sd of the masses; 0 makes the pairs exact [-].
        n_points: anywhere between the masses.
        rng: of imperfection and points.
    """
    line = 2.0 * np.eye(side) - np.eye(side, k=1) - np.eye(side, k=-1)
    net = np.kron(line, np.eye(side)) + np.kron(np.eye(side), line)
    # Strings across the meshes: without them more than two modes would coincide.
    net = net + 0.25 * np.kron(line, line)
    first = float(np.linalg.eigvalsh(net)[0])
    omega = 2.0 * np.pi * lowest
    mass = 1.0 + imperfection * rng.normal(size=side**2)
    root = 1.0 / np.sqrt(mass)
    stiffness = net * omega**2 / first * np.outer(root, root)
    damping = ratio * (omega * np.eye(side**2) + stiffness / omega)
    return Structure(damping, stiffness, _anywhere(side, n_points, rng) * root)


def _anywhere(side: int, n_points: int, rng: np.random.Generator) -> FloatArray:
    """Return points between masses, each a mean over the four around it."""
    places = np.zeros((n_points, side, side))
    for place in places:
        i, j = rng.integers(0, side - 1, 2)
        share = rng.uniform(0.1, 0.9, 2)
        one = np.outer((1 - share[0], share[0]), (1 - share[1], share[1]))
        place[i : i + 2, j : j + 2] = one
    return places.reshape(n_points, -1)


def strike(
    structure: Structure,
    strikes: Sequence[Strike],
    bench: Bench,
    rng: np.random.Generator,
) -> Measured:
    """Hit a structure and record it.

    Args:
        structure: what is hit.
        strikes: where, and what measures.
        bench: how.
        rng: of pulses, aim and noise.
    """
    which = [s for s in strikes for _ in range(bench.hits)]
    force = _pulses(len(which), rng)
    off = bench.aim * rng.normal(size=(len(which), structure.places.shape[0]))
    off[np.arange(len(which)), [s.point for s in which]] = 1.0
    seen = sorted({sensor for s in which for sensor in s.sensors})
    moved = _integrate(structure, force, off @ structure.places, seen)
    decimated = scipy.signal.decimate(
        force, _STEPS_A_SAMPLE, ftype="fir", axis=0, zero_phase=True
    )
    recordings, pairs, variance = [], [], []
    for number, one in enumerate(which):
        clean = moved[:, [seen.index(sensor) for sensor in one.sensors], number].T
        clean = scipy.signal.decimate(
            clean, _STEPS_A_SAMPLE, ftype="fir", axis=1, zero_phase=True
        )
        sd = np.sqrt(np.mean(clean**2, axis=1)) * 10.0 ** (-bench.decibel / 20.0)
        noisy = clean + sd[:, None] * rng.normal(size=clean.shape)
        hammer = decimated[:, number]
        own = _FORCE_NOISE * hammer.max()
        hammer = hammer + own * rng.normal(size=hammer.size)
        recordings.append(_recording(number, one, hammer, noisy))
        power = np.abs(np.fft.rfft(decimated[:, number])) ** 2
        gain = np.abs(np.fft.rfft(clean, axis=1)) ** 2 / power
        total = sd[:, None] ** 2 + own**2 * gain
        variance.extend(total * hammer.size / power)
        pairs.extend((sensor, one.point) for sensor in one.sensors)
    return Measured(
        tuple(recordings),
        np.array(pairs),
        np.array(variance),
        np.fft.rfftfreq(BLOCK + _PRETRIGGER, 1.0 / RATE),
    )


def _recording(
    number: int, one: Strike, hammer: FloatArray, response: FloatArray
) -> Recording:
    channels = [Channel("hammer", Quantity.FORCE, point=str(one.point))]
    channels += [
        Channel(name, Quantity.ACCELERATION, point=str(sensor))
        for name, sensor in zip(one.channels, one.sensors, strict=True)
    ]
    samples = np.vstack((hammer, response))
    return Recording(f"hit {number}", samples, RATE, tuple(channels))


def _pulses(count: int, rng: np.random.Generator) -> FloatArray:
    """Return rounded half sines of 1.2 to 1.8 ms, shape (n_steps, count)."""
    rate = RATE * _STEPS_A_SAMPLE
    time = np.arange((BLOCK + _PRETRIGGER) * _STEPS_A_SAMPLE) / rate
    begin = _PRETRIGGER / RATE + rng.uniform(0.0, 1.0 / RATE, count)
    width, peak = rng.uniform(1.2e-3, 1.8e-3, count), rng.uniform(80.0, 160.0, count)
    phase = np.clip((time[:, None] - begin) / width, 0.0, 1.0)
    return np.asarray(peak * np.sin(np.pi * phase).clip(0.0) ** 1.5)


def _integrate(
    structure: Structure, force: FloatArray, where: FloatArray, seen: Sequence[int]
) -> FloatArray:
    """Step the equations of motion; return x'' as seen, (n_steps, n_seen, n_hits)."""
    n, (n_steps, n_hits) = structure.stiffness.shape[0], force.shape
    step = 1.0 / (RATE * _STEPS_A_SAMPLE)
    # exp of [[A, I, 0], [0, 0, I / h], [0, 0, 0]] h holds all three matrices.
    size = 2 * n
    large = np.zeros((3 * size, 3 * size))
    large[:size, :size] = structure.state_matrix() * step
    large[:size, size : 2 * size] = step * np.eye(size)
    large[size : 2 * size, 2 * size :] = np.eye(size)
    whole = scipy.linalg.expm(large)
    phi, one = whole[:size, :size], whole[:size, 2 * size :]
    zero = whole[:size, size : 2 * size] - one
    drive = np.vstack((np.zeros((n, n_hits)), where.T))
    ahead, now = one @ drive, zero @ drive
    output = structure.places[list(seen)]
    law = -output @ np.hstack((structure.stiffness, structure.damping))
    through = output @ where.T
    state, result = np.zeros((size, n_hits)), np.empty((n_steps, len(seen), n_hits))
    for i in range(n_steps - 1):
        result[i] = law @ state + through * force[i]
        state = phi @ state + now * force[i] + ahead * force[i + 1]
    result[-1] = law @ state + through * force[-1]
    return result


def pole_bound(
    structure: Structure, measured: Measured, band: tuple[float, float] = BAND
) -> tuple[ComplexArray, FloatArray]:
    """Return the poles within a band and the least sd that any estimator can have.

    The Cramer-Rao bound with residues of every pair unknown and the modes beyond the
    band known; noise of force and responses.

    Args:
        structure: what was hit.
        measured: where, and with what noise.
        band: that is fitted [Hz].

    Returns:
        Poles [rad/s], shape (n,), and sd of their real and imaginary parts, shape
        (n, 2).
    """
    pole, moved, drive = structure.poles()
    frequency = np.abs(pole) / (2.0 * np.pi)
    own = np.flatnonzero((frequency > band[0]) & (frequency < band[1]))
    keep = (measured.frequency > band[0]) & (measured.frequency < band[1])
    s = 2j * np.pi * measured.frequency[keep][:, None]
    p = pole[own]
    residue = np.array([moved[own, o] * drive[own, i] for o, i in measured.pairs])
    unique, group = np.unique(measured.pairs, axis=0, return_inverse=True)
    total = np.zeros((2 * own.size, 2 * own.size))
    for number in range(len(unique)):
        rows = np.flatnonzero(group == number)
        weight = np.sqrt(2.0 * np.sum(1.0 / measured.line_variance[rows], axis=0)[keep])
        linear = _columns(s**2 / (s - p), s**2 / (s - p.conj()), np.ones(own.size))
        slope = _columns(
            s**2 / (s - p) ** 2, s**2 / (s - p.conj()) ** 2, residue[rows[0]]
        )
        linear, slope = (
            np.concatenate((c.real, c.imag)) * np.tile(weight, 2)[:, None]
            for c in (linear, slope)
        )
        basis = np.linalg.qr(linear)[0]
        slope = slope - basis @ (basis.T @ slope)
        total += slope.T @ slope
    scale = 1.0 / np.sqrt(np.diag(total))
    inverse = np.linalg.pinv(total * np.outer(scale, scale), rcond=1e-14)
    sd = np.sqrt(np.maximum(np.diag(inverse), 0.0)) * scale
    return p, sd.reshape(-1, 2)


def _columns(
    one: ComplexArray, mirrored: ComplexArray, factor: ComplexArray | FloatArray
) -> ComplexArray:
    """Return columns of the real and of the imaginary part, two a mode."""
    columns = np.empty((one.shape[0], 2 * one.shape[1]), complex)
    columns[:, ::2] = one * factor + mirrored * np.conj(factor)
    columns[:, 1::2] = 1j * (one * factor - mirrored * np.conj(factor))
    return columns
