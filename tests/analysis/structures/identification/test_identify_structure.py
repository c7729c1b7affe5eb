"""Joints from frequencies, modes and FRFs of simulated plates."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.frf_gains import FrfGains
from jointbench.analysis.structures.identification.identify_structure import (
    StructureSearch,
    identify_structure,
)
from jointbench.analysis.structures.identification.joint_result import structure_json
from jointbench.analysis.structures.identification.stiffness_descent import descend
from jointbench.analysis.structures.identification.stiffness_problem import (
    pose_problem,
    residuals,
    states_apart,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    predict_modes,
)
from jointbench.analysis.structures.reduction.predict_response import predict_frf
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.signal.frf.frf import Frf, FrfKind


def modal_evidence(
    model: ReducedModel, rows: FloatArray, values: JointValues, label: str = "rig"
) -> StructureEvidence:
    """Return exact modes with the uncertainty of a good hammer test."""
    found = predict_modes(model, values, rows)
    size = np.abs(found.shapes).max(axis=1, keepdims=True)
    measured = MeasuredModes(
        natural_frequency=found.natural_frequency,
        frequency_sd=0.002 * found.natural_frequency,
        damping_ratio=found.damping_ratio,
        damping_ratio_sd=0.05 * found.damping_ratio,
        shapes=found.shapes.astype(complex),
        shape_sd=np.broadcast_to(0.02 * size, found.shapes.shape),
        outputs=tuple(f"a{at + 1}" for at in range(rows.shape[0])),
    )
    return StructureEvidence(label, measured, None, rows, rows[:1])


def frf_evidence(
    model: ReducedModel, rows: FloatArray, values: JointValues
) -> StructureEvidence:
    """Return accelerances with 1 % noise."""
    frequency = np.linspace(300.0, 2000.0, 41)
    laplace = 2j * np.pi * frequency
    exact = predict_frf(model, values, laplace, rows, rows[:1]).response * laplace**2
    sd = 0.01 * np.sqrt((np.abs(exact) ** 2).mean(axis=2, keepdims=True))
    random = np.random.default_rng(5)
    noise = random.standard_normal((2, *exact.shape)) / np.sqrt(2)
    frf = Frf(
        frequency=frequency,
        response=exact + sd * (noise[0] + 1j * noise[1]),
        kind=FrfKind.ACCELERANCE,
        variance=np.broadcast_to(sd**2, exact.shape),
    )
    return StructureEvidence("rig", None, frf, rows, rows[:1])


def test_sensitivities_agree_with_differences(
    reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """Frequencies, damping, shapes and FRFs, by every stiffness and damping."""
    for evidence, limit in (
        (modal_evidence(reduced, rows, truth), 2e-3),
        (frf_evidence(reduced, rows, truth), 2e-3),
    ):
        problem = pose_problem(reduced, [evidence])
        at = np.log(np.concatenate([truth.stiffness, truth.damping])) + 0.02
        _, slopes = residuals(problem, at)
        for column in range(problem.size):
            step = np.zeros(problem.size)
            step[column] = 1e-5
            ahead, _ = residuals(problem, at + step)
            below, _ = residuals(problem, at - step)
            numeric = (ahead - below) / 2e-5
            scale = np.abs(numeric).max()
            assert np.abs(numeric - slopes[:, column]).max() < limit * scale


def test_modes_with_shapes_and_damping_give_all_six_parameters(
    plates: Structure, reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """Exact data: the truth to rounding, checked by one full solve."""
    evidence = modal_evidence(reduced, rows, truth)
    found = identify_structure(
        reduced,
        [evidence],
        search=StructureSearch(starts=6, profiles=False),
        structure=plates,
    )
    wanted = np.concatenate([truth.stiffness, truth.damping])
    np.testing.assert_allclose([p.value for p in found.parameters], wanted, rtol=1e-6)
    assert all(one.identifiable for one in found.parameters)
    assert found.full_check[0].agrees


def test_frfs_give_all_six_parameters_within_their_uncertainty(
    reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """One per cent of noise: each within four standard deviations."""
    evidence = frf_evidence(reduced, rows, truth)
    found = identify_structure(
        reduced, [evidence], search=StructureSearch(starts=4, profiles=False)
    )
    wanted = np.concatenate([truth.stiffness, truth.damping])
    for one, true in zip(found.parameters, wanted, strict=True):
        assert one.identifiable
        assert one.sd is not None
        assert one.sd < 0.01 * true
        assert abs(one.value - true) < 4 * one.sd


def test_gains_that_are_off_do_not_move_the_joint(
    reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """Each sensor 2 to 5 % off: within four standard deviations all the same."""
    plain = frf_evidence(reduced, rows, truth)
    assert plain.frf is not None
    gain = np.array([1.03, 0.98, 1.05, 0.97, 1.02])[:, None, None]
    off = replace(plain.frf, response=gain * plain.frf.response)
    evidence = replace(plain, frf=off, gains=FrfGains(gain_sd=0.04))
    problem = pose_problem(reduced, [evidence])
    wanted = np.log(np.concatenate([truth.stiffness, truth.damping]))
    end = descend(problem, wanted + 0.1)
    assert end.noise() < 1.5
    sd = np.sqrt(np.diag(end.covariance()))
    assert np.all(np.abs(end.unknowns - wanted) < 4 * sd)
    assert np.all(sd < 0.02)


def test_three_frequencies_leave_the_normal_stiffness_open(
    reduced: ReducedModel, truth: JointValues
) -> None:
    """Exact solutions over a decade, and the mode that would decide is named."""
    frequency = predict_modes(reduced, truth).natural_frequency[:3]
    none = np.zeros((0, reduced.size))
    measured = MeasuredModes(frequency, 0.002 * frequency)
    evidence = StructureEvidence("rig", measured, None, none, none)
    found = identify_structure(
        reduced, [evidence], search=StructureSearch(profiles=False)
    )
    normal = found.parameter("joint.normal_stiffness")
    assert not normal.identifiable
    assert "mode" in normal.reason
    exact = [
        one.parameters["joint.normal_stiffness"]
        for one in found.solutions
        if one.chi2 < 1e-10
    ]
    assert len(exact) >= 3
    # From the softest joint that keeps the order of the modes to the bound of the box.
    assert max(exact) > 1e10
    assert min(exact) < 2.5e8


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_what_is_open_does_not_hang_on_where_chance_began(
    reduced: ReducedModel, truth: JointValues, seed: int
) -> None:
    """Chance starts, or rounding, change nothing of the intervals and the verdicts."""
    frequency = predict_modes(reduced, truth).natural_frequency[:3]
    none = np.zeros((0, reduced.size))
    # Rounding, as another number of threads makes it.
    frequency = frequency * (1.0 + 1e-13 * np.array([1.0, -1.0, 1.0]) * seed)
    evidence = StructureEvidence(
        "rig", MeasuredModes(frequency, 0.002 * frequency), None, none, none
    )
    found = identify_structure(
        reduced,
        [evidence],
        search=StructureSearch(profiles=False, seed=seed, starts=24),
    )
    intervals = [one.interval for one in found.parameters]
    wanted = [(2.2e8, None), (8.93e7, 3.9e8), (8.5e7, 2.01e8)]
    for (low, high), (soft, stiff) in zip(intervals, wanted, strict=True):
        assert low == pytest.approx(soft, rel=0.03)
        assert high is None if stiff is None else high == pytest.approx(stiff, rel=0.03)
    assert found.parameters[0].value == pytest.approx(4.16e8, rel=0.01)
    assert "exceeds 100 %" in found.parameters[0].reason


def test_an_open_parameter_has_no_sd_and_the_range_of_all_admissible(
    reduced: ReducedModel, truth: JointValues
) -> None:
    """In the JSON too; what is determined keeps its sd and its profile's interval."""
    frequency = predict_modes(reduced, truth).natural_frequency[:3]
    none = np.zeros((0, reduced.size))
    evidence = StructureEvidence(
        "rig", MeasuredModes(frequency, 0.002 * frequency), None, none, none
    )
    found = identify_structure(reduced, [evidence], search=StructureSearch(starts=16))
    reported = structure_json(found, reduced.names)["parameters"]
    for one in found.parameters:
        assert not one.identifiable
        low, high = one.interval
        standing = [s.parameters[one.name] for s in found.solutions if s.admissible]
        assert low is not None
        assert low < min(standing)
        assert high is None or max(standing) < high
        assert reported[one.name]["sd"] is None
        assert reported[one.name]["interval_95"] == [low, high]
    known = JointValues(np.array([6e8, 1.0, 1.0]), np.zeros(3))
    sure = identify_structure(
        reduced,
        [evidence],
        known=known,
        sought=["joint.tangential_1", "joint.tangential_2"],
        search=StructureSearch(starts=16),
    )
    for one in sure.parameters:
        profile = sure.profiles[one.name]
        if one.identifiable:
            assert one.interval == (profile.low, profile.high)
            assert one.sd is not None


def test_swapped_modes_are_paired_by_shape(
    reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """The search passes joints whose modes come in another order."""
    evidence = modal_evidence(reduced, rows, truth)
    other = JointValues(truth.stiffness[[0, 2, 1]], truth.damping)
    problem = pose_problem(reduced, [evidence])
    away, _ = residuals(
        problem, np.log(np.concatenate([other.stiffness, other.damping]))
    )
    at_truth, _ = residuals(
        problem, np.log(np.concatenate([truth.stiffness, truth.damping]))
    )
    assert np.abs(at_truth).max() < 1e-6
    assert np.abs(away).max() > 10.0
    found = identify_structure(
        reduced, [evidence], search=StructureSearch(starts=6, profiles=False)
    )
    assert found.solutions[0].chi2 < 1e-9


def test_several_torques_share_what_they_have_in_common(
    reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """Two states: own normal and first tangent, one second tangent for both."""
    tighter = replace(truth, stiffness=truth.stiffness * np.array([1.5, 2.0, 1.0]))
    evidence = [
        modal_evidence(reduced, rows, truth, "20 N m"),
        modal_evidence(reduced, rows, tighter, "50 N m"),
    ]
    problem = pose_problem(reduced, evidence, shared=["joint.tangential_2"])
    assert problem.size == 10
    found = identify_structure(
        reduced,
        evidence,
        shared=["joint.tangential_2"],
        search=StructureSearch(starts=4, profiles=False),
    )
    value = found.parameter("50 N m:joint.normal_stiffness").value
    assert value == pytest.approx(9e8, rel=1e-5)
    assert found.parameter("joint.tangential_2_stiffness").value == pytest.approx(2e8)


def test_states_that_share_nothing_are_found_as_if_alone(
    reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """Values and standard deviations of a state do not know of the other."""
    tighter = replace(truth, stiffness=truth.stiffness * np.array([1.5, 2.0, 1.2]))
    evidence = [
        modal_evidence(reduced, rows, truth, "20 N m"),
        modal_evidence(reduced, rows, tighter, "50 N m"),
    ]
    both = identify_structure(
        reduced, evidence, search=StructureSearch(starts=4, profiles=False)
    )
    alone = identify_structure(
        reduced, evidence[1:], search=StructureSearch(starts=4, profiles=False)
    )
    for one in alone.parameters:
        found = both.parameter(f"50 N m:{one.name}")
        assert found.value == pytest.approx(one.value, rel=1e-6)
        assert found.sd == pytest.approx(one.sd, rel=1e-5)
    problem = pose_problem(reduced, evidence)
    assert len(states_apart(problem)) == 2


def test_a_slack_joint_is_distinguished_from_a_tight_one(
    reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """A stiffness of zero in one direction predicts, and every frequency falls."""
    slack = replace(truth, stiffness=truth.stiffness * np.array([0.0, 1.0, 1.0]))
    tight = predict_modes(reduced, truth, rows).natural_frequency
    loose = predict_modes(reduced, slack, rows).natural_frequency
    assert np.all(np.isfinite(loose))
    assert loose.size < tight.size
    assert loose.max() <= tight.max()


def test_more_modes_than_the_model_predicts_are_refused(
    reduced: ReducedModel,
) -> None:
    """Eight elastic modes cannot stand for nine measured ones."""
    frequency = np.linspace(100.0, 900.0, 9)
    none = np.zeros((0, reduced.size))
    evidence = StructureEvidence(
        "rig", MeasuredModes(frequency, frequency), None, none, none
    )
    with pytest.raises(BadData, match="reduce for more modes"):
        identify_structure(reduced, [evidence], search=StructureSearch(starts=1))
