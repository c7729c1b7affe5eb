# SPDX-License-Identifier: MIT
"""Scores of fits on conditions held out: log power of the residual by band.

In chi2 the gain of a law grows with the square of the level, so that a mean over levels
from soft to hard does not depend on its size. Here each band of each record counts
once.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.judgement.held_out import conditions_of
from jointbench.analysis.gap.model_error.whitened_bench import WhitenedBench
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.slopes import along_columns, curvature


@dataclass(frozen=True, slots=True, eq=False)
class ConditionScores:
    """Residual of a fit in each condition, fitted without the condition.

    Attributes:
        fit: the fit to all conditions.
        rows: whitened residual of each record, when held out, shape (n_rows,).
        power: of those rows by band, shape (n_records, n_channels, n_bands).
        score: mean log power of each condition, shape (n_conditions,).
    """

    fit: Fit
    rows: FloatArray
    power: FloatArray
    score: FloatArray


def score_conditions(bench: WhitenedBench, fit: Fit) -> ConditionScores:
    """Hold out each condition in turn, and score its residual.

    The other conditions move the fit by one Newton step, and the residual is evaluated
    there, so that only the step is of first order, not the residual.
    """
    condition = conditions_of(bench.blocks)
    problem = make_problem(bench, fit.candidates)
    hessian = curvature(fit.jacobian) + np.diag(fit.prior)
    rows = fit.residual.copy()
    for g in range(int(condition.max()) + 1):
        own = np.isin(bench.blocks.group, np.flatnonzero(condition == g))
        j, r = fit.jacobian[own], fit.residual[own]
        others, push = hessian - curvature(j), along_columns(j, r)
        step = np.linalg.lstsq(others, push, rcond=1e-12)[0]
        x = np.clip(fit.x + step, problem.lower, problem.upper)
        moved = problem.residual(x, MIDDLE)
        rows[own] = moved[own] if np.isfinite(moved).all() else r
    power = bench.powers(rows)
    return ConditionScores(fit, rows, power, mean_log_power(bench, power, condition))


def mean_log_power(
    bench: WhitenedBench, power: FloatArray, condition: IntArray
) -> FloatArray:
    """Return the mean log power of each condition over records, channels and bands."""
    counted = bench.whitening.frame.counted
    log = np.log(np.maximum(power, 1e-300)) * counted
    return np.array(
        [
            log[condition == g].sum() / max(counted[condition == g].sum(), 1)
            for g in range(int(condition.max()) + 1)
        ]
    )


@dataclass(frozen=True, slots=True)
class Lead:
    """Lead of one fit over another on conditions held out.

    Attributes:
        mean: of the gain in log power over the conditions [-].
        standard_errors: mean over its standard error, without what the levels and hit
            points of the conditions explain [-].
        share: of the conditions that show a difference, in which the fit leads [-].
        shown: number of those conditions.
    """

    mean: float
    standard_errors: float
    share: float
    shown: int


def lead_of(
    bench: WhitenedBench,
    first: ConditionScores,
    second: ConditionScores,
    visible: float,
) -> Lead:
    """Return the lead of the first fit over the second.

    Args:
        bench: of both.
        first: scores of one fit.
        second: scores of the other.
        visible: expected gain below which a condition has no vote.
    """
    condition = conditions_of(bench.blocks)
    gain = second.score - first.score
    between = bench.powers(second.rows - first.rows)
    expected = mean_log_power(bench, 1.0 + between, condition)
    voting = expected > visible
    error = _standard_error(gain, expected)
    share = float(np.mean(gain[voting] > 0)) if voting.any() else 0.0
    return Lead(
        float(gain.mean()),
        float(gain.mean() / max(error, 1e-12)),
        share,
        int(voting.sum()),
    )


def _standard_error(gain: FloatArray, expected: FloatArray) -> float:
    """Return the standard error of a mean gain over designed conditions.

    A law shows more at high levels than at low ones, whichever explanation is true, so
    that this spread of the gain is no error of its mean. What is predicted linearly by
    the difference of the two explanations is taken out.

    Args:
        gain: of log power, shape (n_conditions,).
        expected: gain if the first explanation were true and white, same shape.
    """
    if gain.size < 3:
        return float(np.inf)
    design = np.stack([np.ones(gain.size), expected - expected.mean()], axis=1)
    rest = gain - design @ np.linalg.lstsq(design, gain, rcond=None)[0]
    return float(np.sqrt(rest @ rest / (gain.size - 2) / gain.size))


def best_of(scores: Sequence[ConditionScores]) -> ConditionScores:
    """Return the scores with the lowest mean."""
    return min(scores, key=lambda s: float(s.score.mean()))
