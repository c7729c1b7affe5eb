"""Masses of sensors as unknowns of an identification."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.identify_structure import (
    StructureSearch,
    identify_structure,
)
from jointbench.analysis.structures.identification.sensor_masses import (
    SensorMasses,
    sensor_masses,
    structure_with_masses,
    with_mass_factors,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.matrices.parts import PointMass
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    solve_reduced,
)

SENSORS = {
    "a1": PointMass("lower", (0.0, 0.0, 0.0), 0.1),
    "a3": PointMass("upper", (0.05, 0.05, 0.1), 0.2),
}
FACTOR = 1.5


@pytest.fixture(scope="module")
def masses(plates: Structure, reduced: ReducedModel) -> SensorMasses:
    """One of two sensors has an unknown mass."""
    return sensor_masses(plates, reduced, SENSORS, {"a3": 0.4})


@pytest.fixture(scope="module")
def heavier(
    plates: Structure, masses: SensorMasses, truth: JointValues
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Frequencies of the whole mesh with the heavier sensor [Hz]."""
    whole = structure_with_masses(plates, masses, [FACTOR])
    return solve_full(whole, truth.stiffness, 14).natural_frequency


def test_a_heavier_sensor_acts_as_on_the_whole_mesh(
    reduced: ReducedModel,
    masses: SensorMasses,
    truth: JointValues,
    heavier: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
) -> None:
    """Six rigid motions stay; elastic frequencies agree and have moved."""
    model, turn = with_mass_factors(reduced, masses, np.array([FACTOR]))
    found = solve_reduced(model, truth.stiffness)
    assert found.rigid == 6
    assert found.natural_frequency[6:] == pytest.approx(heavier[6:], rel=1e-4)
    plain = solve_reduced(reduced, truth.stiffness).natural_frequency
    assert np.abs(plain[6:] / heavier[6:] - 1.0).max() > 2e-3
    assert turn == pytest.approx(np.triu(turn))


def test_joints_and_a_mass_are_found_together_over_two_states(
    plates: Structure,
    reduced: ReducedModel,
    masses: SensorMasses,
    truth: JointValues,
    heavier: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
) -> None:
    """Two torques, one sensor: without its mass the fit is inconsistent."""
    none = np.zeros((0, reduced.size))
    softer = structure_with_masses(plates, masses, [FACTOR])
    level = solve_full(softer, 0.5 * truth.stiffness, 14).natural_frequency
    evidence = [
        StructureEvidence(
            label, MeasuredModes(one[6:], 2e-4 * one[6:]), None, none, none
        )
        for label, one in (("tight", heavier), ("loose", level))
    ]
    search = StructureSearch(starts=6, profiles=False, masses=masses)
    found = identify_structure(reduced, evidence, search=search, structure=plates)
    factor = found.parameter("a3.mass")
    assert factor.unit == ""
    assert factor.value == pytest.approx(FACTOR, abs=3.0 * (factor.sd or 0.0))
    assert 0.0 < (factor.sd or 0.0) < 0.1
    for label, scale in (("tight", 1.0), ("loose", 0.5)):
        own = found.parameter(f"{label}:joint.normal_stiffness")
        assert own.value == pytest.approx(scale * truth.stiffness[0], rel=0.02)
    assert all(one.agrees for one in found.full_check)
    fixed = StructureSearch(starts=6, profiles=False)
    wrong = identify_structure(reduced, evidence, search=fixed)
    assert wrong.solutions[0].chi2 > 20.0 + found.solutions[0].chi2


def test_a_sensor_without_a_mass_is_refused(
    plates: Structure, reduced: ReducedModel
) -> None:
    """The name of another channel."""
    with pytest.raises(UsageError, match="sensors with a mass are"):
        sensor_masses(plates, reduced, SENSORS, {"a2": 0.1})
