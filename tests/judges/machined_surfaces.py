"""Machined surfaces by their kinematics: feed marks, cutter arcs, scratches, plateaus.

No spectrum is drawn: each tool leaves its trace in the heights.
"""

import numpy as np
from scipy.ndimage import gaussian_filter, gaussian_filter1d
from scipy.signal import lfilter


def _walk(rng, points, keep):
    """Return a rough line: an autoregressive process of unit variance."""
    white = rng.standard_normal(points)
    line = lfilter([1.0], [1.0, -keep], white)
    return line / line.std()


def turned(points, seed):
    """Return arcs of a round nose at a constant feed, with tearing."""
    rng = np.random.default_rng([seed, 1])
    feed = rng.uniform(60, 300)
    place = (np.arange(points) + rng.uniform(0, feed)) % feed - feed / 2
    marks = (place / feed) ** 2
    return marks / marks.std() + rng.uniform(0.2, 0.8) * _walk(rng, points, 0.9)


def milled(points, seed):
    """Return tooth marks of a cutter with run-out: each tooth at its own depth."""
    rng = np.random.default_rng([seed, 2])
    feed, teeth = rng.uniform(40, 120), int(rng.integers(2, 5))
    depth = 0.3 * rng.standard_normal(teeth)
    place = np.arange(points) + rng.uniform(0, feed * teeth)
    number = (place // feed).astype(int) % teeth
    marks = ((place % feed) / feed - 0.5) ** 2 + 0.3 * depth[number]
    return marks / marks.std() + rng.uniform(0.2, 0.7) * _walk(rng, points, 0.8)


def honed(side, seed):
    """Return a map of scratches in two directions, with its angles [rad]."""
    rng = np.random.default_rng([seed, 3])
    half = np.radians(rng.uniform(20, 35))
    middle = rng.uniform(-0.3, 0.3)
    y, x = np.mgrid[0:side, 0:side] - side / 2
    heights = 0.15 * gaussian_filter(rng.standard_normal((side, side)), 1.0)
    angles = (middle - half, middle + half)
    for angle in angles:
        across = y * np.cos(angle) - x * np.sin(angle)
        for _ in range(90):
            width = rng.uniform(1.0, 4.0)
            reach = rng.uniform(-0.75, 0.75) * side
            depth = rng.exponential(1.0)
            heights -= depth * np.exp(-0.5 * ((across - reach) / width) ** 2)
    return heights, angles


def plateau(points, seed):
    """Return a fine finish over deep valleys: the lower of two processes."""
    rng = np.random.default_rng([seed, 4])
    rough = gaussian_filter1d(rng.standard_normal(points), rng.uniform(15, 40))
    fine = 0.1 * _walk(rng, points, 0.7)
    return np.minimum(rough / rough.std(), -0.3 + fine)


def bifractal(points, seed):
    """Return a line of two exponents: the sum of walks of many memories.

    Weights of autoregressive lines of memory s run as s^H; H changes at one memory.
    """
    rng = np.random.default_rng([seed, 5])
    short, long = (0.25, 0.8) if seed % 2 else (0.8, 0.25)
    bend = rng.uniform(5, 12)
    total = np.zeros(points)
    for memory in np.geomspace(0.5, 4 * points, 48):
        keep = np.exp(-1 / memory)
        hurst = short if memory < bend else long
        size = (memory / bend) ** hurst
        begin = 8 * int(min(memory, points))
        white = rng.standard_normal(points + begin)
        smooth = lfilter([1 - keep], [1.0, -keep], white)
        smooth = lfilter([1 - keep], [1.0, -keep], smooth)[begin:]
        total += size * np.sqrt(memory) * smooth
    return total / total.std()


def exponential(points, length, seed):
    """Return a line of exponential correlation."""
    rng = np.random.default_rng([seed, 6])
    return _walk(rng, points, np.exp(-1 / length))
