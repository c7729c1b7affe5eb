"""A fault of a body that all states have in common."""

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.body_faults import (
    Joints,
    body_faults,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.matrices.parts import PointMass
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import with_moduli
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    solve_reduced,
)

MASSES = {"a3": PointMass("upper", (0.05, 0.05, 0.1), 0.1)}
SHARES = {"10 kN": 1.0, "30 kN": 2.5}
JOINTS = Joints(None, None, (), {})


def states(
    model: ReducedModel, stiffness: FloatArray, rows: FloatArray, factor: float
) -> list[StructureEvidence]:
    """Return the modes of two states with another modulus of the upper plate."""
    own, found = with_moduli(model, ["upper"]), []
    for label, share in SHARES.items():
        modes = solve_reduced(own, np.append(share * stiffness, factor))
        shapes = (rows @ modes.shapes[:, 6:14]).T.astype(complex)
        frequency = modes.natural_frequency[6:14]
        measured = MeasuredModes(
            frequency,
            5e-4 * frequency,
            shapes=shapes,
            shape_sd=np.full(shapes.shape, 0.005 * np.abs(shapes).max()),
            outputs=tuple("abcde"),
        )
        found.append(
            StructureEvidence(label, measured, None, rows, np.zeros((0, own.size)))
        )
    return found


def start(model: ReducedModel, stiffness: FloatArray) -> dict[str, float]:
    """Return the joint of both states by name, somewhat off."""
    return {
        f"{label}:{name}_stiffness": 1.05 * share * float(value)
        for label, share in SHARES.items()
        for name, value in zip(model.names, stiffness, strict=True)
    }


def test_a_stone_of_another_modulus_is_found_beside_masses_and_the_other_stone(
    plates: Structure, reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """12 % of the upper plate's modulus, to 0.5 %, far ahead of every other fault."""
    given = states(reduced, truth.stiffness, rows, 1.12)
    found = body_faults(
        *(plates, reduced, given, JOINTS),
        *(start(reduced, truth.stiffness), MASSES),
    )
    best, second = found[:2]
    assert (best.effect, best.site) == ("modulus", "body:upper")
    assert best.factor == pytest.approx(1.12, rel=5e-3)
    assert best.end.chi2 < 1.0 < 50.0 < second.end.chi2
    model, values = best.state("30 kN")
    assert model.names[-1] == "upper.modulus"
    assert values[:3] == pytest.approx(2.5 * truth.stiffness, rel=0.02)


def test_sound_plates_promise_nothing(
    plates: Structure, reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """No fault lowers chi2 by more than a few, and none is fitted."""
    given = states(reduced, truth.stiffness, rows, 1.0)
    begin = start(reduced, truth.stiffness)
    assert body_faults(*(plates, reduced, given, JOINTS), begin, MASSES) == ()
