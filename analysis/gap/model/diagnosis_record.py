# SPDX-License-Identifier: MIT
"""Result of the engine: verdict and evidence, and its JSON."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

from jointbench.analysis.gap.model.campaign_settings import CAMPAIGN
from jointbench.analysis.gap.model.check_records import (
    Closest,
    EffectLimit,
    SecondMethod,
    limits_json,
    second_method_json,
)
from jointbench.analysis.gap.model.confidence import Evidence
from jointbench.analysis.gap.model.curve_records import (
    CurveEvidence,
    curve_evidence_json,
)
from jointbench.analysis.gap.model.evidence_records import GapEvidence, evidence_json
from jointbench.analysis.gap.model.partial_records import (
    PartialExplanation,
    partial_json,
)
from jointbench.analysis.gap.model.policy import STANDARD, Policy, policy_json
from jointbench.analysis.gap.model.scatter_found import ScatterFound, scatter_json


class Finding(StrEnum):
    """The five verdicts."""

    NONE = "none"
    NAMED = "named"
    AMBIGUOUS = "ambiguous"
    MOSTLY = "mostly"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Estimate:
    """A parameter with its standard deviation [unit]."""

    name: str
    value: float
    sd: float
    unit: str


@dataclass(frozen=True, slots=True)
class NamedEffect:
    """An effect that was found.

    Attributes:
        name: of the catalogue.
        site: word of the site.
        parameters: with intervals.
        confidence: probability that name and site are right [-].
        evidence: quantities from which the confidence is computed.
    """

    name: str
    site: str
    parameters: tuple[Estimate, ...]
    confidence: float
    evidence: Evidence


@dataclass(frozen=True, slots=True)
class Ranked:
    """One explanation that was tried, with its score.

    Attributes:
        effects: name and site of each effect.
        score: cost plus a charge for each parameter.
        delta_score: score above that of the best.
        chi2_per_dof: of the data [-].
        prior_deviation: largest of the base parameters [sd].
    """

    effects: tuple[str, ...]
    score: float
    delta_score: float
    chi2_per_dof: float
    prior_deviation: float


@dataclass(frozen=True, slots=True)
class View:
    """The residual, divided in one way.

    Attributes:
        name: frequency, level, hit point, output, preload, order or time.
        chi2_per_dof: of each slice [-]; 1 where noise explains it.
        share: share of the total excess in each slice [-].
    """

    name: str
    chi2_per_dof: Mapping[str, float]
    share: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Gap:
    """Distance between model and measurement on held-out records.

    Attributes:
        value: sqrt(max(0, chi2/dof - 1)) [-].
        chi2_per_dof: held out [-].
        prior_deviation: largest of the base parameters [sd].
        views: distribution of the gap over levels, channels, frequency ...
        held_out: how the conditions were held out, in words.
    """

    value: float
    chi2_per_dof: float
    prior_deviation: float
    views: tuple[View, ...] = ()
    held_out: str = ""


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Verdict and evidence.

    Attributes:
        verdict: none, named, ambiguous, mostly or unknown.
        effects: effects found; the rivals if the verdict is ambiguous.
        candidates: explanations tried, best first.
        gap_before: of the base, refitted with its priors.
        gap_after: with the effects added.
        prior_deviations: of each base parameter, before and after [sd].
        base: final base parameters, with standard deviations.
        noise: estimated noise of channels and force, and scatter between hits.
        null_statistic: largest drop of chi2 in the directed tests of the base, and
            its 99.5 % limit.
        experiment: recommended next step.
        reason: basis of the verdict.
        evidence: curves and sentences; None if not prepared.
        explanations: labels of the effects of each accepted explanation that cannot
            be distinguished from the best, best first; ("none",) is the base alone.
        policy: thresholds of the verdict.
        scatter: of the hits, by direction; None if not prepared.
        partial: what the best force law explains under model error; None unless the
            verdict is mostly or unknown.
        closest: the best explanation before the acceptance criteria; None if there
            was no search.
        limits: largest size of each effect that the records do not exclude; empty
            unless the verdict is none.
        second_method: the best explanation predicted by a second method.
        curves: modes over amplitude, measured and as predicted; None if not asked for.
        prior_limit: largest acceptable deviation of a base parameter [sd]; None for
            that of the policy.
    """

    verdict: Finding
    effects: tuple[NamedEffect, ...]
    candidates: tuple[Ranked, ...]
    gap_before: Gap
    gap_after: Gap
    prior_deviations: Mapping[str, tuple[float, float]]
    base: tuple[Estimate, ...]
    noise: Mapping[str, float]
    null_statistic: tuple[float, float]
    experiment: str
    reason: str
    evidence: GapEvidence | None = None
    explanations: tuple[tuple[str, ...], ...] = ()
    policy: Policy = STANDARD
    scatter: ScatterFound | None = None
    partial: PartialExplanation | None = None
    closest: Closest | None = None
    limits: tuple[EffectLimit, ...] = ()
    second_method: SecondMethod | None = None
    curves: CurveEvidence | None = None
    prior_limit: float | None = None

    @property
    def acceptable_deviation(self) -> float:
        """Largest acceptable deviation of a base parameter [sd]."""
        return self.policy.prior_limit if self.prior_limit is None else self.prior_limit

    @property
    def predicted(self) -> bool:
        """Whether held-out conditions are predicted, or the gap is insignificant."""
        left = CAMPAIGN.unpredicted_share * self.gap_before.value
        return self.gap_before.value < CAMPAIGN.seen_gap or self.gap_after.value < left

    @property
    def shrink(self) -> float:
        """1 - gap after / gap before [-]; 0 where there was none."""
        if self.gap_before.value <= 0:
            return 0.0
        return 1.0 - self.gap_after.value / self.gap_before.value


def diagnosis_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return a diagnosis as JSON: numbers, texts, lists and objects."""
    d = diagnosis
    return {
        "verdict": d.verdict.value,
        "effects": [
            {
                "name": e.name,
                "site": e.site,
                "parameters": _estimates(e.parameters),
                "confidence": e.confidence,
                "evidence": asdict(e.evidence),
            }
            for e in d.effects
        ],
        "explanations": [list(labels) for labels in d.explanations],
        "candidates": [
            {
                "effects": list(c.effects),
                "score": c.score,
                "behind": c.delta_score,
                "chi2_per_dof": c.chi2_per_dof,
                "pull": c.prior_deviation,
            }
            for c in d.candidates
        ],
        "where": _where(d.gap_before),
        "where_after": _where(d.gap_after),
        "gap_before": d.gap_before.value,
        "gap_after": d.gap_after.value,
        "shrink": d.shrink,
        "held_out": {"before": d.gap_before.held_out, "after": d.gap_after.held_out},
        "chi2_per_dof": [d.gap_before.chi2_per_dof, d.gap_after.chi2_per_dof],
        "pulls": {
            name: {"before": before, "after": after}
            for name, (before, after) in d.prior_deviations.items()
        },
        "base": _estimates(d.base),
        "noise": dict(d.noise),
        "scatter": None if d.scatter is None else scatter_json(d.scatter),
        "null_test": {"largest": d.null_statistic[0], "limit": d.null_statistic[1]},
        "experiment": d.experiment,
        "reason": d.reason,
        "exhibit": None if d.evidence is None else evidence_json(d.evidence),
        "policy": policy_json(d.policy),
        "closest": None if d.closest is None else asdict(d.closest),
        "upper_limits": limits_json(d.limits),
        "second_method": second_method_json(d.second_method),
        "curves": curve_evidence_json(d.curves),
        "mostly": None if d.partial is None else partial_json(d.partial),
    }


def _estimates(estimates: tuple[Estimate, ...]) -> dict[str, dict[str, float | str]]:
    return {e.name: {"value": e.value, "sd": e.sd, "unit": e.unit} for e in estimates}


def _where(gap: Gap) -> dict[str, dict[str, dict[str, float]]]:
    return {
        view.name: {
            label: {"chi2_per_dof": value, "share": view.share[label]}
            for label, value in view.chi2_per_dof.items()
        }
        for view in gap.views
    }
