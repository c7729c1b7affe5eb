# SPDX-License-Identifier: MIT
"""Fits of a search in a few words and numbers, as every diagnosis shows them."""

from collections.abc import Callable, Sequence

import numpy as np

from jointbench.analysis.gap.model.diagnosis_record import Ranked
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import score


def labels_of_fit(fit: Fit) -> tuple[str, ...]:
    """Return name and site of each effect of a fit; "none" for the base alone."""
    return tuple(c.label for c in fit.candidates) or ("none",)


def ranked_fits(
    bench: Bench, fits: Sequence[Fit], over_dof: Callable[[Fit], float]
) -> tuple[Ranked, ...]:
    """Return fits by score, the best first.

    Args:
        bench: of the fits.
        fits: with the base.
        over_dof: chi2 of a fit over its degrees of freedom.
    """
    rows = sorted(fits, key=lambda f: score(bench, f))
    first = score(bench, rows[0])
    return tuple(
        Ranked(
            labels_of_fit(f),
            score(bench, f),
            score(bench, f) - first,
            over_dof(f),
            largest_deviation(f),
        )
        for f in rows
    )


def largest_deviation(fit: Fit) -> float:
    """Return the largest deviation of a base parameter from its prior [sd]."""
    return float(np.abs(fit.prior_deviations).max())


def deviations_from_priors(
    names: Sequence[str], base: Fit, best: Fit
) -> dict[str, tuple[float, float]]:
    """Return the deviation of each base parameter before and after [sd].

    Args:
        names: of the base parameters.
        base: fit without effects.
        best: fit that is shown.
    """
    return {
        name: (float(b), float(a))
        for name, b, a in zip(
            names, base.prior_deviations, best.prior_deviations, strict=True
        )
    }
