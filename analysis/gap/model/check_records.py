# SPDX-License-Identifier: MIT
"""Largest effects that records do not exclude, and a check by a second method."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from jointbench.analysis.gap.model.confidence import Evidence
from jointbench.analysis.gap.model.effect_parameter import Reported


@dataclass(frozen=True, slots=True)
class Closest:
    """The best explanation before the acceptance criteria.

    Attributes:
        effects: name and site of each effect.
        confidence: probability that names and sites are right [-].
        evidence: quantities from which the confidence is computed.
    """

    effects: tuple[str, ...]
    confidence: float
    evidence: Evidence


@dataclass(frozen=True, slots=True)
class EffectLimit:
    """The largest size of one effect that the records do not exclude.

    Attributes:
        name: of the effect.
        site: word of its site.
        parameters: reported parameters at that size; the first is the amplitude, the
            others its shape.
    """

    name: str
    site: str
    parameters: tuple[Reported, ...]


@dataclass(frozen=True, slots=True)
class SecondMethod:
    """The response of an explanation by a second method, which shares no step.

    Attributes:
        effects: labels of the explanation; ("none",) is the base alone.
        record: that was predicted, 0-based.
        condition: of that record.
        over_peak: largest difference over the largest response [-]; None if the second
            method does not apply.
        over_noise: rms difference over the noise [-]; None likewise.
        reason: why it does not apply, or empty.
    """

    effects: tuple[str, ...]
    record: int
    condition: str
    over_peak: float | None = None
    over_noise: float | None = None
    reason: str = ""


def limits_json(limits: Sequence[EffectLimit]) -> list[dict[str, Any]]:
    """Return limits as JSON."""
    return [
        {
            "name": one.name,
            "site": one.site,
            "parameters": {
                p.name: {"value": p.value, "unit": p.unit} for p in one.parameters
            },
        }
        for one in limits
    ]


def second_method_json(found: SecondMethod | None) -> dict[str, Any] | None:
    """Return a check as JSON; None if there was none."""
    return None if found is None else asdict(found)
