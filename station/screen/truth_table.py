# SPDX-License-Identifier: MIT
"""Comparison of true and estimated parameters of a simulated bench."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass


@dataclass(frozen=True, slots=True)
class TruthComparison:
    """One known quantity and its estimate.

    Attributes:
        quantity: name of the quantity, for example ``"natural_frequency[0]"``.
        unit: of truth, estimate and standard deviation; ``"-"`` when none.
        truth: parameter of the simulated bench.
        estimate: result of the station, None if there is none.
        sd: standard deviation of the estimate, None if there is none.
        error: estimate minus truth, relative to truth unless `absolute`.
        limit: largest accepted `error`, None for no limit.
        absolute: True if `error` and `limit` have the unit.
        passed: `error` is within `limit`.
    """

    quantity: str
    unit: str
    truth: float
    estimate: float | None
    sd: float | None
    error: float | None
    limit: float | None
    absolute: bool
    passed: bool


def compare_value(
    quantity: str,
    unit: str,
    truth: float,
    estimate: float | None,
    *,
    sd: float | None = None,
    limit: float | None = None,
    absolute: bool = False,
) -> TruthComparison:
    """Compare an estimate with the truth; a missing estimate passes no limit."""
    error = None
    if estimate is not None:
        error = estimate - truth if absolute else estimate / truth - 1
    passed = limit is None or (error is not None and abs(error) <= limit)
    return TruthComparison(
        quantity, unit, truth, estimate, sd, error, limit, absolute, passed
    )


def as_json(comparisons: Iterable[TruthComparison]) -> list[dict[str, object]]:
    """Return comparisons as JSON objects."""
    return [asdict(comparison) for comparison in comparisons]


def nearest(values: Sequence[float], target: float) -> int | None:
    """Return the index of the value nearest to `target`, None if there is none."""
    if not values:
        return None
    return min(range(len(values)), key=lambda index: abs(values[index] - target))
