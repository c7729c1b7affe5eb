# SPDX-License-Identifier: MIT
import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.lumped.identified import (
    IdentificationVerdict,
    identification_json,
)
from jointbench.analysis.lumped.identify_links import identify_links
from jointbench.analysis.lumped.lumped_model import Body, Link, LumpedModel
from jointbench.analysis.lumped.lumped_modes import solve_modes
from jointbench.analysis.lumped.measured_modes import MeasuredModes

M1, M2 = 9.3, 3.7


def chain(k0=0.0, kj=0.0, c0=0.0, cj=0.0, mass_sd=0.0):
    """Return ground - (k0, c0) - base - (kj, cj) - top."""
    return LumpedModel(
        (Body("base", M1, mass_sd), Body("top", M2, mass_sd)),
        (
            Link("ground", ("ground", "base"), k0, c0),
            Link("joint", ("base", "top"), kj, cj),
        ),
    )


TRUTH = chain(4.1e7, 1.6e7, 310.0, 95.0)
NAMES = ("ground.stiffness", "joint.stiffness", "ground.damping", "joint.damping")
VALUES = (4.1e7, 1.6e7, 310.0, 95.0)


@pytest.fixture(scope="module")
def precise():
    """Links identified from frequencies to 1e-7 and masses to 1 %."""
    return identify_links(chain(mass_sd=0.01), measure(TRUTH, frequency_sd=1e-7))


def measure(
    model, *, shapes=True, damping=True, seed=None, frequency_sd=2e-4, damping_sd=0.02
):
    """Return a model's modes, with noise of the stated size if a seed is given."""
    modes = solve_modes(model)
    random = np.random.default_rng(seed)
    noise = 0.0 if seed is None else 1.0
    frequency, ratio = modes.natural_frequency, modes.damping_ratio
    spread = np.full(modes.shapes.shape, 0.02 * np.abs(modes.shapes).max())
    error = random.standard_normal((2, *spread.shape)) * spread
    values = {
        "natural_frequency": frequency
        * (1 + noise * frequency_sd * random.standard_normal(frequency.size)),
        "frequency_sd": frequency_sd * frequency,
    }
    if damping:
        draws = random.standard_normal(ratio.size)
        values["damping_ratio"] = ratio * (1 + noise * damping_sd * draws)
        values["damping_ratio_sd"] = damping_sd * ratio
    if shapes:
        values["shapes"] = modes.shapes + noise * (error[0] + 1j * error[1])
        values["shape_sd"] = spread
        values["outputs"] = tuple(body.name for body in model.bodies)
    return MeasuredModes(**values)


def two_solutions(frequency):
    """Return both (k0, kj) of an undamped chain with these two frequencies.

    Sum and product of the roots of m1 m2 w^4 - (k0 m2 + kj (m1+m2)) w^2 + k0 kj = 0
    make a quadratic in kj.
    """
    first, second = (2 * np.pi * frequency) ** 2
    total, product = M1 * M2 * (first + second), M1 * M2 * first * second
    return [
        (product / kj, kj) for kj in np.sort(np.roots([M1 + M2, -total, M2 * product]))
    ]


def test_two_frequencies_of_two_bodies_have_the_two_solutions_of_the_quadratic():
    """Both are found from nothing but the masses, and neither is preferred."""
    measured = measure(chain(4.1e7, 1.6e7), shapes=False, damping=False)
    result = identify_links(chain(), measured)
    wanted = two_solutions(measured.natural_frequency)
    found = sorted(
        (one.parameters["joint.stiffness"], one.parameters["ground.stiffness"])
        for one in result.solutions
    )
    assert_allclose(found, [(kj, k0) for k0, kj in wanted], rtol=1e-9)
    assert result.verdict is IdentificationVerdict.AMBIGUOUS
    assert all(one.admissible for one in result.solutions)
    assert not any(one.identifiable for one in result.parameters)
    assert "mode shapes" in result.reasons[0]


def test_mode_shapes_choose_between_the_two_solutions():
    """The other one stays in the list, with a chi2 that rules it out."""
    result = identify_links(chain(), measure(TRUTH))
    assert result.verdict is IdentificationVerdict.DETERMINED
    assert_allclose([one.value for one in result.parameters], VALUES, rtol=1e-6)
    assert [one.name for one in result.parameters] == list(NAMES)
    assert [one.admissible for one in result.solutions] == [True, False]
    assert result.solutions[1].chi2 > 100


def test_shapes_that_are_too_uncertain_leave_both_solutions():
    """Shape uncertainties of several times the shape separate nothing."""
    measured = measure(TRUTH)
    measured = replace(measured, shape_sd=np.full((2, 2), 3.0))
    result = identify_links(chain(), measured)
    assert result.verdict is IdentificationVerdict.AMBIGUOUS
    assert "smaller uncertainty" in result.reasons[0]


def test_stiffness_known_beforehand_chooses_between_the_two_solutions():
    """A ground stiffness good to 5 % stands in for the missing shapes."""
    model = chain(4.1e7, 0.0)
    known = replace(model.links[0], stiffness_spread=0.05)
    model = LumpedModel(model.bodies, (known, model.links[1]))
    result = identify_links(model, measure(TRUTH, shapes=False))
    assert result.verdict is IdentificationVerdict.DETERMINED
    assert_allclose(result.parameter("joint.stiffness").value, 1.6e7, rtol=1e-6)


def test_uncertainties_are_those_of_repeated_measurements():
    """60 noisy benches: unit variance over the sd, four over the covariance."""
    deviations, distances = [], []
    for seed in range(60):
        result = identify_links(TRUTH, measure(TRUTH, seed=seed), starts=2)
        found = result.parameters
        deviations.append(
            [
                (one.value - true) / one.sd
                for one, true in zip(found, VALUES, strict=True)
            ]
        )
        off = np.log(np.array([one.value for one in found]) / VALUES)
        distances.append(off @ np.linalg.solve(result.log_covariance, off))
    spread = np.sqrt(np.mean(np.square(deviations), axis=0))
    # Rms of 60 unit normals: 1 +- 0.09; inflation by chi2 lowers it a little.
    assert np.all((spread > 0.65) & (spread < 1.3))
    # The mean of 60 draws of chi2 with four degrees has an sd of 0.37.
    assert 2.2 < np.mean(distances) < 5.2


def test_the_uncertainty_of_the_masses_enters_that_of_the_stiffness(precise):
    """1 % on both masses with exact frequencies: 1 % on each stiffness at most."""
    for name in NAMES[:2]:
        one = precise.parameter(name)
        assert 0.005 < one.sd / one.value < 0.02


def test_a_single_known_link_leaves_only_the_joint_to_find():
    """`unknown` names the links sought; the rest keep their values."""
    model = LumpedModel(TRUTH.bodies, (TRUTH.links[0], chain().links[1]))
    measured = measure(TRUTH, shapes=False)
    result = identify_links(model, measured, unknown=["joint"])
    assert [one.name for one in result.parameters] == [NAMES[1], NAMES[3]]
    assert_allclose([one.value for one in result.parameters], VALUES[1::2], rtol=1e-6)
    assert result.model.links[0] == TRUTH.links[0]


def test_one_mode_does_not_determine_two_links_and_says_so():
    """A continuum of solutions is not an answer."""
    measured = measure(TRUTH, shapes=False)
    first = MeasuredModes(measured.natural_frequency[:1], measured.frequency_sd[:1])
    result = identify_links(chain(), first)
    assert result.verdict is IdentificationVerdict.UNDETERMINED
    assert "continuum" in result.reasons[0]
    assert all(one.sd is None and one.reason for one in result.parameters)


def test_the_higher_mode_alone_is_matched_to_the_higher_mode():
    """With the ground known, `mode_numbers` selects the measured one."""
    model = LumpedModel(TRUTH.bodies, (TRUTH.links[0], chain().links[1]))
    modes = solve_modes(TRUTH)
    second = MeasuredModes(modes.natural_frequency[1:], np.array([0.05]))
    result = identify_links(model, second, unknown=["joint"], mode_numbers=[1])
    stiffnesses = [one.parameters["joint.stiffness"] for one in result.solutions]
    # Damping of the joint is not known here: it moves the frequency by zeta^2 only.
    assert np.min(np.abs(np.array(stiffnesses) / 1.6e7 - 1)) < 1e-3


def test_frequencies_that_no_stiffness_explains_do_not_fit():
    """Too close together for these masses: the quadratic has no real root."""
    frequency = np.array([300.0, 380.0])
    assert np.any(np.imag(np.array(two_solutions(frequency))) != 0)
    measured = MeasuredModes(frequency, 1e-3 * frequency)
    result = identify_links(chain(), measured)
    assert result.verdict is IdentificationVerdict.INCONSISTENT
    assert result.solutions[0].chi2 > 100
    assert not any(one.identifiable for one in result.parameters)
    assert all("does not fit" in one.reason for one in result.parameters)


def test_two_bodies_that_read_one_channel_are_refused():
    """Shapes alike to the last digit in both modes, or one body named twice."""
    measured = measure(TRUTH)
    twice = replace(measured, shapes=measured.shapes[:, [0, 0]])
    with pytest.raises(BadData, match="'base' and 'top' read the same output"):
        identify_links(chain(), twice)
    named_twice = replace(measured, outputs=("top", "top"))
    with pytest.raises(BadData, match="'top' has two outputs"):
        identify_links(chain(), named_twice)


def test_damping_of_a_hardly_strained_joint_cannot_be_distinguished_from_zero():
    """Damping ratios good to 60 % leave the joint's share undecided."""
    result = identify_links(chain(), measure(TRUTH, damping_sd=0.6))
    one = result.parameter("joint.damping")
    assert not one.identifiable
    assert "distinguished from zero" in one.reason
    assert result.verdict is IdentificationVerdict.PARTLY


def test_damping_is_never_negative():
    """Ratios that would need a negative ground damping end at zero."""
    modes = solve_modes(chain(4.1e7, 1.6e7, 0.0, 95.0))
    ratio = modes.damping_ratio * np.array([0.7, 1.1])
    measured = replace(
        measure(TRUTH), damping_ratio=ratio, damping_ratio_sd=0.3 * ratio
    )
    result = identify_links(chain(), measured)
    one = result.parameter("ground.damping")
    assert 0 <= one.value < 1
    assert not one.identifiable


def test_a_large_residual_enlarges_the_standard_deviations():
    """Uncertainties somewhat too small: the same values, sd as they should be."""
    measured = measure(TRUTH, seed=4)
    fields = ("frequency_sd", "damping_ratio_sd", "shape_sd")
    tight = replace(measured, **{f: getattr(measured, f) / 1.5 for f in fields})
    honest, boasting = (identify_links(chain(), one) for one in (measured, tight))
    assert_allclose(
        [one.value for one in boasting.parameters],
        [one.value for one in honest.parameters],
        rtol=1e-6,
    )
    freedom = boasting.degrees_of_freedom
    enlarged = np.sqrt(boasting.solutions[0].chi2 / freedom)
    assert enlarged > 1.0
    for big, small in zip(honest.parameters, boasting.parameters, strict=True):
        floor = max(1.0, np.sqrt(honest.solutions[0].chi2 / freedom))
        assert_allclose(small.sd, big.sd * enlarged / 1.5 / floor, rtol=1e-5)


def test_modes_that_no_bench_explains_leave_no_uncertainty_to_print():
    """Uncertainties ten times too small: no sd and no interval beside the verdict."""
    measured = measure(TRUTH, seed=4)
    fields = ("frequency_sd", "damping_ratio_sd", "shape_sd")
    tight = replace(measured, **{f: getattr(measured, f) / 10 for f in fields})
    result = identify_links(chain(), tight)
    assert result.verdict is IdentificationVerdict.INCONSISTENT
    for one in result.parameters:
        assert one.sd is None
        assert one.interval == (None, None)


def test_a_link_with_two_solutions_has_the_interval_of_both():
    """Two frequencies of two bodies: no sd, and a range that holds each solution."""
    result = identify_links(chain(), measure(TRUTH, shapes=False))
    one = result.parameter("joint.stiffness")
    assert not one.identifiable
    assert one.sd is None
    found = [s.parameters["joint.stiffness"] for s in result.solutions if s.admissible]
    assert max(found) > 1.3 * min(found)
    low, high = one.interval
    assert low < min(found) < max(found) < high
    reported = identification_json(result)["parameters"]["joint.stiffness"]
    assert reported["sd"] is None
    assert reported["interval_95"] == [low, high]


def test_a_search_that_ran_out_of_steps_is_no_rival(precise):
    """Frequencies to 1e-7 make a narrow valley; unfinished ends are no solutions."""
    assert precise.verdict is IdentificationVerdict.DETERMINED


def test_three_bodies_are_found_from_three_modes_with_shapes():
    """Nothing in the method is special to two bodies."""
    truth = LumpedModel(
        (Body("a", 5.0), Body("b", 3.0), Body("c", 2.0)),
        (
            Link("g", ("ground", "a"), 1e7, 50.0),
            Link("j", ("a", "b"), 2e7, 50.0),
            Link("k", ("b", "c"), 3e7, 80.0),
        ),
    )
    blank = LumpedModel(
        truth.bodies, tuple(Link(link.name, link.ends) for link in truth.links)
    )
    result = identify_links(blank, measure(truth), starts=10)
    assert result.verdict is IdentificationVerdict.DETERMINED
    for link in truth.links:
        found = result.parameter(f"{link.name}.stiffness").value
        assert_allclose(found, link.stiffness, rtol=1e-6)


def test_a_free_pair_gives_the_joint_between_its_bodies():
    """Hung in soft ropes: one elastic mode, kj = w^2 m1 m2/(m1 + m2)."""
    bodies = TRUTH.bodies
    truth = LumpedModel(bodies, (Link("joint", ("base", "top"), 2.2e7, 70.0),))
    blank = LumpedModel(bodies, (Link("joint", ("base", "top")),))
    result = identify_links(blank, measure(truth, shapes=False))
    found = [one.value for one in result.parameters]
    assert_allclose(found, [2.2e7, 70.0], rtol=1e-6)


def test_a_free_pair_has_no_second_mode():
    """The message states the remedy."""
    blank = LumpedModel(TRUTH.bodies, (Link("joint", ("base", "top")),))
    measured = MeasuredModes(np.array([100.0, 300.0]), np.array([0.1, 0.1]))
    with pytest.raises(BadData, match="fewer oscillating modes"):
        identify_links(blank, measured)


def test_energy_shares_say_which_mode_speaks_of_which_link():
    """Shares of a mode add up to one; stiffnesses are in proportion to them."""
    result = identify_links(chain(), measure(TRUTH))
    modes = solve_modes(TRUTH)
    strain = np.abs(modes.shapes[:, 1] - modes.shapes[:, 0]) ** 2 * 1.6e7
    ground = np.abs(modes.shapes[:, 0]) ** 2 * 4.1e7
    assert_allclose(result.energy_share[:, 1], strain / (strain + ground), rtol=1e-5)
    assert_allclose(result.energy_share.sum(axis=1), 1.0)


def test_the_answer_is_plain_json_even_where_nothing_is_known():
    """No NaN, no infinity, no arrays."""
    measured = measure(TRUTH, shapes=False)
    first = MeasuredModes(measured.natural_frequency[:1], measured.frequency_sd[:1])
    for one in (measured, first):
        text = json.dumps(
            identification_json(identify_links(chain(), one)), allow_nan=False
        )
        answer = json.loads(text)
        assert set(answer["parameters"]["joint.stiffness"]) == {
            "value",
            "sd",
            "interval_95",
            "unit",
            "identifiable",
            "reason",
        }


def test_the_same_seed_gives_the_same_answer():
    """Bit for bit."""
    first, second = (
        identification_json(identify_links(chain(), measure(TRUTH, seed=1), seed=5))
        for _ in range(2)
    )
    assert first == second
