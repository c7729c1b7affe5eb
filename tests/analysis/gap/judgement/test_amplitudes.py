"""The base that is best with the amplitudes of a fit at zero."""

from dataclasses import replace

import numpy as np

from jointbench.analysis.gap.catalogue.nonlinear_effects import JENKINS
from jointbench.analysis.gap.judgement.amplitudes import base_without
from jointbench.analysis.gap.model.effect import Candidate, Effect, Site
from jointbench.analysis.gap.residuals.fit_records import Fit

N_BASE = 3
FREE = JENKINS.effect
FIRST = FREE.parameters[0]
FIXED = replace(
    FREE, parameters=(replace(FIRST, upper=FIRST.lower), *FREE.parameters[1:])
)


def at_minimum(*effects: Effect) -> Fit:
    """Return the minimum of a linear problem with effects at several places."""
    draws = np.random.default_rng(5)
    n = N_BASE + sum(len(e.parameters) for e in effects)
    slopes = draws.normal(size=(40, n))
    prior, data = draws.uniform(0.5, 2.0, n), draws.normal(size=40)
    x = np.linalg.solve(slopes.T @ slopes + np.diag(prior), slopes.T @ data)
    sites = [Site("link", f"joint {k}") for k in range(len(effects))]
    candidates = tuple(Candidate(e, s) for e, s in zip(effects, sites, strict=True))
    residual = slopes @ x - data
    cost = float(residual @ residual + prior @ x**2)
    return Fit(x, N_BASE, candidates, residual, slopes, cost, prior, np.zeros(n))


def without(fit: Fit, columns: list[int]) -> np.ndarray:
    """Return the minimum of the same problem without some of its columns."""
    data = fit.jacobian @ fit.x - fit.residual
    slopes = np.delete(fit.jacobian, columns, axis=1)
    prior = np.diag(np.delete(fit.prior, columns))
    return np.linalg.solve(slopes.T @ slopes + prior, slopes.T @ data)


def test_with_amplitudes_at_zero_the_base_is_that_of_a_fit_without_them() -> None:
    """Shapes of the effects are free: only the amplitudes are at zero."""
    fit = at_minimum(FREE, FREE)
    amplitudes = [N_BASE, N_BASE + len(FREE.parameters)]
    expected = without(fit, amplitudes)[:N_BASE]
    np.testing.assert_allclose(base_without(fit), expected, rtol=1e-9)


def test_an_amplitude_that_is_fixed_stays() -> None:
    """Only the other one is at zero; without any, the base stays as well."""
    fit = at_minimum(FIXED, FREE)
    other = [N_BASE + len(FIXED.parameters)]
    np.testing.assert_allclose(base_without(fit), without(fit, other)[:N_BASE])
    alone = at_minimum(FIXED)
    np.testing.assert_array_equal(base_without(alone), alone.base)
