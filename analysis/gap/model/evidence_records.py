# SPDX-License-Identifier: MIT
"""Evidence of a gap: curves for the figures, and sentences."""

from dataclasses import dataclass
from typing import Any

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.model.law_curves import LawCurves, law_curves_json


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """Representative record: the channel of the hit with most of the residual.

    Attributes:
        record: its number, from 0.
        condition: hit point, level and preload, as text.
        channel: name.
        unit: of the response.
        share: its share of the total excess [-].
        time: from the start of the record [s], shape (n,).
        measured: [unit], shape (n,).
        before: base model, same shape.
        after: model with the effects, same shape.
        residual_before: measured minus base model, without the scatter between hits
            [unit].
        residual_after: the same with the effects [unit].
        sigma: noise of a sample [unit].
    """

    record: int
    condition: str
    channel: str
    unit: str
    share: float
    time: FloatArray
    measured: FloatArray
    before: FloatArray
    after: FloatArray
    residual_before: FloatArray
    residual_after: FloatArray
    sigma: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "time", "measured", "before", "after")
        freeze(self, "residual_before", "residual_after")


@dataclass(frozen=True, slots=True, eq=False)
class Spectra:
    """Representative condition in the frequency domain.

    Attributes:
        condition: in words.
        channel: name.
        unit: of the response over the force.
        frequency: [Hz], shape (n,).
        measured: magnitude of the H1 estimate over the repeats [unit], shape (n,).
        before: of the base model for the same forces, same shape.
        after: of the model with the effects, same shape.
        residual_before: rms over all records and channels, relative to the noise [-].
        residual_after: the same with the effects [-].
    """

    condition: str
    channel: str
    unit: str
    frequency: FloatArray
    measured: FloatArray
    before: FloatArray
    after: FloatArray
    residual_before: FloatArray
    residual_after: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "measured", "before", "after")
        freeze(self, "residual_before", "residual_after")


@dataclass(frozen=True, slots=True, eq=False)
class RecordEstimates:
    """Stiffness and damping of the joint, estimated from each record separately.

    Attributes:
        link: name of the joint.
        level: nominal peak force of each record [N], shape (n_records,).
        preload: [N], same shape.
        order: rank in time, same shape.
        hit: name of the body hit, one for each record.
        stiffness: relative change from the base [-], (n_records, 2): before, after.
        stiffness_sd: its standard deviation [-], same shape.
        damping: relative change from the base [-], same shape.
        damping_sd: its standard deviation [-], same shape.
        share: share of the excess that separate estimates explain, before [-].
    """

    link: str
    level: FloatArray
    preload: FloatArray
    order: FloatArray
    hit: tuple[str, ...]
    stiffness: FloatArray
    stiffness_sd: FloatArray
    damping: FloatArray
    damping_sd: FloatArray
    share: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "level", "preload", "order")
        freeze(self, "stiffness", "stiffness_sd", "damping", "damping_sd")


@dataclass(frozen=True, slots=True)
class CampaignLimits:
    """Acceptance limits of a campaign.

    Attributes:
        chi2_per_dof: of the fit shown as after [-].
        chi2_allowed: largest accepted chi2/dof [-].
        remaining: drop of chi2 in the directed test closest to its limit, or furthest
            above it; None if there is no test.
        remaining_allowed: its limit, in units of chi2.
        deviation_allowed: largest accepted prior deviation of a base parameter [sd].
    """

    chi2_per_dof: float
    chi2_allowed: float
    remaining: float | None
    remaining_allowed: float
    deviation_allowed: float


@dataclass(frozen=True, slots=True)
class DirectedTest:
    """Drop of chi2 by one effect alone, to first order.

    Attributes:
        label: effect and site.
        drop: of chi2.
        share: of the excess of chi2 [-].
    """

    label: str
    drop: float
    share: float


@dataclass(frozen=True, slots=True, eq=False)
class GapEvidence:
    """Evidence of a gap for figures and text.

    Attributes:
        tried: the explanation shown as after, as text; empty for the base itself.
        where: one sentence that locates the residual of the base.
        look: signature of the residual, one sentence each.
        advice: what to do if no effect explains it; empty if none is missing.
        view: the most significant view: level, hit point, preload, frequency, or
            priors if only the base parameters show the gap.
        relative: residual over response by view and slice, before [-].
        curves: representative record.
        spectra: representative condition.
        record_estimates: of each record for the joint; None if the model has no joint.
        limits: acceptance limits.
        tests: directed tests of the base, largest first.
        force_unit: of force and level.
        laws: force laws of the explanation as curves; empty for linear effects.
    """

    tried: str
    where: str
    look: tuple[str, ...]
    advice: str
    view: str
    relative: dict[str, dict[str, float]]
    curves: Curves
    spectra: Spectra
    record_estimates: RecordEstimates | None
    limits: CampaignLimits
    tests: tuple[DirectedTest, ...]
    force_unit: str = "N"
    laws: tuple[LawCurves, ...] = ()


def evidence_json(evidence: GapEvidence) -> dict[str, Any]:
    """Return the text and numbers of the evidence, without its curves."""
    curves, limits = evidence.curves, evidence.limits
    return {
        "localisation": evidence.where,
        "looks_like": list(evidence.look),
        "relative_misfit": evidence.relative,
        "telling_record": {
            "record": curves.record,
            "condition": curves.condition,
            "channel": curves.channel,
            "share": curves.share,
        },
        "limits": {
            "chi2_per_dof": limits.chi2_per_dof,
            "chi2_allowed": limits.chi2_allowed,
            "remaining": limits.remaining,
            "remaining_allowed": limits.remaining_allowed,
        },
        "directed_tests": [
            {"effect": t.label, "drop": t.drop, "share": t.share}
            for t in evidence.tests
        ],
        "laws": [law_curves_json(curves) for curves in evidence.laws],
    }
