# SPDX-License-Identifier: MIT
"""Roots of matrix polynomials, warm-started from order to order."""

import numpy as np
import pytest

from jointbench.signal.modal import matrix_roots
from jointbench.signal.modal.matrix_roots import companion_roots, inverse_roots


def random_polynomial(order: int, width: int, seed: int) -> np.ndarray:
    """Return I, A_1, ..., A_n with coefficients of one size."""
    parts = np.random.default_rng(seed).normal(size=(2, order + 1, width, width))
    polynomial = parts[0] + 1j * parts[1]
    polynomial[0] = np.eye(width)
    return polynomial


def furthest(found: np.ndarray, wanted: np.ndarray) -> float:
    """Return the largest relative distance of a root from its own partner."""
    distance = np.abs(found[:, None] - wanted)
    nearest = distance.argmin(axis=1)
    assert np.unique(nearest).size == wanted.size
    return float(np.max(distance.min(axis=1) / np.abs(found)))


@pytest.mark.parametrize("width", [1, 2, 3])
@pytest.mark.parametrize("step", [1, 3])
def test_warm_started_roots_equal_those_of_lapack(width: int, step: int) -> None:
    """From the roots of a lower order of the same polynomial, to 1e-10."""
    polynomial = random_polynomial(24, width, seed=width)
    start = companion_roots(polynomial[:-step])
    found = inverse_roots(polynomial, start)
    assert furthest(found, companion_roots(polynomial)) < 1e-10


def test_roots_do_satisfy_the_polynomial() -> None:
    """The smallest singular value of B(u) at every root is 1e-10 of the largest."""
    polynomial = random_polynomial(15, 2, seed=4)
    for root in inverse_roots(polynomial, companion_roots(polynomial[:-1])):
        powers = root ** np.arange(15, -1, -1)
        value = np.linalg.svd(np.tensordot(powers, polynomial, 1), compute_uv=False)
        assert value[-1] < 1e-10 * value[0]


def test_a_multiple_root_falls_back_on_lapack(monkeypatch: pytest.MonkeyPatch) -> None:
    """Twelve roots at one place converge too slowly: the answer is LAPACK's own."""
    binomial = np.poly(np.full(12, 0.5)).astype(complex)[:, None, None]
    asked = []
    monkeypatch.setattr(
        matrix_roots,
        "companion_roots",
        lambda polynomial: asked.append(1) or companion_roots(polynomial),
    )
    start = np.exp(2j * np.pi * np.arange(11) / 11.0)
    found = inverse_roots(binomial, start)
    assert asked == [1]
    assert np.array_equal(found, companion_roots(binomial))


def test_a_vanishing_last_coefficient_gives_an_inverse_root_of_zero() -> None:
    """A pole at infinity is no error."""
    polynomial = random_polynomial(10, 1, seed=5)
    polynomial[-1] = 0.0
    found = inverse_roots(polynomial, companion_roots(polynomial[:-1]))
    assert np.abs(found).min() < 1e-12
