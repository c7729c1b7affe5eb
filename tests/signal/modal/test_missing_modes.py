# SPDX-License-Identifier: MIT
"""Modes that were missed: added where the residual needs them, else in the interval."""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.computational_modes import find_beyond
from jointbench.signal.modal.frf_lines import FrfLines
from jointbench.signal.modal.lsfd import fit_residues
from jointbench.signal.modal.refined_pole_covariance import refine_poles
from jointbench.signal.modal.residual_search.doubtful_neighbours import (
    doubtful_neighbours,
    neighbour_words,
)
from jointbench.signal.modal.residual_search.local_fit import WholeFit
from jointbench.signal.modal.residual_search.missing_modes import find_missing
from jointbench.signal.modal.shared_errors import shared_covariance

OMEGA = 2.0 * np.pi * np.arange(50.0, 150.0, 0.125)
SIZE = 1e-3
NONE = np.empty(0, complex)


def pole_at(frequency: float, ratio: float = 0.01) -> complex:
    """Return a pole [rad/s]."""
    omega = 2.0 * np.pi * frequency
    return complex(omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2)))


def measured(
    pole: list[complex],
    size: list[float],
    *,
    smooth: float = 0.0,
    seed: int = 1,
    alike: bool = False,
) -> FrfLines:
    """Return six FRFs of two references with noise and an error that they share.

    All modes have one shape where they are `alike`.
    """
    rng = np.random.default_rng(seed)
    s = 1j * OMEGA
    exact = np.zeros((6, s.size), complex)
    one = np.array([[1.0], [0.4], [-0.8], [1.3], [-0.5], [0.9]])
    for p, scale in zip(pole, size, strict=True):
        residue = scale * (one if alike else rng.normal(size=(6, 1)))
        exact += residue * (s**2 / (s - p) - s**2 / (s - p.conjugate())) / 2j
    factor = np.ones((2, s.size), complex)
    if smooth > 0.0:
        parts = rng.normal(size=(2, 2, s.size // 16 + 1))
        knots = parts[0] + 1j * parts[1]
        place = np.linspace(0.0, knots.shape[1] - 1.0, s.size)
        index = np.arange(knots.shape[1])
        factor += smooth * np.array([np.interp(place, index, k) for k in knots])
    level = SIZE * np.abs(exact).max()
    noise = rng.normal(size=exact.shape) + 1j * rng.normal(size=exact.shape)
    return FrfLines(s, exact * np.tile(factor, (3, 1)) + level * noise, 2)


def whole_fit(lines: FrfLines, pole: list[complex]) -> WholeFit:
    """Return the refined fit of some poles, noise known."""
    level = float(np.std(np.diff(lines.response[:, :40], 2, axis=1)) / np.sqrt(6.0))
    noise = np.full(lines.response.shape, level**2)
    refined = refine_poles(lines, np.array(pole), noise).pole
    fit = fit_residues(lines, refined, noise)
    return WholeFit(lines, refined, refined.size, fit, noise, noise)


def spread(whole: WholeFit) -> FloatArray:
    """Return the covariance of (Re p, Im p) of each mode [rad^2/s^2]."""
    return refine_poles(whole.lines, whole.pole, whole.noise, steps=0).covariance


def errors(found: ComplexArray, true: complex) -> FloatArray:
    """Return the distance of poles over the half width of the true one [-]."""
    return np.asarray(np.abs(found - true) / abs(true.real))


def test_a_mode_that_was_missed_is_found_in_the_residual() -> None:
    """Two of three modes fitted; the third within 10 % of its width."""
    third = pole_at(104.0)
    lines = measured([pole_at(80.0), pole_at(100.0), third], [1.0, 1.0, 0.1])
    whole = whole_fit(lines, [pole_at(80.0), pole_at(100.0)])
    found = find_missing(whole, None).pole
    assert found.size == 1
    assert errors(found, third)[0] < 0.1


def test_a_mode_nearer_than_its_width_is_found_by_its_shape() -> None:
    """Half a half-power half-width from another: found, unless both have one shape."""
    poles = [pole_at(80.0), pole_at(100.0, 0.02), pole_at(101.0, 0.02)]
    for alike in (False, True):
        lines = measured(poles, [1.0, 1.0, 1.0], alike=alike)
        found = find_missing(whole_fit(lines, poles[:2]), None).pole
        assert found.size == (0 if alike else 1)
    # A peak that is not that of one linear mode is explained by two of one shape.


def test_a_complete_fit_gets_no_mode_and_no_doubt() -> None:
    """White residual: nothing added, no interval wider, nothing said."""
    poles = [pole_at(80.0), pole_at(100.0)]
    whole = whole_fit(measured(poles, [1.0, 1.0]), poles)
    doubts = doubtful_neighbours(whole, spread(whole), NONE)
    assert find_missing(whole, None).pole.size == find_beyond(whole).size == 0
    assert not doubts.shift.any()
    assert neighbour_words(doubts) == ()


def test_a_pole_that_no_order_shows_is_remarked_on_and_not_added() -> None:
    """The same third mode, denied by the stabilisation table."""
    poles = [pole_at(80.0), pole_at(100.0), pole_at(104.0)]
    whole = whole_fit(measured(poles, [1.0, 1.0, 0.1]), poles[:2])
    missing = find_missing(whole, lambda pole: False)
    assert missing.pole.size == 0
    doubts = doubtful_neighbours(whole, spread(whole), missing.denied)
    assert np.all(np.abs(doubts.denied - 104.0) < 0.1)
    assert "the lines near 104" in neighbour_words(doubts)[-1]


def test_a_neighbour_that_stays_out_widens_the_interval_and_is_named() -> None:
    """A third mode half a width from the second: its frequency is in the remark."""
    poles = [pole_at(80.0), pole_at(100.0), pole_at(100.6)]
    lines = measured(poles, [1.0, 1.0, 0.1])
    whole = whole_fit(lines, poles[:2])
    doubts = doubtful_neighbours(whole, spread(whole), NONE)
    moved = np.abs(whole.pole[1] - poles[1])
    assert np.sqrt(np.trace(doubts.shift[1])) > 0.5 * moved
    assert doubts.shift[0].max() < 0.2 * doubts.shift[1].max()
    assert any(abs(f - 100.5) < 2.0 for f in doubts.frequency)
    assert "may be missing near" in neighbour_words(doubts)[0]


def test_modes_beyond_the_band_are_fitted_one_after_the_other() -> None:
    """Two modes above the band: with both, the pole at the edge is unbiased."""
    poles = [pole_at(80.0), pole_at(146.0), pole_at(152.0), pole_at(158.0)]
    whole = whole_fit(measured(poles, [1.0, 1.0, 1.0, 1.0]), poles[:2])
    beyond = find_beyond(whole)
    assert beyond.size == 2
    after = refine_poles(whole.lines, whole.pole, whole.noise, beyond=beyond)
    before = errors(whole.pole, poles[1])[1]
    assert errors(after.pole, poles[1])[1] < 0.1 * before


def test_an_error_that_all_frfs_share_widens_the_interval_and_noise_does_not() -> None:
    """A smooth factor of 1 % common to the outputs: scores within 3 sd with it."""
    poles = [pole_at(80.0, 0.05), pole_at(100.0, 0.05)]
    for smooth, wider in ((0.0, False), (0.01, True)):
        lines = measured(poles, [1.0, 1.0], smooth=smooth, seed=3)
        whole = whole_fit(lines, poles)
        refined = refine_poles(lines, whole.pole, whole.noise, steps=0)
        shared = shared_covariance(lines, refined, whole.fit, whole.noise, 2)
        assert bool(np.any(shared[:, 0, 0] > refined.covariance[:, 0, 0])) is wider
        if wider:
            away = whole.pole.imag - np.array(poles).imag
            sd = np.sqrt(refined.covariance[:, 1, 1] + shared[:, 1, 1])
            assert np.all(np.abs(away) < 3.0 * sd)
