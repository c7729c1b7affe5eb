# SPDX-License-Identifier: MIT
"""Simulated surfaces with one hidden effect, made in the space domain.

No spectrum of the estimator is drawn: self-affine lines are exact by their covariance
or sums of relaxing steps of many memories, instruments act on a finer grid (a ball
rolls, a pixel averages, a converter rounds), and tools leave their arcs.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import gaussian_filter1d, uniform_filter1d
from scipy.signal import lfilter

from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid

FINER = 4
"""Points of the fine grid for each sample [-]."""
LINE_EFFECTS = (
    "rolloff",
    "tip",
    "blur",
    "noise",
    "quantisation",
    "tool_marks",
    "second_process",
    "plateau",
    "form",
    "outliers",
    "missing_points",
)
MAP_EFFECTS = ("lay",)


@dataclass(frozen=True, slots=True)
class MadeSurface:
    """A simulated surface.

    Attributes:
        truth: name of the hidden effect; empty for none.
        surface: as the instrument exports it.
        facts: what was drawn.
    """

    truth: str
    surface: Profile | Areal
    facts: dict[str, float] = field(default_factory=dict)


def stationary(rng, points, correlation):
    """Return a Gaussian line of a given correlation by circulant embedding."""
    lag = np.minimum(np.arange(2 * points), 2 * points - np.arange(2 * points))
    values = np.maximum(np.fft.fft(correlation(lag)).real, 0.0)
    white = rng.standard_normal(2 * points) + 1j * rng.standard_normal(2 * points)
    return np.fft.fft(np.sqrt(values / values.size) * white).real[:points]


def fractional_walk(rng, points, hurst):
    """Return exact fractional Brownian motion of S = lag^(2H)."""

    def increments(lag):
        sides = np.abs(lag + 1.0) ** (2 * hurst) + np.abs(lag - 1.0) ** (2 * hurst)
        return 0.5 * sides - np.abs(1.0 * lag) ** (2 * hurst)

    return np.cumsum(stationary(rng, points, increments))


def relaxing_steps(rng, points, hurst):
    """Return a sum of walks that forget, with memories of all lengths."""
    total = np.zeros(points)
    for memory in np.geomspace(0.4, 20.0 * points, 60):
        keep = np.exp(-1.0 / memory)
        line = lfilter([1.0], [1.0, -keep], rng.standard_normal(points))
        # Stationary from the first point.
        line += rng.standard_normal() * keep ** np.arange(points)
        line *= np.sqrt(1.0 - keep**2)
        total += memory**hurst * line
    return total / np.sqrt(np.mean(np.diff(total) ** 2))


def self_affine(rng, points, hurst):
    """Return a self-affine line by one of two generators."""
    if rng.random() < 0.7 or hurst > 0.8:
        return fractional_walk(rng, points, hurst)
    return relaxing_steps(rng, points, hurst)


def saturating(rng, points, hurst, length):
    """Return a line that rolls off: exponential or Cauchy correlation."""
    if rng.random() < 0.4:
        return stationary(rng, points, lambda x: np.exp(-x / length)), 0.5
    power = 2 * hurst
    return stationary(
        rng, points, lambda x: (1 + (x / length) ** power) ** (-2.0 / power)
    ), hurst


def rolled(line, radius, pitch):
    """Return the path of the centre of a ball, less its radius."""
    reach = int(min(radius * 0.999, np.sqrt(2 * radius * np.ptp(line))) / pitch) + 1
    reach = min(reach, line.size // 4)
    offset = np.arange(-reach, reach + 1)
    inside = np.maximum(radius**2 - (offset * pitch) ** 2, 0.0)
    cap = np.sqrt(inside) - radius
    padded = np.pad(line, reach, mode="edge")
    path = np.full(line.size, -np.inf)
    for k, drop in enumerate(cap):
        np.maximum(path, padded[k : k + line.size] + drop, out=path)
    return path


def step_size(line, lag=FINER):
    """Return the root of S at one sample."""
    return float(np.sqrt(np.mean((line[lag:] - line[:-lag]) ** 2)))


def make_surface(seed, truth):
    """Return one simulated surface.

    Args:
        seed: of everything drawn.
        truth: name of the effect, empty for none, of `LINE_EFFECTS` or `MAP_EFFECTS`;
            "isotropic" is a map without an effect.
    """
    names = ("", *LINE_EFFECTS, *MAP_EFFECTS, "isotropic")
    rng = np.random.default_rng([seed, names.index(truth), 9])
    if truth in (*MAP_EFFECTS, "isotropic"):
        return _made_map(rng, seed, truth)
    points = int(rng.integers(3000, 7000))
    pitch = float(10 ** rng.uniform(-6.6, -5.8))
    hurst = float(rng.uniform(0.35, 0.85))
    size = float(10 ** rng.uniform(-8.0, -7.0))
    facts = {"points": points, "pitch": pitch, "hurst": hurst}
    fine = points * FINER
    before = {"rolloff": _rolloff, "second_process": _second, "plateau": _plateau}
    if truth in before:
        line = before[truth](rng, fine, hurst, facts)
    else:
        line = self_affine(rng, fine, hurst)
    line = size * line / step_size(line)
    line = _traced(rng, line, truth, pitch, facts)
    after = {
        "noise": _noise,
        "form": _form,
        "outliers": _outliers,
        "missing_points": _missing,
        "quantisation": _rounded,
    }
    if truth in after:
        line = after[truth](rng, line, facts)
    tilt = rng.standard_normal() * np.ptp(line) / points
    if truth != "quantisation":
        line = line + tilt * np.arange(points)
    if truth == "missing_points":
        line = _filled(rng, line, facts)
    made = Profile(f"surface-{seed}", line, pitch, all_valid(line))
    return MadeSurface(truth, made, facts)


def _rolloff(rng, fine, hurst, facts):
    samples = fine / FINER
    length = np.exp(rng.uniform(np.log(12.0), np.log(samples / 60)))
    line, found = saturating(rng, fine, hurst, length * FINER)
    facts |= {"hurst": found, "length": length}
    return line


def _second(rng, fine, hurst, facts):
    """Add a rougher process to a smoother one, or memories of two exponents."""
    lag = int(FINER * np.exp(rng.uniform(np.log(10.0), np.log(50.0))))
    smooth, rough = rng.uniform(0.8, 0.95), rng.uniform(0.1, 0.25)
    facts |= {"equal_lag": lag / FINER, "smooth": smooth, "rough": rough}
    if rng.random() < 0.5:
        facts |= {"hurst": rough}
        one, two = (fractional_walk(rng, fine, h) for h in (smooth, rough))
        return one / step_size(one, lag) + two / step_size(two, lag)
    facts |= {"hurst": smooth}
    total = np.zeros(fine)
    for memory in np.geomspace(1.0, 5.0 * fine, 48):
        keep = np.exp(-1.0 / memory)
        white = rng.standard_normal(fine + int(min(8 * memory, 2 * fine)))
        line = lfilter([1.0 - keep], [1.0, -keep], white)
        line = lfilter([1.0 - keep], [1.0, -keep], line)[-fine:]
        size = (memory / lag) ** (smooth if memory < lag else rough)
        total += size * np.sqrt(memory) * line
    return total


def _plateau(rng, fine, hurst, facts):
    """Cut a rough surface at a level and leave a finer finish there."""
    length = FINER * rng.uniform(15.0, 60.0)
    rough, _ = saturating(rng, fine, hurst, length)
    if rng.random() < 0.5:
        rough = gaussian_filter1d(rough, 0.1 * length)
    rough = rough / rough.std()
    finish, _ = saturating(rng, fine, 0.5, FINER * rng.uniform(4.0, 15.0))
    share = rng.uniform(0.02, 0.08)
    level = rng.uniform(-0.6, 0.0)
    facts |= {"level": level, "finish": share}
    return np.minimum(rough, level + share * finish / finish.std())


def _traced(rng, line, truth, pitch, facts):
    """Return samples of the fine line, by tip, optics or points."""
    first = int(rng.integers(FINER))
    if truth == "tip":
        # A parabola and the line bend alike at this lag.
        lag = np.exp(rng.uniform(np.log(2.5), np.log(9.0)))
        radius = (lag * pitch) ** 2 / step_size(line, max(1, round(lag * FINER)))
        facts |= {"radius": radius, "contact_length": lag}
        line = rolled(line, radius, pitch / FINER)
    if truth == "tool_marks":
        line = _marks(rng, line, facts)
    if truth == "blur":
        width = np.exp(rng.uniform(np.log(0.8), np.log(4.0)))
        facts |= {"sigma": width * pitch}
        line = gaussian_filter1d(line, width * FINER)
        line = uniform_filter1d(line, FINER)
    return line[first::FINER].copy()


def _noise(rng, line, facts):
    share = np.exp(rng.uniform(np.log(0.3), np.log(2.0)))
    sd = share * step_size(line, 1)
    facts |= {"sd": sd}
    return line + sd * rng.standard_normal(line.size)


def _rounded(rng, line, facts):
    step = np.exp(rng.uniform(np.log(1.0), np.log(4.0))) * step_size(line, 1)
    facts |= {"step": step}
    return step * np.round(line / step + rng.uniform())


def _marks(rng, line, facts):
    """Add arcs of a round nose, or the teeth of a cutter with run-out."""
    feed = FINER * np.exp(rng.uniform(np.log(15.0), np.log(120.0)))
    place = np.arange(line.size) + rng.uniform(0, feed)
    marks = ((place % feed) / feed - 0.5) ** 2
    period = feed
    if rng.random() < 0.4:
        teeth = int(rng.integers(2, 5))
        depth = 0.1 * rng.standard_normal(teeth)
        marks = marks + depth[(place // feed).astype(int) % teeth]
        period = feed * teeth
    level = line - np.polynomial.Polynomial.fit(np.arange(line.size), line, 1)(
        np.arange(line.size)
    )
    share = rng.uniform(0.15, 1.5)
    facts |= {"feed": feed / FINER, "period": period / FINER, "ratio": share}
    # A nose and a tip round the edges.
    marks = uniform_filter1d(marks, 3 * FINER)
    return line + share * level.std() * marks / marks.std()


def _form(rng, line, facts):
    """Bow the line: an arc, with some of a third power."""
    x = np.linspace(-1, 1, line.size)
    level = line - np.polynomial.Polynomial.fit(x, line, 1)(x)
    size = np.exp(rng.uniform(np.log(25.0), np.log(200.0))) * level.std()
    bow = x**2 + rng.uniform(-0.3, 0.3) * x**3 + rng.uniform(-0.1, 0.1) * x**4
    facts |= {"bow": size}
    return line + size * rng.choice((-1, 1)) * bow


def _outliers(rng, line, facts):
    """Add spikes of dust and lost light."""
    count = max(6, int(line.size * 10 ** rng.uniform(-2.7, -2.0)))
    place = rng.choice(line.size, count, replace=False)
    size = np.exp(rng.uniform(np.log(8.0), np.log(40.0))) * step_size(line, 1)
    sign = 1.0 if rng.random() < 0.5 else rng.choice((-1, 1), count)
    line[place] += sign * size * rng.uniform(0.5, 1.5, count)
    facts |= {"share": count / line.size, "size": size}
    return line


def _missing(rng, line, facts):
    facts |= {"kind": float(rng.random() < 0.6)}
    return line


def _filled(rng, line, facts):
    """Fill dropouts by straight lines or by one number."""
    if facts["kind"]:
        for _ in range(int(rng.integers(4, 16))):
            first = int(rng.integers(1, line.size - 60))
            last = first + int(rng.integers(8, 40))
            line[first:last] = np.interp(
                np.arange(first, last), [first - 1, last], line[[first - 1, last]]
            )
        return line
    count = max(6, int(line.size * 10 ** rng.uniform(-2.7, -2.0)))
    line[rng.choice(line.size, count, replace=False)] = np.median(line)
    return line


def _made_map(rng, seed, truth):
    """Return a map: random disturbances of all sizes, elongated for a lay."""
    side, finer = int(rng.integers(100, 160)), 2
    hurst = rng.uniform(0.4, 0.8)
    ratio = np.exp(rng.uniform(np.log(1.4), np.log(4.0))) if truth == "lay" else 1.0
    angle = rng.uniform(-np.pi / 2, np.pi / 2)
    spread = 6 * side
    y, x = np.mgrid[0:spread, 0:spread]
    x, y = (
        np.minimum(one, spread - one) * np.where(one > spread // 2, -1, 1)
        for one in (x, y)
    )
    u = (x * np.cos(angle) + y * np.sin(angle)) / np.sqrt(ratio)
    v = (y * np.cos(angle) - x * np.sin(angle)) * np.sqrt(ratio)
    lag = np.hypot(u, v) / (0.4 * side * np.sqrt(ratio))
    bell = (1 + lag ** (2 * hurst)) ** (-1.0 / hurst)
    values = np.maximum(np.fft.fft2(bell).real, 0.0)
    white = rng.standard_normal((2, spread, spread))
    both = np.fft.fft2(np.sqrt(values / values.size) * (white[0] + 1j * white[1]))
    heights = both.real[: side * finer : finer, : side * finer : finer]
    heights = 1e-7 * heights / heights.std()
    pitch = float(10 ** rng.uniform(-6.5, -6.0))
    facts = {"hurst": hurst, "ratio": ratio, "angle": angle}
    made = Areal(f"map-{seed}", heights.copy(), (pitch, pitch), all_valid(heights))
    return MadeSurface("" if truth == "isotropic" else truth, made, facts)
