# SPDX-License-Identifier: MIT
"""What a force law explains while the model as a whole is not true to the noise."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from jointbench.analysis.gap.model.effect_parameter import Reported


@dataclass(frozen=True, slots=True)
class FamilyLead:
    """Lead of the best law over the base, or over the best law of another family.

    Attributes:
        rival: name of the law, ``"base"``, or a free spring and damper.
        family: of the rival; empty for the base and for a free spring and damper.
        site: word of the rival's site; empty for the base.
        share: of the rival's residual power that the best law removes, held out [-].
        standard_errors: mean gain of log power over its standard error [-].
        conditions: share of the conditions in which the best law leads, of those that
            show a difference [-].
        shown: number of conditions that show a difference.
    """

    rival: str
    family: str
    site: str
    share: float
    standard_errors: float
    conditions: float
    shown: int


@dataclass(frozen=True, slots=True)
class LinearDiscrepancy:
    """Error of the response function that all records of a hit point share.

    Attributes:
        hit_point: body that was hit.
        channel: of the response.
        low: end of the band [Hz].
        high: end of the band [Hz].
        coherent: rms of the common error over the response [-].
        incoherent: rms of what differs from record to record over the response [-].
    """

    hit_point: str
    channel: str
    low: float
    high: float
    coherent: float
    incoherent: float


@dataclass(frozen=True, slots=True)
class ShapeBeside:
    """An elementary shape of the force beside a law.

    Attributes:
        shape: in words.
        share: drop of chi2 that a directed test of it predicts, over the drop by the
            law itself [-].
    """

    shape: str
    share: float


@dataclass(frozen=True, slots=True)
class PartialExplanation:
    """The best force law under model error, judged on conditions held out.

    Attributes:
        named: whether its family is named.
        nonlinear: whether a law explains a clear part; the family stays open if it is
            not named.
        family: of the best law.
        effect: name of the best law.
        site: word of its site.
        parameters: of the law, to first order.
        share: of the base's residual power that the law removes [-].
        left_of_explainable: share of what is not scatter between repeats that the law
            leaves [-]; None without repeats.
        beside: the elementary shape that explains most beside the law; None for a law
            that dissipates energy.
        lead: over the base.
        rivals: leads over the best law of each other family or site, and, of a friction
            law that would be named, over a free spring and damper; closest first.
        levels: softest and hardest level at which the law leads; empty if there is
            none.
        left: power left over that of the base by view and slice [-].
        linear: discrepancy of the linear model by hit point, channel and band.
        reason: why the family is named or open.
    """

    named: bool
    nonlinear: bool
    family: str
    effect: str
    site: str
    parameters: tuple[Reported, ...]
    share: float
    left_of_explainable: float | None
    beside: ShapeBeside | None
    lead: FamilyLead
    rivals: tuple[FamilyLead, ...]
    levels: tuple[str, ...]
    left: Mapping[str, Mapping[str, float]]
    linear: tuple[LinearDiscrepancy, ...]
    reason: str

    @property
    def explained(self) -> float:
        """Share of what a law could explain that this one does [-].

        What repeats of a condition show as scatter, no law explains. The larger of two
        values counts: without that scatter, over the conditions with repeats, and with
        it, over all conditions.
        """
        left = self.left_of_explainable
        return self.share if left is None else max(self.share, 1.0 - left)


def partial_json(found: PartialExplanation) -> dict[str, Any]:
    """Return a partial explanation as JSON."""
    return {
        "named": found.named,
        "nonlinear": found.nonlinear,
        "family": found.family,
        "effect": found.effect,
        "site": found.site,
        "parameters": {
            p.name: {"value": p.value, "unit": p.unit} for p in found.parameters
        },
        "share_explained": found.share,
        "left_of_explainable": found.left_of_explainable,
        "beside": None if found.beside is None else asdict(found.beside),
        "lead": asdict(found.lead),
        "rivals": [asdict(r) for r in found.rivals],
        "levels": list(found.levels),
        "left": {view: dict(slices) for view, slices in found.left.items()},
        "linear_discrepancy": [asdict(row) for row in found.linear],
        "reason": found.reason,
    }
