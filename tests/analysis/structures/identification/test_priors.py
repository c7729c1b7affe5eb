"""Moduli of bodies as unknowns with priors, beside the joints."""

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.identify_structure import (
    StructureSearch,
    identify_structure,
)
from jointbench.analysis.structures.identification.stiffness_problem import Prior
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import (
    scaled_structure,
    with_moduli,
)
from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.analysis.structures.reduction.mounted_sensors import (
    MountedSensor,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    frequency_bound,
)

FACTORS = {"lower": 1.04, "upper": 0.97}


def measured(
    plates: Structure,
    seen: FloatArray,
    rows: FloatArray,
    joints: FloatArray,
    label: str,
) -> StructureEvidence:
    """Return eight modes of the whole mesh with other moduli, at five sensors."""
    whole = scaled_structure(plates, FACTORS)
    found = solve_full(whole, joints, 14)
    frequency, shapes = found.natural_frequency[6:], found.shapes[6:] @ seen.T
    modes = MeasuredModes(
        frequency,
        2e-4 * frequency,
        shapes=shapes.astype(complex),
        shape_sd=np.full(shapes.shape, 0.01 * float(np.abs(shapes).max())),
        outputs=tuple(f"a{at}" for at in range(rows.shape[0])),
    )
    return StructureEvidence(label, modes, None, rows, np.zeros((0, rows.shape[1])))


def test_two_torques_give_the_moduli_that_they_share(
    plates: Structure,
    reduced: ReducedModel,
    rows: FloatArray,
    sensors: tuple[MountedSensor, ...],
    truth: JointValues,
) -> None:
    """Wrong by 4 % and 3 % in the table; joints and moduli are found, and checked."""
    model = with_moduli(reduced, ["lower", "upper"])
    soft: FloatArray = truth.stiffness / 4
    seen = sensor_rows(plates, sensors)
    evidence = [
        measured(plates, seen, rows, truth.stiffness, "tight"),
        measured(plates, seen, rows, soft, "loose"),
    ]
    priors = {f"{name}.modulus": Prior(1.0, 0.05) for name in FACTORS}
    found = identify_structure(
        model,
        evidence,
        priors=priors,
        search=StructureSearch(starts=4, profiles=False),
        structure=plates,
    )
    for name, factor in FACTORS.items():
        one = found.parameter(f"{name}.modulus")
        assert one.identifiable
        assert one.sd is not None
        assert abs(one.value - factor) < 3 * one.sd
        assert one.sd < 0.05
    for label, wanted in (("tight", truth.stiffness), ("loose", soft)):
        for name, value in zip(reduced.names, wanted, strict=True):
            one = found.parameter(f"{label}:{name}_stiffness")
            assert one.sd is not None
            assert abs(one.value - value) < 4 * one.sd
    assert all(one.agrees for one in found.full_check)


def test_the_bound_holds_with_other_moduli(
    plates: Structure, reduced: ReducedModel
) -> None:
    """A fifth softer and stiffer: below the bound, from the same basis."""
    model = with_moduli(reduced, ["lower", "upper"])
    joints = np.array([3e8, 5e7, 8e7])
    for low, high in ((0.8, 1.2), (1.0, 1.0)):
        values = np.array([*joints, low, high])
        found, bound = frequency_bound(model, values)
        whole = scaled_structure(plates, {"lower": low, "upper": high})
        full = solve_full(whole, joints, 14).natural_frequency
        assert np.count_nonzero(found == 0) == 6
        assert np.all(found - full <= bound + 1e-8 * full)
        assert np.all(found - full >= -1e-8 * full)


def test_a_prior_without_scatter_and_an_unknown_body_are_refused(
    reduced: ReducedModel,
) -> None:
    """One line each."""
    with pytest.raises(BadData, match="must be above zero"):
        Prior(1.0, 0.0)
    with pytest.raises(UsageError, match="no body 'bed' with a modulus"):
        with_moduli(reduced, ["bed"])
