# SPDX-License-Identifier: MIT
"""Significance of the effects of a fit, its base without them, shapes at a limit."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate, labels_of
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.fit_records import Fit


def at_the_end(fit: Fit, policy: Policy = STANDARD) -> str:
    """Name the shape parameter of a law that is at the end of its range, if any.

    Such a law imitates another one: a Bouc-Wen element with a very sharp corner is a
    Jenkins slider.
    """
    sd = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    for at, term in zip(_amplitudes(fit), fit.terms, strict=True):
        for k, p in enumerate(term.candidate.effect.parameters):
            low, high = p.bounds
            span, u = high - low, term.coordinates[k]
            known = sd[at + k] < policy.shape_sd_share * span
            if k and known and np.isfinite(span):
                if min(u - low, high - u) < policy.shape_end_share * span:
                    return f"{p.name} of {term.candidate.label} is at its limit"
    return ""


def weakest(fit: Fit, others: Sequence[Fit]) -> float:
    """Return the distance of the weakest effect of a fit from zero [sd].

    It is computed from the rise of the cost if a fit without the effect is available,
    otherwise from its amplitude: the amplitude of a weak friction law is uncertain
    although the law is needed.
    """
    own, distances = labels_of(fit.candidates), []
    for candidate in fit.candidates:
        rest = own - {candidate.label}
        without = [f.cost for f in others if labels_of(f.candidates) == rest]
        if not without:
            return weakest_amplitude(fit)
        distances.append(np.sqrt(max(min(without) - fit.cost, 0.0)))
    return float(min(distances, default=np.inf))


def weakest_amplitude(fit: Fit) -> float:
    """Return the smallest distance of an amplitude from OFF, in sd."""
    return min(amplitude_sizes(fit), default=np.inf)


def amplitude_sizes(fit: Fit) -> list[float]:
    """Return the distance of each amplitude from OFF, in sd; infinite if fixed."""
    sd = np.sqrt(np.maximum(np.diag(fit.covariance), 1e-300))
    return [
        float(abs(fit.x[at]) / sd[at]) if _is_free(candidate) else np.inf
        for at, candidate in zip(_amplitudes(fit), fit.candidates, strict=True)
    ]


def base_without(fit: Fit) -> FloatArray:
    """Return the base that is best, by the linear model of a fit, with its effects off.

    Args:
        fit: at its minimum, with its slopes.

    Returns:
        Coordinates of the base, shape (n_base,).
    """
    found = zip(_amplitudes(fit), fit.candidates, strict=True)
    off = [at for at, candidate in found if _is_free(candidate)]
    covariance, n = fit.covariance, fit.n_base
    weights = np.linalg.pinv(covariance[np.ix_(off, off)], hermitian=True)
    return np.asarray(fit.base - covariance[:n, off] @ weights @ fit.x[off])


def _amplitudes(fit: Fit) -> list[int]:
    """Return where the amplitude of each effect stands among the coordinates."""
    counts = [len(c.effect.parameters) for c in fit.candidates]
    return [fit.n_base + int(k) for k in np.cumsum([0, *counts])[:-1]]


def _is_free(candidate: Candidate) -> bool:
    first = candidate.effect.parameters[0]
    return first.upper - first.lower > 1e-3
