# SPDX-License-Identifier: MIT
"""What a picture of a gap is drawn from, and what it tells in words."""

from dataclasses import dataclass
from typing import Any

from jointbench.acquisition.basics.arrays import FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """The telling record: the one channel of one hit that holds most of the misfit.

    Attributes:
        record: its number, from 0.
        condition: where and how hard it was hit, in words.
        channel: name.
        unit: of the response.
        share: of the whole excess that sits in it [-].
        time: from the start of the record [s], shape (n,).
        measured: [unit], shape (n,).
        before: base model, same shape.
        after: model with the effects, same shape.
        residual_before: measured less base, with what hits scatter by taken out [unit].
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
    """The telling condition in the frequency domain.

    Attributes:
        condition: in words.
        channel: name.
        unit: of the response over the force.
        frequency: [Hz], shape (n,).
        measured: magnitude of the H1 estimate over the repeats [unit], shape (n,).
        before: of the base model for the same forces, same shape.
        after: of the model with the effects, same shape.
        residual_before: rms over all records and channels, over the noise [-].
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
    """What stiffness and damping of the joint each record would like by itself.

    Attributes:
        link: name of the joint.
        level: nominal peak force of each record [N], shape (n_records,).
        preload: [N], same shape.
        order: rank in time, same shape.
        hit: name of the body hit, one for each record.
        stiffness: relative change from the base [-], (n_records, 2): before, after.
        stiffness_sd: of it [-], same shape.
        damping: relative change from the base [-], same shape.
        damping_sd: of it [-], same shape.
        share: of the excess that such freedom would take, before [-].
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
    """How much a right model may leave.

    Attributes:
        chi2_per_dof: of the fit shown as after [-].
        chi2_allowed: largest that still counts as explained [-].
        remaining: directed test that comes closest to its limit, or exceeds it most,
            in units of chi2; None where none was made.
        remaining_allowed: its limit, in units of chi2.
        deviation_allowed: largest distance of a base parameter from its sheet [sigma].
    """

    chi2_per_dof: float
    chi2_allowed: float
    remaining: float | None
    remaining_allowed: float
    deviation_allowed: float


@dataclass(frozen=True, slots=True)
class DirectedTest:
    """What one effect by itself would take, to first order.

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
    """The evidence in a form that can be drawn and told.

    Attributes:
        tried: the explanation shown as after, in words; empty for the base itself.
        where: one sentence on where the base's misfit sits.
        look: what the misfit looks like, one sentence each.
        advice: what to do where no effect explains it; empty where none is missing.
        view: the view that tells most: level, hit point, preload, frequency, or sheet
            where only the base's own parameters show it.
        relative: by view and slice, misfit over response, before [-].
        curves: the telling record.
        spectra: the telling condition.
        record_estimates: of each record for the joint; None if the model has no joint.
        limits: what a right model may leave.
        tests: directed tests of the base, largest first.
        force_unit: of force and level.
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


def evidence_json(evidence: GapEvidence) -> dict[str, Any]:
    """Return the words and numbers of an exhibit, without its curves."""
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
    }
