# SPDX-License-Identifier: MIT
"""One finding on a bench: what was seen, whether it is good, and what to do."""

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class Health(StrEnum):
    """How good a finding is."""

    GOOD = "good"
    LOOK = "look"
    BAD = "bad"


@dataclass(frozen=True, slots=True)
class BenchFinding:
    """One finding.

    Attributes:
        step: of the examination: driver, devices, sensors, noise, hit.
        what: channel, device, or what else was looked at.
        health: good, to be looked at, or bad.
        seen: in one line, with its number and limit.
        remedy: what to do; empty for a good finding.
    """

    step: str
    what: str
    health: Health
    seen: str
    remedy: str = ""

    def to_json(self) -> dict[str, Any]:
        """Return the finding as JSON types."""
        return asdict(self)


def good(step: str, what: str, seen: str) -> BenchFinding:
    """Return a finding that needs nothing to be done."""
    return BenchFinding(step, what, Health.GOOD, seen)


def look(step: str, what: str, seen: str, remedy: str) -> BenchFinding:
    """Return a finding that someone should look at."""
    return BenchFinding(step, what, Health.LOOK, seen, remedy)


def bad(step: str, what: str, seen: str, remedy: str) -> BenchFinding:
    """Return a finding that spoils a measurement."""
    return BenchFinding(step, what, Health.BAD, seen, remedy)
