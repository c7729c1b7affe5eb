# SPDX-License-Identifier: MIT
"""Decays of one mode: closed form, and derivatives against differences."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.amplitude.curve_basis import (
    CurveBasis,
    constant_basis,
    spline_basis,
)
from jointbench.signal.amplitude.mode_state import ModeState
from jointbench.signal.amplitude.panels import panels
from jointbench.signal.amplitude.slow_flow import decays

CENTRE = 500.0
PANELS = panels(0.8, 60.0)
TIME = PANELS.time
# Squares of another mode that decays more slowly, in both hits.
OTHER = np.exp(2.0 * (-1.0 - 2.0 * TIME))[None, :, None] * np.ones((2, 1, 1))


def one(curves: FloatArray, basis: CurveBasis, weights: FloatArray) -> ModeState:
    """Return a mode with coefficients of both curves; two hits."""
    shared = weights.size // 2
    return ModeState(
        basis=basis,
        log_omega=curves[: basis.size],
        log_zeta=curves[basis.size :],
        shape=np.ones(1, complex),
        reference=0,
        start=np.array([-0.437, -1.2]),
        phase=np.array([0.3, -0.1]),
        squares=OTHER[:, :, :shared],
        log_weights=weights.reshape(2, shared),
    )


def test_constant_curves_give_an_exponential_decay() -> None:
    """exp((i (omega - centre) - zeta omega) t), to the accuracy of the quadrature."""
    basis = constant_basis(-20.0, -6.0, 0.0)
    omega, zeta = CENTRE * np.exp(0.01), 0.006
    mode = one(np.array([0.01, np.log(zeta)]), basis, np.empty(0))
    found = decays(mode, PANELS, CENTRE, 2).signal[0]
    rate = 1j * (omega - CENTRE) - zeta * omega
    expected = np.exp(-0.437 + 2 * 0.01 + 0.3j + rate * TIME)
    assert np.abs(found / expected - 1.0).max() < 1e-6


@pytest.mark.parametrize("weights", [np.empty(0), np.array([0.2, -0.5])])
def test_derivatives_are_those_of_differences(weights: FloatArray) -> None:
    """Central differences of ln signal, alone and with another mode on the joint."""
    rng = np.random.default_rng(3)
    basis = spline_basis(-14.0, -6.0, 0.0, 1.0)
    curves = np.concatenate(
        (0.01 * rng.normal(size=basis.size), -5 + 0.2 * rng.normal(size=basis.size))
    )
    change = decays(one(curves, basis, weights), PANELS, CENTRE, 2).change
    at, scale = np.append(curves, weights), np.abs(change).max(axis=(0, 1)) + 1e-9
    for number in range(at.size):
        step = np.zeros(at.size)
        step[number] = 1e-4
        after, before = (
            decays(one(p[: curves.size], basis, p[curves.size :]), PANELS, CENTRE, 2)
            for p in (at + step, at - step)
        )
        slope = np.log(after.signal / before.signal) / 2e-4
        assert np.abs(slope - change[..., number]).max() < 0.02 * scale[number]


def test_a_start_and_a_phase_move_the_signal_as_their_derivatives_say() -> None:
    """One cell of the table of curves, inside which slopes are constant."""
    rng = np.random.default_rng(3)
    basis = spline_basis(-14.0, -6.0, 0.0, 1.0)
    curves = np.append(0.01 * rng.normal(size=basis.size), np.full(basis.size, -5.0))
    mode = one(curves, basis, np.empty(0))
    change = decays(mode, PANELS, CENTRE, 2).change
    after, before = (
        decays(replace(mode, start=mode.start + s), PANELS, CENTRE, 2).signal
        for s in (0.02, -0.02)
    )
    slope = np.log(after / before) / 0.04
    assert np.abs(slope - change[..., -2]).max() < 0.02 * np.abs(slope).max()
    assert np.all(change[..., -1] == 1j)


def test_two_modes_with_equal_squares_act_as_one_of_larger_amplitude() -> None:
    """Weight 1 and the mode's own square: S = L + ln(2) / 2 at the start."""
    basis = spline_basis(-14.0, -6.0, 0.0, 1.0)
    slope = basis.knots[2:-2]
    curves = np.append(0.01 * slope, np.full(basis.size, -9.0))
    mode = one(curves, basis, np.zeros(2))
    own = np.exp(2.0 * mode.start)[:, None, None] * np.ones_like(OTHER)
    both = decays(replace(mode, squares=own), PANELS, CENTRE, 0)
    rate = np.gradient(np.unwrap(np.angle(both.signal[0])), TIME)[2]
    expected = CENTRE * np.expm1(0.01 * (mode.start[0] + 0.5 * np.log(2.0)))
    assert rate == pytest.approx(expected, rel=1e-2)
