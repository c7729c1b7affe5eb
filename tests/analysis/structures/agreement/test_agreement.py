"""Measured and computed modes beside each other, and coordinates in doubt."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.analysis.structures.agreement.paired_modes import (
    ModeSet,
    comac,
    enhanced_comac,
    frac,
    pair_mode_sets,
    unpaired,
)
from jointbench.analysis.structures.agreement.suspect_coordinates import (
    ShapesAtPlaces,
    find_suspects,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.mounted_sensors import (
    MountedSensor,
    readout,
)
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    modal_state,
)
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
NOISE = 0.05


@pytest.fixture(scope="module")
def places(
    plates: Structure,
    reduced: ReducedModel,
    sensors: tuple[MountedSensor, ...],
    truth: JointValues,
) -> ShapesAtPlaces:
    """Shapes of six modes at five sensors, two of them struck."""
    state = modal_state(reduced, truth.stiffness)
    vector = state.shapes[:, state.rigid : state.rigid + 6]
    along = [replace(one, direction=axis) for one in sensors for axis in AXES]
    outputs = (readout(plates, reduced, sensors) @ vector).T
    axes = (readout(plates, reduced, along) @ vector).T.reshape(6, -1, 3)
    names = tuple(one.name for one in sensors)
    lead = np.array([int(np.argmax(np.abs(one.direction))) for one in sensors])
    frequency = np.sqrt(state.eigenvalue[state.rigid : state.rigid + 6]) / (2 * np.pi)
    return ShapesAtPlaces(
        frequency, outputs, outputs[:, [0, 2]], axes, lead, (names, ("1", "2"))
    )


def measured_modes(places: ShapesAtPlaces, seed: int) -> ModeSet:
    """Modes as measured: constants off by 5 %, frequencies by 0.5 %."""
    rng = np.random.default_rng(seed)
    exact = places.outputs[:, :, None] * places.inputs[:, None, :]
    scale = rng.uniform(0.9, 1.1, (exact.shape[0], 1, 1))
    size = np.abs(exact).max(axis=(1, 2), keepdims=True)
    noisy = exact * scale + NOISE * size * rng.normal(size=exact.shape)
    frequency = places.frequency * (1.0 + 0.005 * rng.normal(size=6))
    damping = np.full(6, 0.01)
    deviation = np.broadcast_to(0.01 * size, exact.shape).copy()
    shapes = places.outputs.astype(complex)
    return ModeSet(frequency, damping, damping, damping, shapes, noisy, deviation)


def spoilt(modes: ModeSet, signs: np.ndarray) -> ModeSet:
    """Return modes whose constants have other signs, shape of outputs and inputs."""
    return replace(modes, constants=modes.constants * signs)


def test_right_labels_are_not_suspected(places: ShapesAtPlaces) -> None:
    """None of forty draws with errors of 5 %."""
    for seed in range(40):
        assert find_suspects(measured_modes(places, seed), places) == ()


def test_a_wrong_sign_is_named(places: ShapesAtPlaces) -> None:
    """Of an output, and of a hit point, in every draw."""
    for seed in range(5):
        modes = measured_modes(places, seed)
        output, hit = np.ones((5, 2)), np.ones((5, 2))
        output[3], hit[:, 1] = -1.0, -1.0
        found = find_suspects(spoilt(modes, output), places)
        assert [one.text for one in found] == ["output a4 has the wrong sign"]
        found = find_suspects(spoilt(modes, hit), places)
        assert found[0].text == "hit 2 has the wrong sign"


def test_exchanged_labels_and_a_wrong_axis_are_named(places: ShapesAtPlaces) -> None:
    """Two sensors on each other's channels; one glued along x in place of z."""
    modes = measured_modes(places, 1)
    exchanged = replace(modes, constants=modes.constants[:, [4, 1, 2, 3, 0]])
    found = find_suspects(exchanged, places)
    assert found[0].text == "outputs a1 and a5 are exchanged"
    assert found[0].residual_after < 0.3 * found[0].residual_before
    turned = replace(places, outputs=places.outputs.copy())
    turned.outputs[:, 4] = places.axes[:, 4, 0]
    found = find_suspects(measured_modes(turned, 2), places)
    assert found[0].text == "output a5 measures along x"


def test_two_faults_are_named_one_after_the_other(places: ShapesAtPlaces) -> None:
    """Two signs."""
    signs = np.ones((5, 2))
    signs[[1, 3]] = -1.0
    found = find_suspects(spoilt(measured_modes(places, 3), signs), places)
    assert {one.names for one in found} == {("a2",), ("a4",)}


def mode_set(frequency: list[float], shapes: np.ndarray) -> ModeSet:
    """Modes with a standard deviation of 0.1 % in frequency and 1e-4 in damping."""
    value = np.array(frequency)
    none = np.zeros((value.size, shapes.shape[1], 1))
    return ModeSet(
        value,
        1e-3 * value,
        np.full(value.size, 0.01),
        np.full(value.size, 1e-4),
        shapes.astype(complex),
        none,
        none,
    )


def test_modes_are_paired_by_shape_and_their_difference_has_an_interval() -> None:
    """Two that cross, one that is missing; 0.5 % is 3.5 sd of both."""
    shapes = np.eye(4)[:3] + 0.05
    measured = mode_set([100.0, 102.0, 300.0], shapes)
    computed = mode_set([100.0, 102.51, 500.0], np.eye(4)[[1, 0, 3]] + 0.05)
    pairs, likeness = pair_mode_sets(measured, computed)
    assert [(one.measured, one.computed) for one in pairs] == [(0, 1), (1, 0)]
    assert likeness.shape == (3, 3)
    assert unpaired(pairs, 3, "measured").tolist() == [2]
    assert_allclose(pairs[0].frequency, 0.0251, rtol=1e-9)
    low, high = pairs[0].frequency_interval
    assert_allclose(high - low, 2 * 1.96e-3 * np.hypot(1.0, 1.0251), rtol=1e-9)


def test_criteria_feel_what_they_are_said_to_feel() -> None:
    """CoMAC not the sign, ECOMAC the sign, FRAC the shape of the curve."""
    rng = np.random.default_rng(1)
    shapes = rng.normal(size=(4, 6)).astype(complex)
    turned = shapes.copy()
    turned[:, 2] *= -1.0
    assert_allclose(comac(shapes, 3.0 * shapes), 1.0)
    assert_allclose(comac(shapes, turned), 1.0)
    assert int(np.argmax(enhanced_comac(shapes, turned))) == 2
    assert_allclose(enhanced_comac(shapes, -2.0 * shapes), 0.0, atol=1e-12)
    frf = rng.normal(size=(2, 1, 50)) + 1j * rng.normal(size=(2, 1, 50))
    assert_allclose(frac(frf, 2j * frf), 1.0)
    assert np.all(frac(frf, frf[:, :, ::-1]) < 0.5)
