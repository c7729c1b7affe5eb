"""Modes of free blocks against closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.simulators.flexible.block_modes import (
    RIGID,
    ElasticBlock,
    block_modes,
    displacement,
    displacement_gradient,
)

SQUARE = ElasticBlock((0.1, 0.1, 0.07), 70e9, 0.3, 2700.0)
PLATE = ElasticBlock((0.5, 0.3, 0.05), 55e9, 0.25, 2600.0)


def test_a_square_block_has_lames_mode() -> None:
    """Without change of volume: f = c_s / (sqrt(2) a), whatever the third side."""
    modes = block_modes(SQUARE, terms=(8, 8, 6), elastic=12)
    shear_speed = np.sqrt(SQUARE.youngs_modulus / 2 / 1.3 / SQUARE.density)
    expected = shear_speed / np.sqrt(2) / 0.1
    assert np.abs(modes.frequency / expected - 1).min() < 1e-6


def test_a_block_without_lateral_strain_is_a_rod() -> None:
    """With Poisson's ratio 0 the longitudinal modes are n c / (2 L)."""
    rod = ElasticBlock((0.6, 0.05, 0.04), 70e9, 0.0, 2700.0)
    modes = block_modes(rod, terms=(14, 4, 4), elastic=24)
    first = np.sqrt(rod.youngs_modulus / rod.density) / 2 / 0.6
    for order in (1, 2):
        assert np.abs(modes.frequency / (order * first) - 1).min() < 1e-6


def test_a_slender_block_bends_as_a_free_beam() -> None:
    """Euler and Bernoulli: (beta L)^2 = 22.373; shear lowers it by 6 (h / L)^2."""
    beam = ElasticBlock((1.0, 0.02, 0.01), 200e9, 0.3, 7800.0)
    modes = block_modes(beam, terms=(12, 4, 4), elastic=2)
    radius = 0.01 / np.sqrt(12)
    speed = np.sqrt(beam.youngs_modulus / beam.density)
    expected = 22.3733 * radius * speed / 2 / np.pi
    assert modes.frequency[RIGID] == pytest.approx(expected, rel=2e-3)


def test_frequencies_converge_from_above() -> None:
    """Ritz's method: more polynomials never raise a frequency."""
    found = [
        block_modes(PLATE, terms=terms, elastic=12).frequency[RIGID:]
        for terms in ((7, 6, 4), (9, 8, 5), (12, 10, 6))
    ]
    assert np.all(found[1] <= found[0] * (1 + 1e-9))
    assert np.all(found[2] <= found[1] * (1 + 1e-9))
    assert_allclose(found[1], found[2], rtol=2e-3)


def test_six_modes_are_rigid_and_carry_the_mass() -> None:
    """The squares of their motions at the centre add up to 1/m in each direction."""
    modes = block_modes(PLATE, terms=(7, 6, 4), elastic=4)
    assert_allclose(modes.frequency[:RIGID], 0.0)
    centre = displacement(modes, np.array(PLATE.size) / 2)[:, :RIGID]
    assert_allclose(np.sum(centre**2, axis=1), 1 / PLATE.mass, rtol=1e-9)


def test_gradients_are_those_of_the_displacement() -> None:
    """Central differences over 0.1 mm."""
    modes = block_modes(PLATE, terms=(7, 6, 4), elastic=10)
    place, step = np.array([0.11, 0.07, 0.05]), 1e-4
    for axis, unit in enumerate(np.eye(3)):
        ahead, before = (
            displacement(modes, place + sign * step * unit) for sign in (1, -1)
        )
        found = displacement_gradient(modes, place)[axis]
        assert_allclose((ahead - before) / 2 / step, found, atol=1e-5)
