"""Modes that are missing, spurious or swapped, moduli and supports that are off."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.hypotheses import (
    HypothesisKind,
    HypothesisSettings,
    hypotheses_of,
)
from jointbench.analysis.structures.identification.hypothesis_evidence import weigh_end
from jointbench.analysis.structures.identification.hypothesis_search import (
    POOR_FIT,
    HypothesisSearch,
    posed,
)
from jointbench.analysis.structures.identification.stiffness_descent import descend
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.identification.surveyed_starts import survey_starts
from jointbench.analysis.structures.identification.weigh_hypotheses import (
    StateHypotheses,
    weigh_hypotheses,
)
from jointbench.analysis.structures.reduction.body_moduli import with_moduli
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    predict_modes,
)
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

RELATIVE_SD = 0.001


def frequencies(
    model: ReducedModel, truth: JointValues, *, missing: int | None = None
) -> StructureEvidence:
    """Return the seven lowest frequencies with noise, one of them left out."""
    random = np.random.default_rng(4)
    exact = predict_modes(model, truth).natural_frequency[:7]
    noisy = np.sort(exact * (1.0 + RELATIVE_SD * random.standard_normal(7)))
    if missing is not None:
        noisy = np.delete(noisy, missing)
    modes = MeasuredModes(noisy, RELATIVE_SD * noisy)
    none = np.zeros((0, model.size))
    return StructureEvidence("rig", modes, None, none, none)


def weigh(model: ReducedModel, evidence: StructureEvidence) -> StateHypotheses:
    """Weigh with a light search."""
    settings = HypothesisSettings(starts=2, surveyed=80)
    return weigh_hypotheses(model, [evidence], settings=settings)[0]


def test_a_missing_mode_is_named_and_the_joint_is_right_all_the_same(
    reduced: ReducedModel, truth: JointValues
) -> None:
    """Three stiffnesses from six of seven frequencies, the third left out."""
    found = weigh(reduced, frequencies(reduced, truth, missing=2))
    assert any(
        one.kind is HypothesisKind.MISSING and "mode 3 of the model" in one.text
        for one in found.surviving
    )
    for one, true in zip(found.parameters, truth.stiffness, strict=True):
        assert one.interval[0] is not None
        assert one.interval[1] is not None
        wide = np.log(one.interval[1] / one.interval[0])
        assert abs(np.log(one.value / true)) < wide


def test_a_search_that_stopped_short_goes_on_until_something_fits(
    reduced: ReducedModel, truth: JointValues
) -> None:
    """It had ended 20 % from the joint, and 20 standard deviations from the modes."""
    settings = HypothesisSettings()
    measured = frequencies(reduced, truth, missing=2)
    cases = hypotheses_of(reduced, measured, np.arange(6), {}, settings)
    right = [one for one in cases if one.modes == (2,) and one.left_out == 0.0]
    problem = posed(right[0], None, None)
    away = np.log(truth.stiffness) + np.array([0.2, -0.2, 0.2])
    stopped = descend(problem, away, fixed=range(problem.size))
    assert stopped.chi2 > 400.0
    search = HypothesisSearch(None, None, {}, survey_starts(problem, 1, 0), settings)
    tried = [(problem, [weigh_end(problem, stopped, settings.largest_noise)])]
    found = search.further(right, tried)
    assert min(one.end.chi2 for one in found[0][1]) < chi2_limit(POOR_FIT, 6)


def test_modes_as_measured_need_no_other_hypothesis(
    reduced: ReducedModel, truth: JointValues
) -> None:
    """Seven frequencies that fit: no mode is missing, spurious or swapped."""
    found = weigh(reduced, frequencies(reduced, truth))
    assert found.hypotheses[0].kind is HypothesisKind.AS_MEASURED
    assert found.hypotheses[0].probability > 0.9
    total = sum(one.probability for one in found.hypotheses)
    assert total == pytest.approx(1.0)


def test_a_frequency_of_something_else_is_named(
    reduced: ReducedModel, truth: JointValues
) -> None:
    """One frequency between the third and the fourth belongs to no mode."""
    plain = frequencies(reduced, truth)
    assert plain.modes is not None
    measured = plain.modes.natural_frequency
    extra = float(0.6 * measured[2] + 0.4 * measured[3])
    whole = np.sort(np.append(measured[:6], extra))
    modes = MeasuredModes(whole, RELATIVE_SD * whole)
    found = weigh(reduced, replace(plain, modes=modes))
    assert any(
        one.kind is HypothesisKind.SPURIOUS and f"{extra:.5g} Hz" in one.text
        for one in found.surviving
    )


def test_a_modulus_that_is_off_is_found_with_its_factor(
    reduced: ReducedModel, truth: JointValues
) -> None:
    """The lower plate is 15 % less stiff than the model states.

    The plates are alike, so frequencies alone leave open which of them it is.
    """
    lower, upper = (one.name for one in reduced.residual.components[:2])
    softer = with_moduli(reduced, [lower])
    values = JointValues(
        np.append(truth.stiffness, 0.85), np.append(truth.damping, 0.0)
    )
    first, second, *rest = weigh(reduced, frequencies(softer, values)).hypotheses
    assert first.kind is second.kind is HypothesisKind.MODULUS
    factors = {one.name: one.value for two in (first, second) for one in two.parameters}
    for body in (lower, upper):
        assert factors[f"{body}.modulus"] == pytest.approx(0.85, abs=0.03)
    assert first.probability == pytest.approx(second.probability, rel=1e-3)
    assert sum(one.probability for one in rest) < 1e-6


def test_swapped_modes_need_more_than_frequencies(
    reduced: ReducedModel, rows: FloatArray, truth: JointValues
) -> None:
    """Ascending order is the best pairing of frequencies; with damping it is not."""
    plain = frequencies(reduced, truth)
    assert plain.modes is not None
    settings, order = HypothesisSettings(), np.arange(7)
    kinds = [one.kind for one in hypotheses_of(reduced, plain, order, {}, settings)]
    assert HypothesisKind.SWAPPED not in kinds
    ratio = np.full(7, 0.01)
    damped = replace(plain.modes, damping_ratio=ratio, damping_ratio_sd=0.05 * ratio)
    more = replace(plain, modes=damped, outputs=rows)
    swapped = [
        one
        for one in hypotheses_of(reduced, more, order, {}, settings)
        if one.kind is HypothesisKind.SWAPPED
    ]
    assert [one.modes for one in swapped] == [(at, at + 1) for at in range(6)]


def test_no_mode_is_missing_where_the_model_predicts_no_more(
    reduced: ReducedModel, truth: JointValues
) -> None:
    """As many measured as predicted modes: there is none to leave out."""
    plain, settings = frequencies(reduced, truth), HypothesisSettings()
    order = np.array([1, 0, 2, 3, 4, 5, 6])
    for predicted, missing in ((7, 0), (8, 7)):
        kinds = [
            one.kind
            for one in hypotheses_of(
                reduced, plain, order, {}, settings, predicted=predicted
            )
        ]
        assert kinds.count(HypothesisKind.MISSING) == missing
