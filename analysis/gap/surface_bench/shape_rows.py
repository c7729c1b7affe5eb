# SPDX-License-Identifier: MIT
"""Numbers of a surface that no spectrum has: skewness, spikes, steps and fillings."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, freeze
from jointbench.analysis.gap.surface_bench.rounded_bends import (
    rounded_bend_kurtosis,
)
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE


class ShapeRow(IntEnum):
    """Rows in their order."""

    SKEWNESS = 0
    """asinh of the skewness of the levelled heights."""
    BEND_SKEWNESS = 1
    """asinh of the skewness of second differences of neighbours."""
    BEND_KURTOSIS = 2
    """ln(1 + excess kurtosis) of the same."""
    FILLED = 3
    """ln(1 + points that lie on straight runs or repeat one height)."""
    GRID = 4
    """1 where all heights are multiples of a step that matters, else 0."""


WORDS = (
    "skewness of heights",
    "skewness of bends",
    "kurtosis of bends",
    "filled points",
    "steps",
)


@dataclass(frozen=True, slots=True, eq=False)
class ShapeRows:
    """Measured shape numbers with their scatter on a Gaussian line.

    Attributes:
        value: shape (5,).
        expected: on a Gaussian line of the same spectrum, same shape.
        sd: same shape.
        step: of which all heights are multiples [m]; 0 for none.
        filled: points that were filled in [-].
        bend: variance of second differences [m^2].
        rounded: excess kurtosis of them that rounding to that step causes [-].
    """

    value: FloatArray
    expected: FloatArray
    sd: FloatArray
    step: float
    filled: int
    bend: float
    rounded: float = 0.0

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "value", "expected", "sd")


def shape_rows(lines: FloatArray, raw: FloatArray) -> ShapeRows:
    """Return the shape numbers of lines.

    Args:
        lines: levelled heights without marks that repeat [m], shape (n_lines, n).
        raw: heights as the file has them [m], any shape.

    Source:
        Scatter from lines of the measured spectrum with random phases: Theiler,
        Eubank, Longtin, Galdrikian and Farmer 1992, Physica D 58, 77.
    """
    step, filled = grid_step(raw), filled_points(raw)
    moments = _moments(lines)
    drawn = np.array([_moments(one) for one in _surrogates(lines)])
    expected = np.concatenate([drawn.mean(axis=0), [0.0, 0.0]])
    sd = np.maximum(drawn.std(axis=0, ddof=1), SURFACE.least_shape_sd)
    grid = 1.0 if step > 0 else 0.0
    bends = np.diff(lines, 2, axis=1)
    return ShapeRows(
        np.array([*moments, np.log1p(filled), grid]),
        expected,
        np.array([*sd, SURFACE.count_sd, SURFACE.sure_sd]),
        step,
        filled,
        float(np.var(bends)),
        rounded_bend_kurtosis(lines, step),
    )


def _moments(lines: FloatArray) -> tuple[float, float, float]:
    bends = np.diff(lines, 2, axis=1)
    return (
        float(np.arcsinh(_skewness(lines))),
        float(np.arcsinh(_skewness(bends))),
        float(np.log1p(max(_kurtosis(bends), -0.9))),
    )


def _skewness(values: FloatArray) -> float:
    off = values - values.mean()
    return float(np.mean(off**3) / max(np.mean(off**2), 1e-300) ** 1.5)


def _kurtosis(values: FloatArray) -> float:
    off = values - values.mean()
    return float(np.mean(off**4) / max(np.mean(off**2), 1e-300) ** 2 - 3.0)


def _surrogates(lines: FloatArray) -> list[FloatArray]:
    """Return lines of the same spectrum with random phases, levelled alike."""
    rng = np.random.default_rng(0)
    points = lines.shape[1]
    place = np.linspace(-1.0, 1.0, points)
    ends = 0.5 * (lines[:, -1:] - lines[:, :1]) * place
    size = np.abs(np.fft.rfft(lines - ends, axis=1))
    found = []
    for _ in range(SURFACE.surrogates):
        phase = np.exp(2j * np.pi * rng.random(size.shape))
        line = np.fft.irfft(size * phase, points, axis=1)
        line += ends * rng.choice((-1.0, 1.0), (lines.shape[0], 1))
        slope = line @ place / (place @ place)
        found.append(line - line.mean(axis=1)[:, None] - np.outer(slope, place))
    return found


def grid_step(heights: FloatArray) -> float:
    """Return the step of which all heights are multiples, 0 for none [m].

    Finer steps count than for `height_step`, which asks for repeated readings.

    Args:
        heights: [m], any shape.
    """
    met = np.unique(heights)
    gaps = np.diff(met)
    gaps = (
        gaps[gaps > SURFACE.same_height * (met[-1] - met[0])] if met.size > 1 else gaps
    )
    if gaps.size < SURFACE.least_gaps:
        return 0.0
    steps = np.rint(gaps / gaps.min())
    step = float(gaps.sum() / steps.sum())
    return step if np.all(np.abs(gaps / step - steps) < SURFACE.off_step) else 0.0


def filled_points(heights: FloatArray) -> int:
    """Return how many points lie on straight runs, or repeat one height.

    On the grid of a step neighbours are on straight lines by themselves, so that
    nothing can be seen there.

    Args:
        heights: [m], one line or lines of a map.
    """
    rows = np.atleast_2d(heights)
    if grid_step(rows) > 0:
        return 0
    scale = float(np.ptp(rows)) or 1.0
    straight = np.abs(np.diff(rows, 2, axis=1)) <= SURFACE.same_height * scale
    found = sum(_in_runs(row, SURFACE.straight_run - 2) for row in straight)
    _, counts = np.unique(rows, return_counts=True)
    repeats = int(counts.max())
    return found + (
        repeats if repeats >= SURFACE.repeated_heights and found == 0 else 0
    )


def _in_runs(marked: BoolArray, needed: int) -> int:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], marked.astype(np.int8), [0]])))
    lengths = edges[1::2] - edges[::2]
    return int(np.sum(lengths[lengths >= needed] + 2))
