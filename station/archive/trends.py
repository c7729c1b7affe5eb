# SPDX-License-Identifier: MIT
"""How quantities of an archive go with torque, preload, date or specimen.

A quantity over a number is a straight line by weighted least squares, over specimens
one mean each. Weights hold each value's own variance and a scatter between sessions,
common to all, that makes chi-squared what it should be.

Source:
    DerSimonian and Laird, Controlled Clinical Trials 7 (1986) 177 (the scatter of a
    common mean by the method of moments), here about the fitted line.
"""

import math
from collections import defaultdict
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError

OVER = {"torque": "N m", "preload": "N", "day": "d", "specimen": ""}


class TableRow(Protocol):
    """What of a table's row is needed here."""

    @property
    def part(self) -> str: ...  # noqa: D102
    @property
    def item(self) -> str: ...  # noqa: D102
    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def unit(self) -> str: ...  # noqa: D102
    @property
    def value(self) -> float: ...  # noqa: D102
    @property
    def sd(self) -> float: ...  # noqa: D102


@dataclass(frozen=True, slots=True)
class TrendPoint:
    """One value of a quantity and where it stands."""

    quantity: str
    unit: str
    at: Hashable
    value: float
    sd: float


@dataclass(frozen=True, slots=True)
class Trend:
    """How a quantity goes with what it was plotted over.

    Attributes:
        quantity: part, item and name.
        unit: of its values.
        count: number of values.
        mean: of them [unit].
        scatter: between sessions, the values' own sd taken out [unit].
        slope: [unit per unit of the axis], NaN over specimens.
        slope_sd: its standard deviation, scatter included; NaN likewise.
        groups: mean and its sd of each specimen; empty over a number.
        significance: of slope, or of the largest difference [sd]; NaN where too few.
    """

    quantity: str
    unit: str
    count: int
    mean: float
    scatter: float
    slope: float
    slope_sd: float
    groups: tuple[tuple[str, float, float], ...]
    significance: float

    @staticmethod
    def point(row: TableRow, over: str, way: str = "", load: str = "") -> TrendPoint:
        """Return a row of the table as a point of a trend.

        Args:
            row: of the table.
            over: one of `OVER`.
            way: how the result was made; results of two ways are two quantities.
            load: torque of the bolts in words; likewise.

        Raises:
            UsageError: `over` is nothing that a trend can go over.
        """
        check_trend(over)
        words = f"{way}{row.part} {row.item} {row.name}{load}".replace("  ", " ")
        at = getattr(row, over)
        return TrendPoint(words, row.unit, at, row.value, row.sd)


def check_trend(over: str) -> None:
    """Raise `UsageError` where `over` is nothing that a trend can go over."""
    if over not in OVER:
        raise UsageError(f"--trend is {over!r}; write {', '.join(OVER)}")


def trends_of(points: Sequence[TrendPoint]) -> tuple[Trend, ...]:
    """Return the trend of each quantity that was met more than once."""
    groups: dict[tuple[str, str], list[TrendPoint]] = defaultdict(list)
    for point in points:
        if isinstance(point.at, float) and math.isnan(point.at):
            continue
        groups[point.quantity, point.unit].append(point)
    return tuple(_trend(group) for group in groups.values() if len(group) > 1)


def _trend(points: Sequence[TrendPoint]) -> Trend:
    value = np.array([point.value for point in points])
    sd = np.array([0.0 if math.isnan(p.sd) else p.sd for p in points])
    named = isinstance(points[0].at, str)
    if named:
        names = sorted({str(point.at) for point in points})
        design = np.array([[float(p.at == name) for name in names] for p in points])
    else:
        names = []
        at = np.array([point.at for point in points], dtype=np.float64)
        span = np.ptp(at)
        columns = [np.ones_like(at)] + ([at - at.mean()] if span > 0 else [])
        design = np.stack(columns, axis=1)
    found, covariance, scatter = fit_with_scatter(design, value, sd)
    sds = np.sqrt(np.diag(covariance))
    slope = slope_sd = significance = math.nan
    means: tuple[tuple[str, float, float], ...] = ()
    if named:
        means = tuple(
            (n, float(f), float(s)) for n, f, s in zip(names, found, sds, strict=True)
        )
        significance = _largest_difference(found, sds)
    elif found.size > 1:
        slope, slope_sd = float(found[1]), float(sds[1])
        significance = abs(slope) / slope_sd if slope_sd > 0 else math.nan
    return Trend(
        points[0].quantity,
        points[0].unit,
        len(points),
        float(value.mean()),
        scatter,
        slope,
        slope_sd,
        means,
        significance,
    )


def fit_with_scatter(
    design: FloatArray, value: FloatArray, sd: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Fit a linear model to values with their own sd and a scatter common to all.

    Args:
        design: shape (n, k).
        value: shape (n,).
        sd: of the values, shape (n,); 0 where not known.

    Returns:
        Parameters (k,), their covariance (k, k), and the scatter.
    """
    left = value.size - np.linalg.matrix_rank(design)
    scale = float(np.max(np.abs(value))) or 1.0
    low, high = 0.0, float(np.ptp(value)) + 1e-12 * scale

    def solve(scatter: float) -> tuple[FloatArray, FloatArray, float]:
        variance = sd**2 + scatter**2 + (1e-15 * scale) ** 2
        weighted = design / variance[:, None]
        covariance: FloatArray = np.asarray(
            np.linalg.pinv(design.T @ weighted), np.float64
        )
        found: FloatArray = np.asarray(covariance @ (weighted.T @ value))
        return (
            found,
            covariance,
            float(((value - design @ found) ** 2 / variance).sum()),
        )

    if left <= 0 or solve(low)[2] <= left:
        return (*solve(low)[:2], low)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if solve(middle)[2] > left else (low, middle)
    return (*solve(high)[:2], high)


def _largest_difference(mean: FloatArray, sd: FloatArray) -> float:
    if mean.size < 2:
        return math.nan
    first, last = int(np.argmin(mean)), int(np.argmax(mean))
    together = math.hypot(sd[first], sd[last])
    return float((mean[last] - mean[first]) / together) if together > 0 else math.nan
