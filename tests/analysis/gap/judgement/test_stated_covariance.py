"""Standard deviations that a report states, where errors of a model are coherent."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.judgement.stated_covariance import stated_covariance
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit

RECORDS, ROWS, TRUE = 150, 50, np.array([0.3, -0.2, 0.1])
DRAWS = 300


def blocks(*, white: bool) -> Blocks:
    """Return the rows of all records."""
    group = np.repeat(np.arange(RECORDS), ROWS)
    shape = (RECORDS, 1, ROWS)
    return Blocks(group, ({},) * RECORDS, group.size, shape, white=white)


def fitted(slopes: FloatArray, errors: FloatArray) -> Fit:
    """Return the least-squares fit of the true line with errors, without a prior."""
    measured = slopes @ TRUE + errors
    x = np.linalg.lstsq(slopes, measured, rcond=None)[0]
    residual = slopes @ x - measured
    none = np.zeros(TRUE.size)
    return Fit(x, TRUE.size, (), residual, slopes, residual @ residual, none, none)


def drawn(coherent: float) -> tuple[FloatArray, FloatArray]:
    """Return errors of estimates, and the sds stated; rows (n_draws, 3).

    A record's error has one sign in all of its samples, beside noise of half its floor.
    """
    rng = np.random.default_rng(7)
    slopes = np.repeat(rng.standard_normal((RECORDS, TRUE.size)), ROWS, axis=0)
    slopes *= 1 + 0.3 * rng.standard_normal(slopes.shape)
    errors, stated = [], []
    for _ in range(DRAWS):
        common = coherent * np.repeat(rng.standard_normal(RECORDS), ROWS)
        fit = fitted(slopes, common + 0.5 * rng.standard_normal(len(slopes)))
        errors.append(fit.x - TRUE)
        variance = np.diag(stated_covariance(fit, blocks(white=False)))
        stated.append(np.sqrt(variance))
    return np.array(errors), np.array(stated)


def test_an_error_that_a_record_shares_is_not_averaged_out_by_its_samples() -> None:
    """The scatter of estimates is what is stated, far above the sd of the curvature.

    Three times the sd of a sd of 300 draws is 13 %.
    """
    errors, stated = drawn(coherent=0.8)
    mean = np.sqrt(np.mean(stated**2, axis=0))
    assert errors.std(axis=0) == pytest.approx(mean, rel=0.13)
    assert mean.min() > 4 / np.sqrt(RECORDS * ROWS)


def test_no_sd_is_below_that_of_the_curvature() -> None:
    """With noise of half the floor only, the floor is what is stated."""
    errors, stated = drawn(coherent=0.0)
    assert np.all(errors.std(axis=0) < 0.6 * stated.mean(axis=0))


def test_white_residuals_are_stated_by_the_curvature() -> None:
    """The clusters are left out, and chi2 above its degrees of freedom widens."""
    rng = np.random.default_rng(3)
    slopes = rng.standard_normal((RECORDS * ROWS, TRUE.size))
    fit = fitted(slopes, 2.0 * rng.standard_normal(len(slopes)))
    wide = fit.chi2 / (RECORDS * ROWS)
    found = stated_covariance(fit, blocks(white=True))
    assert np.allclose(found, fit.covariance * wide, rtol=1e-12)
    small = replace(fit, residual=0.1 * fit.residual)
    assert np.allclose(stated_covariance(small, blocks(white=True)), fit.covariance)
