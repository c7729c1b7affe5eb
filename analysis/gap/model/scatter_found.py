# SPDX-License-Identifier: MIT
"""Scatter of the hits as reported: by direction, and hit by hit where it is large."""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class DirectionFound:
    """Scatter along one direction of the model.

    Attributes:
        name: for example ``"channel gain"``.
        size: sd from hit to hit, in `unit`; 0 if it is not significant.
        unit: ``"-"`` or ``"s"``.
    """

    name: str
    size: float
    unit: str


@dataclass(frozen=True, slots=True)
class HitFound:
    """A hit that deviates from the others.

    Attributes:
        record: its number, 0-based.
        direction: along which it deviates; empty if no direction describes it.
        value: deviation in the unit of the direction; without one, its chi2/dof.
        sd: of the usual hits, same unit; 0 if they do not scatter.
        unit: of value and sd, ``"-"`` or ``"s"``.
    """

    record: int
    direction: str
    value: float
    sd: float
    unit: str = "-"


@dataclass(frozen=True, slots=True)
class ScatterFound:
    """Scatter of the hits of a campaign.

    Attributes:
        directions: every direction that was tried.
        correlation: between successive hits [-].
        hits: those that deviate by more than 4 sd, or stand out.
    """

    directions: tuple[DirectionFound, ...]
    correlation: float
    hits: tuple[HitFound, ...]

    @property
    def words(self) -> str:
        """The significant sizes in words, largest share first."""
        found = [d for d in self.directions if d.size > 0.0]
        if not found:
            return "hits do not scatter beyond the noise"
        listed = ", ".join(f"{d.name} {_size_words(d)}" for d in found)
        tied = ""
        if self.correlation > 0.0:
            tied = f"; successive hits are correlated by {self.correlation:.2g}"
        return f"hits scatter in {listed}{tied}"


def _size_words(direction: DirectionFound) -> str:
    if direction.unit == "s":
        return f"{1e6 * direction.size:.2g} us"
    return f"{100 * direction.size:.2g} %"


def hit_words(hit: HitFound) -> str:
    """Return one hit in words, for example ``record 3 (force gain +8 %)``."""
    if not hit.direction:
        return f"record {hit.record}"
    if hit.unit == "s":
        return f"record {hit.record} ({hit.direction} {1e6 * hit.value:+.2g} us)"
    return f"record {hit.record} ({hit.direction} {100 * hit.value:+.2g} %)"


def scatter_json(found: ScatterFound) -> dict[str, Any]:
    """Return the scatter as JSON types."""
    return asdict(found)
