# SPDX-License-Identifier: MIT
"""Decays of one mode: closed form, and derivatives against differences."""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.amplitude.curve_basis import (
    CurveBasis,
    constant_basis,
    spline_basis,
)
from jointbench.signal.amplitude.slow_flow import decay_signal, master_decay

CENTRE = 500.0
TIME = np.linspace(0.0, 0.8, 50)


def signal(
    basis: CurveBasis, curves: FloatArray, start: float, phase: float
) -> tuple[ComplexArray, ComplexArray]:
    """Return signal and derivatives for coefficients of both curves."""
    half = basis.size
    decay = master_decay(basis, curves[:half], curves[half:], CENTRE, 2)
    return decay_signal(decay, start, phase, TIME)


def test_constant_curves_give_an_exponential_decay() -> None:
    """exp((i (omega - centre) - zeta omega) t), to the accuracy of the tables."""
    basis = constant_basis(-20.0, -6.0, 0.0)
    omega, zeta = CENTRE * np.exp(0.01), 0.006
    found, _ = signal(basis, np.array([0.01, np.log(zeta)]), -0.5, 0.3)
    rate = 1j * (omega - CENTRE) - zeta * omega
    expected = np.exp(-0.5 + 2 * 0.01 + 0.3j + rate * TIME)
    assert np.abs(found / expected - 1.0).max() < 1e-6


def test_derivatives_are_those_of_differences() -> None:
    """Central differences of the signal, within the step of the tables."""
    rng = np.random.default_rng(3)
    basis = spline_basis(-14.0, -6.0, 0.0, 1.0)
    curves = np.concatenate(
        (0.01 * rng.normal(size=basis.size), -5 + 0.2 * rng.normal(size=basis.size))
    )
    at = np.append(curves, [-0.437, 0.3])
    _, change = signal(basis, curves, *at[-2:])
    # The start moves by one cell of the tables, inside which slopes are constant.
    sizes = np.append(np.full(curves.size, 1e-5), [0.02, 1e-5])
    for number, size in enumerate(sizes):
        step = np.zeros(at.size)
        step[number] = size
        after, before = (
            signal(basis, (at + s)[:-2], *(at + s)[-2:])[0] for s in (step, -step)
        )
        slope = (after - before) / (2.0 * size)
        scale = np.abs(change[:, number]).max() + 1e-9
        assert np.abs(slope - change[:, number]).max() < 0.02 * scale
