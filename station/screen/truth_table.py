# SPDX-License-Identifier: MIT
"""Truth and estimate side by side, for benches that know what they are made of."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass


@dataclass(frozen=True, slots=True)
class TruthComparison:
    """One known quantity beside its estimate.

    Attributes:
        quantity: what is compared, for example ``"natural_frequency[0]"``.
        unit: of truth, estimate and standard deviation; ``"-"`` when none.
        truth: what the simulated bench is made of.
        estimate: what the station found, None if it found nothing.
        sd: standard deviation of the estimate, None if there is none.
        error: estimate minus truth, relative to truth unless `absolute`.
        limit: largest `error` the demo accepts, None where it accepts any.
        absolute: True where `error` and `limit` carry the unit.
        passed: `error` within `limit`.
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
    """Lay an estimate beside the truth; a missing estimate passes no limit."""
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
