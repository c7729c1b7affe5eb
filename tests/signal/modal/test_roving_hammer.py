# SPDX-License-Identifier: MIT
"""One accelerometer and a roving hammer: references are the smaller side."""

import numpy as np
import pytest
from hammered_structures import (
    Bench,
    Measured,
    Strike,
    Structure,
    pole_bound,
    prescribed,
    strike,
)

from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.modal.modes import ModalSettings, identify_modes, references_last

SETTINGS = ModalSettings(highest_order=30)


def chain_of_six(rng: np.random.Generator) -> Structure:
    """Return six modes of 0.6 to 2 %."""
    frequency = np.array([41.0, 88.0, 95.0, 160.0, 230.0, 310.0])
    return prescribed(frequency, rng.uniform(0.006, 0.02, 6), 8, rng)


def roved() -> tuple[Structure, Measured]:
    """Hit eight points with the accelerometer at the third."""
    rng = np.random.default_rng(5)
    structure = chain_of_six(rng)
    strikes = [Strike(point, (2,), ("a1",)) for point in range(8)]
    return structure, strike(structure, strikes, Bench(hits=2), rng)


def test_the_smaller_side_is_the_references() -> None:
    """Twelve inputs and one output become one column; 3 x 2 stays as it is."""
    wide, tall = np.zeros((1, 12, 5), complex), np.zeros((3, 2, 5), complex)
    assert references_last(wide).shape == (12, 1, 5)
    assert references_last(tall).shape == (3, 2, 5)


def test_a_roving_hammer_finds_every_mode_and_its_damping() -> None:
    """Six of six, damping within 0.5 %, participation in the place of shapes."""
    structure, measured = roved()
    truth, bound = pole_bound(structure, measured)
    assert np.all(bound[:, 1] < 0.1 * -2.0 * truth.real)
    model = identify_modes(estimate_frf(measured.recordings), SETTINGS).model
    assert model.natural_frequency == pytest.approx(
        np.abs(truth) / (2.0 * np.pi), rel=1e-4
    )
    assert model.damping_ratio == pytest.approx(-truth.real / np.abs(truth), rel=5e-3)
    assert model.shapes.shape == (6, 1)
    assert model.participation.shape == (6, 8)
    drive = structure.poles()[2]
    overlap = np.abs(np.sum(drive.conj() * model.participation, axis=1))
    size = np.linalg.norm(drive, axis=1) * np.linalg.norm(model.participation, axis=1)
    assert np.all(overlap > 0.99 * size)
