# SPDX-License-Identifier: MIT
"""MAC, collinearity, deviation, indicators and mass from closed forms."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import ChannelMissing, ShapeError
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.frf.mode_indicators import (
    cmif,
    mode_indicator,
    multivariate_mode_indicator,
)
from jointbench.signal.modal.modal_mass import driving_points, mass_normalise
from jointbench.signal.modal.modal_model import ModalModel, split_residues
from jointbench.signal.modal.shape_checks import check_shapes, mac_matrix, real_shapes

LINES = np.arange(50.0, 600.0, 0.25)
SHAPES = np.array([[1.0, 0.8, 0.3], [0.9, -0.5, 0.7]])


def test_mac_is_the_squared_cosine_and_blind_to_phase_and_size() -> None:
    """Two vectors at 60 degrees: 1/4, whatever they are multiplied with."""
    one = np.array([[1.0, 0.0]], complex)
    other = np.array([[0.5, np.sqrt(0.75)]], complex) * 3j
    assert mac_matrix(one, other)[0, 0] == pytest.approx(0.25)
    assert mac_matrix(other, other)[0, 0] == pytest.approx(1.0)
    assert mac_matrix(one, np.zeros((1, 2), complex))[0, 0] == 0.0


def test_shapes_of_different_length_are_refused() -> None:
    """Two outputs against three."""
    with pytest.raises(ShapeError, match="same outputs"):
        mac_matrix(np.ones((1, 2), complex), np.ones((1, 3), complex))


def test_a_real_shape_turned_by_any_phase_is_still_real() -> None:
    """MPC 1, MPD 0, and the phase comes back."""
    checks = check_shapes(SHAPES * np.exp(0.4j))
    assert np.allclose(checks.collinearity, 1.0)
    assert np.allclose(checks.deviation, 0.0, atol=1e-7)
    assert np.allclose(checks.phase, 0.4)


def test_a_travelling_wave_has_no_collinearity() -> None:
    """Components on a circle: MPC 0."""
    wave = np.exp(2j * np.pi * np.arange(8) / 8)[None]
    assert check_shapes(wave).collinearity[0] == pytest.approx(0.0, abs=1e-12)


def test_deviation_is_the_mean_angle_off_the_line() -> None:
    """Equal components at +0.2 and -0.2 rad: 0.2; MPC cos^2 of twice that."""
    checks = check_shapes(np.exp(1j * np.array([[0.2, -0.2]])))
    assert checks.deviation[0] == pytest.approx(0.2)
    assert checks.collinearity[0] == pytest.approx(np.cos(0.4) ** 2)


def test_the_nearest_real_shape_of_a_real_shape_is_itself() -> None:
    """Up to the phase, with the largest component 1."""
    assert np.allclose(real_shapes(SHAPES[:1] * 2.0 * np.exp(2.1j)), SHAPES[:1])


def two_modes(structure: Callable[..., Any], frequency: tuple[float, float]) -> Frf:
    """Three outputs, two of them driven, mass-normalised shapes SHAPES."""
    constant = np.einsum("ro,ri->roi", SHAPES, SHAPES[:, :2])
    truth = structure(frequency, (0.01, 0.01), constant)
    return Frf(LINES, truth.response(LINES, 2), FrfKind.ACCELERANCE)


def test_cmif_counts_the_modes_on_one_line(structure: Callable[..., Any]) -> None:
    """Two modes at one frequency: the second value peaks there as well."""
    values = cmif(two_modes(structure, (300.0, 300.0)))
    for row in values:
        assert LINES[np.argmax(row)] == pytest.approx(300.0, abs=1.0)
    apart = cmif(two_modes(structure, (200.0, 400.0)))
    line = int(np.argmin(np.abs(LINES - 200.0)))
    assert apart[1, line] < 0.2 * apart[0, line]


@pytest.mark.parametrize("kind", list(FrfKind))
def test_the_indicator_dips_at_a_mode_whatever_was_measured(
    structure: Callable[..., Any], kind: FrfKind
) -> None:
    """One mode: below 0.01 at 300 Hz, above 0.95 off it."""
    response = structure((300.0,), (0.01,)).response(LINES, kind.derivatives)
    indicator = mode_indicator(Frf(LINES, response, kind))[0]
    assert LINES[np.argmin(indicator)] == pytest.approx(300.0, abs=0.5)
    assert indicator.min() < 0.01
    assert indicator[LINES < 250.0].min() > 0.95


def test_the_second_multivariate_indicator_dips_for_a_repeated_mode(
    structure: Callable[..., Any],
) -> None:
    """Both below 0.01 at 300 Hz; of modes apart, only the first."""
    both = multivariate_mode_indicator(two_modes(structure, (300.0, 300.0)))
    line = int(np.argmin(np.abs(LINES - 300.0)))
    assert np.all(both[:, line] < 0.01)
    apart = multivariate_mode_indicator(two_modes(structure, (300.0, 500.0)))
    assert apart[0, line] < 0.01
    assert apart[1, line] > 0.5


def model(scale: complex = 1.0) -> ModalModel:
    """Two real modes of unit modal mass at three outputs, driven at the second."""
    frequency, damping = np.array([100.0, 250.0]), np.array([0.01, 0.02])
    damped = 2.0 * np.pi * frequency * np.sqrt(1.0 - damping**2)
    residues = np.einsum("ro,ri->roi", SHAPES, SHAPES[:, 1:2]) / 2j
    residues = scale * residues / damped[:, None, None]
    shapes, participation = split_residues(residues)
    return ModalModel(
        natural_frequency=frequency,
        frequency_sd=np.full(2, 0.1),
        damping_ratio=damping,
        damping_ratio_sd=np.full(2, 1e-3),
        residues=residues,
        residues_sd=np.zeros_like(residues),
        shapes_sd=np.zeros_like(shapes),
        residual_ratio=np.ones(2),
        shapes=shapes,
        participation=participation,
        significance=np.ones(2),
        stable_orders=np.ones(2, np.int64),
        by_hand=np.zeros(2, bool),
        outputs=("a@1", "b@2", "c@3"),
        inputs=("2",),
    )


def test_the_driving_point_gives_shapes_of_unit_mass() -> None:
    """The shapes that the residues were made of, up to their sign."""
    found = mass_normalise(model())
    sign = np.sign((found.shapes.real * SHAPES).sum(axis=1))[:, None]
    assert np.allclose(found.shapes, sign * SHAPES)
    assert np.allclose(found.modal_mass, 1.0 / np.max(np.abs(SHAPES), axis=1) ** 2)
    assert np.allclose(found.phase, 0.0)
    assert found.driving_points == ("2", "2")


def test_a_sensor_mounted_the_wrong_way_round_shows_in_the_phase() -> None:
    """Sign reversed: 180 degrees."""
    assert np.allclose(np.abs(mass_normalise(model(-1.0)).phase), np.pi)


def test_without_a_driving_point_there_is_no_mass() -> None:
    """The message states the remedy."""
    from dataclasses import replace

    with pytest.raises(ChannelMissing, match="hit once next to a sensor"):
        mass_normalise(replace(model(), inputs=("7",)))


def test_driving_points_are_found_by_the_name_of_the_point() -> None:
    """Labels are channel@point."""
    assert driving_points(("a@1", "b@2"), ("2", "9")) == ((1, 0),)
