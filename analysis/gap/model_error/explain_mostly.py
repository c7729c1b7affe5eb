# SPDX-License-Identifier: MIT
"""Name the family of a force law under model error, or say that it stays open.

No fit is true to the noise here, so the question is another: does one family of laws
predict conditions that it was not fitted to better than no law and than every other
family does? Linear effects are no candidates: a hidden mode or a gain error is the
model error itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.partial_records import (
    FamilyLead,
    LinearDiscrepancy,
    PartialExplanation,
)
from jointbench.analysis.gap.model.policy import Policy
from jointbench.analysis.gap.model_error.condition_scores import (
    ConditionScores,
    Lead,
    lead_of,
    score_conditions,
)
from jointbench.analysis.gap.model_error.free_law import (
    FREE_LAW,
    FRICTION,
    STIFFNESS,
    fit_free_law,
)
from jointbench.analysis.gap.model_error.law_fits import LawFits, fit_laws
from jointbench.analysis.gap.model_error.model_error_settings import (
    MODEL_ERROR_SETTINGS,
)
from jointbench.analysis.gap.model_error.repeat_floor import left_of_explainable
from jointbench.analysis.gap.model_error.shape_beside import shape_beside
from jointbench.analysis.gap.residuals.bench_protocol import MeasuredBench, values_of
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import Progress


def explain_mostly(
    bench: MeasuredBench, base: Fit, progress: Progress
) -> PartialExplanation | None:
    """Return what the best force law explains under model error.

    Args:
        bench: measurement and model.
        base: fit of the base alone.
        progress: receives the label of each law.

    Returns:
        None if no law may act or too few conditions were measured.
    """
    fits = fit_laws(bench, base, progress)
    if not fits.laws:
        return None
    scores = _Scores(
        fits,
        score_conditions(fits.bench, fits.base),
        sorted(
            (score_conditions(fits.bench, f) for f in fits.laws),
            key=lambda s: float(s.score.mean()),
        ),
    )
    if scores.base.score.size < MODEL_ERROR_SETTINGS.least_conditions:
        return None
    return _judged(scores, bench.policy)


def _judged(scores: "_Scores", policy: Policy) -> PartialExplanation:
    """Return the explanation of the best law, named or not."""
    lead = _lead(scores, scores.base)
    rivals = sorted(
        (_lead(scores, r) for r in _rivals(scores)), key=lambda r: r.standard_errors
    )
    found = _explanation(scores, lead, rivals)
    if not _clear(lead, policy) or lead.share < policy.open_share:
        reason = "no force law predicts conditions held out better than none"
        return replace(found, reason=reason)
    doubt = _doubt(found, policy)
    if found.family == FRICTION and not doubt and not _beside_springs(found):
        found = _beside_free_law(scores, found)
        doubt = _doubt(found, policy)
    text = f"on conditions held out it removes {100 * lead.share:.0f} % of the power"
    clear = "and leads every other family by more than chance"
    return replace(
        found,
        named=not doubt,
        nonlinear=True,
        reason=f"{text}, {doubt or clear}",
    )


def _beside_springs(found: PartialExplanation) -> bool:
    """Return whether a spring of the catalogue is among the rivals at the same place.

    Every family stands in the comparison: by its laws, or where the catalogue has none,
    by elementary shapes.
    """
    return any(r.family == STIFFNESS and r.site == found.site for r in found.rivals)


def _doubt(found: PartialExplanation, policy: Policy) -> str:
    """Return the reason against naming the family of a law, or empty."""
    close = [r.family or r.rival for r in found.rivals if not _clear(r, policy)]
    if close:
        families = " and ".join(dict.fromkeys(close))
        return f"but its lead over {families} is not clear"
    if found.explained < policy.mostly_share:
        return (
            f"but explains {100 * found.explained:.0f} % of what is not scatter "
            f"between repeats (limit {100 * policy.mostly_share:.0f} %)"
        )
    return _shape_doubt(found, policy)


def _shape_doubt(found: PartialExplanation, policy: Policy) -> str:
    """Return the doubt about the shape of an elastic law, or empty.

    A law that leaves little is near enough, whatever shape that has.
    """
    beside, left = found.beside, found.left_of_explainable
    near = left is not None and left <= policy.mostly_left
    if beside is None or (near and found.share >= policy.mostly_share):
        return ""
    if beside.share <= policy.mostly_beside:
        return ""
    return (
        f"but the {beside.shape} beside it would explain {100 * beside.share:.2g} % of "
        f"what it does (limit {100 * policy.mostly_beside:.2g} %): it may stand in for "
        "another law"
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Scores:
    """Fits with their scores: the base's, and those of the laws, best first."""

    fits: LawFits
    base: ConditionScores
    laws: Sequence[ConditionScores]

    @property
    def best(self) -> ConditionScores:
        """Scores of the best law."""
        return self.laws[0]


def _clear(lead: FamilyLead, policy: Policy) -> bool:
    """Return whether a lead is more than chance in enough conditions."""
    return (
        lead.standard_errors > policy.mostly_standard_errors
        and lead.conditions >= policy.mostly_conditions
    )


def _kind(fit: Fit) -> tuple[str, str]:
    """Return family and site of a law."""
    candidate = fit.candidates[0]
    return candidate.effect.family, str(candidate.site)


def _rivals(scores: _Scores) -> list[ConditionScores]:
    """Return the best law of each other family and site."""
    found: dict[tuple[str, str], ConditionScores] = {}
    for one in scores.laws:
        found.setdefault(_kind(one.fit), one)
    found.pop(_kind(scores.best.fit))
    return list(found.values())


def _lead(scores: _Scores, rival: ConditionScores) -> FamilyLead:
    """Return the lead of the best law over a rival."""
    lead: Lead = lead_of(
        scores.fits.bench, scores.best, rival, MODEL_ERROR_SETTINGS.visible_gain
    )
    laws = rival.fit.candidates
    alone = len(laws) == 1
    return FamilyLead(
        rival=laws[0].effect.name if alone else FREE_LAW if laws else "base",
        family=laws[0].effect.family if alone else "",
        site=str(laws[0].site) if laws else "",
        share=1.0 - float(np.exp(-lead.mean)),
        standard_errors=lead.standard_errors,
        conditions=lead.share,
        shown=lead.shown,
    )


def _beside_free_law(scores: _Scores, found: PartialExplanation) -> PartialExplanation:
    """Return a friction law with its lead over a free spring and damper."""
    bench, law = scores.fits.bench, scores.best.fit.candidates[0]
    free = fit_free_law(bench, scores.fits.base, law.site)
    if free is None:
        return found
    rivals = (*found.rivals, _lead(scores, score_conditions(bench, free)))
    return replace(found, rivals=tuple(sorted(rivals, key=lambda r: r.standard_errors)))


def _explanation(
    scores: _Scores,
    lead: FamilyLead,
    rivals: Sequence[FamilyLead],
) -> PartialExplanation:
    """Return the explanation of the best law, before it is judged."""
    fit = scores.best.fit
    candidate, (term,) = fit.candidates[0], fit.terms
    values = values_of(scores.fits.bench, term)
    return PartialExplanation(
        named=False,
        nonlinear=False,
        family=candidate.effect.family,
        effect=candidate.effect.name,
        site=str(candidate.site),
        parameters=candidate.effect.reported(values),
        share=lead.share,
        left_of_explainable=left_of_explainable(
            scores.fits.bench, scores.base, scores.best
        ),
        beside=shape_beside(scores.fits.bench, scores.base.fit, fit),
        lead=lead,
        rivals=tuple(rivals),
        levels=_levels(scores),
        left=_left(scores),
        linear=_linear(scores.fits),
        reason="",
    )


def _gains(scores: _Scores) -> tuple[FloatArray, FloatArray]:
    """Return gain of log power, and which bands count, by record, channel, band."""
    counted = scores.fits.bench.whitening.frame.counted
    gain = np.log(np.maximum(scores.base.power, 1e-300))
    gain = gain - np.log(np.maximum(scores.best.power, 1e-300))
    return gain * counted, counted.astype(float)


def _levels(scores: _Scores) -> tuple[str, ...]:
    """Return softest and hardest level at which the law leads visibly."""
    labels = [r["level"] for r in scores.fits.bench.blocks.labels]
    gain, counted = _gains(scores)
    level = scores.fits.bench.inner.campaign.level
    leading = {
        label: float(level[labels.index(label)])
        for label in dict.fromkeys(labels)
        if _mean(gain, counted, [i for i, x in enumerate(labels) if x == label])
        > MODEL_ERROR_SETTINGS.visible_gain
    }
    ordered = sorted(leading, key=lambda label: leading[label])
    return (ordered[0], ordered[-1]) if ordered else ()


def _mean(gain: FloatArray, counted: FloatArray, rows: Sequence[int]) -> float:
    return float(gain[rows].sum() / max(counted[rows].sum(), 1.0))


def _left(scores: _Scores) -> dict[str, dict[str, float]]:
    """Return the power left over that of the base by level, channel and band."""
    bench, (gain, counted) = scores.fits.bench, _gains(scores)
    found: dict[str, dict[str, float]] = {}
    for view in (name for name in bench.blocks.labels[0] if name != "order"):
        labels = [r[view] for r in bench.blocks.labels]
        found[view] = {
            label: float(
                np.exp(
                    -_mean(
                        gain, counted, [i for i, x in enumerate(labels) if x == label]
                    )
                )
            )
            for label in dict.fromkeys(labels)
        }
    channels = [c.name for c in bench.inner.campaign.model.channels]
    found["output"] = {
        name: float(np.exp(-gain[:, c].sum() / max(counted[:, c].sum(), 1.0)))
        for c, name in enumerate(channels)
    }
    edges = bench.whitening.frame.edges
    found["frequency"] = {
        f"{edges[b]:.0f} to {edges[b + 1]:.0f} Hz": float(
            np.exp(-gain[..., b].sum() / counted[..., b].sum())
        )
        for b in range(edges.size - 1)
        if counted[..., b].any()
    }
    return found


def _linear(fits: LawFits) -> tuple[LinearDiscrepancy, ...]:
    """Return the discrepancy by hit point, channel and band with signal."""
    frame, campaign = fits.bench.whitening.frame, fits.bench.inner.campaign
    rows = []
    for p in range(fits.discrepancy.coherent.shape[0]):
        own = frame.point == p
        body = campaign.model.bodies[int(campaign.hit[own][0])].name
        for c, channel in enumerate(campaign.model.channels):
            rows += [
                LinearDiscrepancy(
                    body,
                    channel.name,
                    float(frame.edges[b]),
                    float(frame.edges[b + 1]),
                    float(np.sqrt(fits.discrepancy.coherent[p, c, b])),
                    float(np.sqrt(fits.discrepancy.incoherent[c, b])),
                )
                for b in range(frame.edges.size - 1)
                if frame.counted[own, c, b].any()
            ]
    return tuple(rows)
