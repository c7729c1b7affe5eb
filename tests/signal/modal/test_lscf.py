# SPDX-License-Identifier: MIT
"""Poles of a matrix fraction."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.signal.frf.frf import Frf
from jointbench.signal.frf.line_weights import line_weights
from jointbench.signal.modal.lscf import fit_poles

BAND = np.arange(20.0, 1000.0, 0.5)


def nearest(poles: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return the pole closest to each wanted one."""
    return poles[np.argmin(np.abs(poles[:, None] - wanted), axis=0)]


@pytest.mark.parametrize("derivatives", [0, 1, 2])
def test_exact_data_give_exact_poles(
    structure: Callable[..., Any], derivatives: int
) -> None:
    """Three modes, order 12: 1e-5 of the poles' size, whatever was measured."""
    truth = structure((120.0, 400.0, 800.0), (0.01, 0.02, 0.005), (1.0, -0.7, 0.5))
    found = fit_poles(BAND, truth.response(BAND, derivatives), [12])[0]
    error = nearest(found.pole, truth.poles) - truth.poles
    assert np.all(np.abs(error) < 1e-5 * np.abs(truth.poles))


def test_two_inputs_tell_two_modes_of_one_frequency_apart(
    structure: Callable[..., Any],
) -> None:
    """A repeated root: each order has as many poles as there are inputs."""
    one, two = np.array([1.0, 0.5, -0.3]), np.array([0.2, -1.0, 0.8])
    constant = np.stack([np.outer(v, v[:2]) for v in (one, two)])
    truth = structure((300.0, 300.0), (0.01, 0.01), constant)
    found = fit_poles(BAND, truth.response(BAND, 2), [6])[0]
    close = np.abs(found.pole - truth.poles[0]) < 1e-3 * np.abs(truth.poles[0])
    assert np.count_nonzero(close) == 2


def test_the_shape_at_a_pole_is_the_mode_shape(structure: Callable[..., Any]) -> None:
    """Modal assurance 1 to 1e-6 with the vector the mode was made of."""
    rng = np.random.default_rng(0)
    shapes = rng.normal(size=(2, 5))
    constant = np.stack([np.outer(v, v[:2]) for v in shapes])
    truth = structure((200.0, 600.0), (0.01, 0.02), constant)
    found = fit_poles(BAND, truth.response(BAND, 2), [8])[0]
    for pole, shape in zip(truth.poles, shapes, strict=True):
        got = found.shape[int(np.argmin(np.abs(found.pole - pole)))]
        overlap = np.abs(np.vdot(got, shape)) ** 2 / np.vdot(shape, shape).real
        assert overlap == pytest.approx(1.0, abs=1e-6)


def test_orders_fitted_together_equal_orders_fitted_alone(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Each order is a leading block of the largest."""
    frf = noisy_frf(structure((150.0, 450.0), (0.01, 0.02)), BAND, noise=0.01, seed=1)
    together = fit_poles(BAND, frf.response, [6, 9, 20])[1]
    alone = fit_poles(BAND, frf.response, [9])[0]
    assert np.allclose(together.pole, alone.pole, rtol=1e-7)


def test_unevenly_spaced_lines_are_as_good_as_even_ones(
    structure: Callable[..., Any],
) -> None:
    """Every third line left out at random."""
    truth = structure((150.0, 450.0), (0.01, 0.02))
    some = np.sort(np.random.default_rng(2).choice(BAND, 1300, replace=False))
    found = fit_poles(some, truth.response(some, 2), [10])[0]
    assert np.allclose(nearest(found.pole, truth.poles), truth.poles, rtol=1e-5)


def test_a_narrow_band_far_from_zero_is_fitted_as_well(
    structure: Callable[..., Any],
) -> None:
    """Two modes 0.8 % apart between 4 and 4.2 kHz."""
    band = np.arange(4000.0, 4200.0, 0.5)
    truth = structure((4090.0, 4123.0), (0.002, 0.003))
    found = fit_poles(band, truth.response(band, 2), [10])[0]
    assert np.allclose(nearest(found.pole, truth.poles), truth.poles, rtol=1e-6)


def test_the_damping_of_a_low_mode_gains_from_its_mirror_image(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """40 Hz in a band of 1 kHz: without the image at -40 Hz the error is thrice."""
    truth = structure((40.0, 300.0, 700.0), (0.02, 0.01, 0.01))
    errors = []
    for seed in range(6):
        frf = noisy_frf(truth, BAND, noise=0.01, seed=seed)
        both = [
            fit_poles(BAND, frf.response, [order], mirrored=mirrored)[0].pole
            for order, mirrored in ((40, True), (20, False))
        ]
        errors.append(
            [abs(nearest(p, truth.poles)[0].real + 1.6 * np.pi) for p in both]
        )
    with_image, without = np.mean(errors, axis=0)
    assert without > 3.0 * with_image


def test_noise_poles_fall_outside_the_circle(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """Of the 40 poles of order 40, one mode and at most three others are damped."""
    frf = noisy_frf(structure((400.0,), (0.01,)), BAND, noise=0.02, seed=3)
    assert fit_poles(BAND, frf.response, [40])[0].pole.size <= 4


def test_the_decay_rate_of_the_window_is_taken_off_the_poles(
    structure: Callable[..., Any],
) -> None:
    """H(s + rate) has its poles moved by -rate; the answer is that of H."""
    truth = structure((200.0,), (0.01,))
    s = 2j * np.pi * BAND + 30.0
    p, r = truth.poles[0], truth.residues()[0, 0, 0]
    moved = (r / (s - p) + np.conj(r) / (s - np.conj(p)))[None, None]
    found = fit_poles(BAND, moved, [8], added_decay_rate=30.0)[0]
    assert abs(nearest(found.pole, truth.poles)[0] - p) < 1e-5 * abs(p)


def test_the_scalar_form_finds_the_poles_of_many_inputs(
    structure: Callable[..., Any],
) -> None:
    """Two modes seen from three inputs: one denominator, shapes of six components."""
    shapes = np.array([[1.0, 0.5, -0.7], [0.3, -1.0, 0.9]])
    constant = np.stack([np.outer(v[:2], v) for v in shapes])
    truth = structure((200.0, 600.0), (0.01, 0.02), constant)
    found = fit_poles(BAND, truth.response(BAND, 2), [10], scalar=True)[0]
    assert found.shape.shape[1] == 6
    assert np.allclose(nearest(found.pole, truth.poles), truth.poles, rtol=1e-5)


def test_noisy_lines_count_less_when_they_are_weighted(
    structure: Callable[..., Any], noisy_frf: Callable[..., Frf]
) -> None:
    """A third of the lines with 50 times the noise: weights take off a third."""
    truth = structure((200.0, 700.0), (0.01, 0.01))
    errors = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        clean = truth.response(BAND, 2)
        sd = np.where((BAND > 300.0) & (BAND < 600.0), 0.5, 0.01) * np.abs(clean).mean()
        parts = rng.normal(size=(2, *clean.shape))
        response = clean + sd * (parts[0] + 1j * parts[1])
        weight = line_weights(response, np.broadcast_to(2.0 * sd**2, clean.shape))
        both = [
            fit_poles(BAND, response, [12], weight=w)[0].pole for w in (None, weight)
        ]
        errors.append([np.abs(nearest(p, truth.poles) - truth.poles) for p in both])
    plain, weighted = np.mean(errors, axis=(0, 2))
    assert weighted < 0.67 * plain
