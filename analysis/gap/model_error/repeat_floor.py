# SPDX-License-Identifier: MIT
"""What repeats of a condition leave: no law can explain how two of them differ.

Two hits of one condition share every error of the model, of a law as well. What is left
of their residuals after their common response function is taken out is scatter and
noise. A law of the right family comes near this floor; a wrong one, which merely bends
the response in the right direction, does not.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.judgement.held_out import conditions_of
from jointbench.analysis.gap.model_error.condition_scores import ConditionScores
from jointbench.analysis.gap.model_error.whitened_bench import WhitenedBench
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE


def repeat_power(bench: WhitenedBench, scores: ConditionScores) -> FloatArray:
    """Return the power by which repeats differ, NaN for records without repeats.

    Args:
        bench: with the whitening of the fit.
        scores: of the fit.

    Returns:
        Shape (n_records, n_channels, n_bands), in the units of a whitened residual.
    """
    at, frame, fit = bench.whitening, bench.whitening.frame, scores.fit
    weighted = at.weight * bench.spectrum(fit.base, fit.terms, MIDDLE)
    condition = conditions_of(bench.blocks)
    out = np.full(frame.signal.shape, np.nan)
    for g in range(int(condition.max()) + 1):
        rows = np.flatnonzero(condition == g)
        if rows.size < 2:
            continue
        common = at.common[rows]
        size = np.sqrt(np.sum(np.abs(common) ** 2, axis=0))
        common = common / np.maximum(size, 1e-300)
        along = np.sum(np.conj(common) * weighted[rows], axis=0)
        rest = weighted[rows] - common * along
        power = np.sum(np.abs(rest) ** 2, axis=0) / (rows.size - 1)
        out[rows] = frame.in_bands(power)
    return out


def left_of_explainable(
    bench: WhitenedBench, base: ConditionScores, best: ConditionScores
) -> float | None:
    """Return the share of what a law could explain that the best one leaves [-].

    Args:
        bench: of both.
        base: scores without a law.
        best: scores of the best law.

    Returns:
        0 where only the difference of repeats is left, 1 where nothing is explained;
        None without repeats.
    """
    floor = repeat_power(bench, best)
    seen = bench.whitening.frame.counted & np.isfinite(floor)
    if not seen.any():
        return None

    def over_base(power: FloatArray) -> float:
        ratio = np.maximum(power[seen], 1e-300) / np.maximum(base.power[seen], 1e-300)
        return float(np.exp(np.mean(np.log(ratio))))

    lowest = min(over_base(floor), over_base(best.power))
    return (over_base(best.power) - lowest) / max(1.0 - lowest, 1e-12)
