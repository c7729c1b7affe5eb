# SPDX-License-Identifier: MIT
"""H1, H2 and Hv against the bias that theory gives each."""

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.signal.frf.estimators import Estimator, bias_bound, estimate_pair

HITS, LINES = 40, 4000
TRUTH = 2.0 - 1.0j


def noise(power: float, seed: int, hits: int = HITS) -> ComplexArray:
    """Return complex white noise of a power."""
    parts = np.random.default_rng(seed).normal(size=(2, hits, LINES))
    return np.asarray(np.sqrt(power / 2.0) * (parts[0] + 1j * parts[1]))


def pair(
    force_noise: float, response_noise: float, hits: int = HITS
) -> tuple[ComplexArray, ComplexArray]:
    """Return spectra of a force of power 1 and its response, as measured."""
    force = np.ones((hits, LINES), complex)
    measured = force + noise(force_noise, 1, hits)
    share = response_noise * abs(TRUTH) ** 2
    return measured, TRUTH * force + noise(share, 2, hits)


@pytest.mark.parametrize(
    ("estimator", "force_noise", "response_noise", "gain"),
    [
        (Estimator.H1, 0.2, 0.0, 1.0 / 1.2),
        (Estimator.H1, 0.0, 0.3, 1.0),
        (Estimator.H2, 0.2, 0.0, 1.0),
        (Estimator.H2, 0.0, 0.3, 1.3),
        (Estimator.HV, 0.2, 0.2, 1.0),
        (Estimator.HV, 0.2, 0.0, 1.2**-0.5),
    ],
)
def test_each_estimator_carries_the_bias_it_is_named_for(
    estimator: Estimator, force_noise: float, response_noise: float, gain: float
) -> None:
    """|H| over the truth, mean of 4000 lines of 40 hits: within 1 %."""
    found = estimate_pair(*pair(force_noise, response_noise), estimator).response
    assert np.mean(np.abs(found)) / abs(TRUTH) == pytest.approx(gain, rel=0.01)


def test_the_three_share_one_phase_and_coherence_is_h1_over_h2() -> None:
    """Exact identities."""
    h1, h2, hv = (estimate_pair(*pair(0.1, 0.2), e) for e in Estimator)
    assert np.allclose(np.angle(h1.response), np.angle(h2.response))
    assert np.allclose(np.abs(h1.response / h2.response), h1.coherence)
    between = np.sqrt(np.abs(h1.response * h2.response))
    assert np.allclose(np.abs(hv.response), between)


@pytest.mark.parametrize("estimator", list(Estimator))
def test_the_variance_is_that_of_the_error(estimator: Estimator) -> None:
    """A tenth of noise on the response: mean squared scatter over lines, 5 %."""
    found = estimate_pair(*pair(0.0, 0.01), estimator)
    scatter = np.var(found.response)
    assert scatter == pytest.approx(np.mean(found.variance), rel=0.1)


def test_the_bound_of_the_bias_is_the_gap_between_h1_and_h2() -> None:
    """Shares 0.1 and 0.2: 1 - 1 / (1.1 x 1.2), also from three hits."""
    exact = 1.0 - 1.0 / (1.1 * 1.2)
    for hits, within in ((HITS, 0.02), (3, 0.1)):
        coherence = estimate_pair(*pair(0.1, 0.2, hits)).coherence
        bound = float(np.mean(bias_bound(coherence, hits)))
        assert bound == pytest.approx(exact, rel=within)


def test_a_silent_response_gives_zero_and_no_warning() -> None:
    """Zero over zero is zero here."""
    force = np.ones((2, 5), complex)
    for estimator in Estimator:
        found = estimate_pair(force, np.zeros((2, 5), complex), estimator)
        assert not np.any(found.response)


@pytest.mark.parametrize("estimator", list(Estimator))
def test_every_estimator_names_its_bias(estimator: Estimator) -> None:
    """In a few words, for provenance and report."""
    assert "nois" in estimator.bias
