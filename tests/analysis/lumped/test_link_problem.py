# SPDX-License-Identifier: MIT
import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.lumped.link_problem import pose_problem, residuals
from jointbench.analysis.lumped.lumped_model import Body, Link, LumpedModel
from jointbench.analysis.lumped.lumped_modes import solve_modes
from jointbench.analysis.lumped.measured_modes import MeasuredModes

MODEL = LumpedModel(
    (Body("a", 5.0, 0.004), Body("b", 3.0), Body("c", 2.0, 0.005)),
    (
        Link("g", ("ground", "a"), 1e7, 150.0, 0.2, 40.0 / 150.0),
        Link("j", ("a", "b"), 2e7, 90.0),
        Link("k", ("b", "c"), 3e7, 80.0),
    ),
)


def measured_of(model, outputs=("a", "c")):
    """Return the modes of a model as if measured exactly, with some uncertainty."""
    modes = solve_modes(model)
    shapes = modes.shapes[:, [model.index(name) for name in outputs]]
    return MeasuredModes(
        modes.natural_frequency,
        1e-3 * modes.natural_frequency,
        modes.damping_ratio,
        0.05 * modes.damping_ratio,
        shapes,
        np.full(shapes.shape, 0.01),
        outputs,
    )


def test_residuals_vanish_at_the_truth():
    """Frequencies, damping ratios, shapes and priors all at once."""
    problem = pose_problem(MODEL, measured_of(MODEL))
    damping = np.array([150.0, 90.0, 80.0]) / problem.damping_scale
    unknowns = np.concatenate([np.log([1e7, 2e7, 3e7]), damping, [0.0, 0.0]])
    values, slopes = residuals(problem, unknowns)
    # 3 modes times (frequency, ratio, one complex shape ratio), 4 things known before.
    assert slopes.shape == (3 * 4 + 4, 8)
    assert_allclose(values, 0, atol=1e-8)


def test_sensitivities_equal_differences_of_the_residuals():
    """Away from the truth, central differences, every row and every unknown."""
    problem = pose_problem(MODEL, measured_of(MODEL))
    unknowns = np.array([16.4, 16.6, 17.0, 0.9, 0.6, 0.4, 0.01, -0.02])
    _, slopes = residuals(problem, unknowns)
    for at in range(unknowns.size):
        move = np.zeros(unknowns.size)
        move[at] = 1e-5
        above, below = (
            residuals(problem, unknowns + sign * move)[0] for sign in (1, -1)
        )
        scale = np.abs(slopes[:, at]).max()
        assert_allclose(slopes[:, at], (above - below) / 2e-5, atol=1e-6 * scale)


def test_a_model_without_enough_oscillation_has_no_residuals():
    """Damping far above critical takes the modes away."""
    problem = pose_problem(MODEL, measured_of(MODEL))
    unknowns = np.array([16.4, 16.6, 17.0, 1e4, 1e4, 1e4, 0.0, 0.0])
    assert residuals(problem, unknowns) is None


def test_more_modes_than_bodies_are_refused():
    """The message states the largest number."""
    one = LumpedModel((Body("a", 5.0),), (Link("g", ("ground", "a")),))
    measured = MeasuredModes(np.array([10.0, 20.0]), np.array([0.1, 0.1]))
    with pytest.raises(BadData, match="at most 1"):
        pose_problem(one, measured)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"unknown": ["x"]}, "no link 'x'"),
        ({"mode_numbers": [0]}, "mode numbers"),
        ({"mode_numbers": [2, 1, 0]}, "ascending"),
    ],
)
def test_names_and_numbers_that_do_not_exist_are_refused(options, match):
    """Links by name, modes by number."""
    with pytest.raises(UsageError, match=match):
        pose_problem(MODEL, measured_of(MODEL), **options)


@pytest.mark.parametrize(
    ("fields", "match"),
    [
        ({"frequency_sd": np.array([0.1, 0.0])}, "frequency_sd"),
        ({"natural_frequency": np.array([20.0, 10.0])}, "ascending"),
        ({"damping_ratio": np.array([0.01, 0.01])}, "belong together"),
        (
            {
                "damping_ratio": np.array([0.01, np.nan]),
                "damping_ratio_sd": np.array([0.001, 0.001]),
            },
            "not finite",
        ),
    ],
)
def test_measured_modes_that_cannot_be_used_are_refused(fields, match):
    """Zero uncertainty, wrong order, halves of pairs, NaN."""
    plain = {
        "natural_frequency": np.array([10.0, 20.0]),
        "frequency_sd": np.array([0.1, 0.1]),
    }
    with pytest.raises(BadData, match=match):
        MeasuredModes(**{**plain, **fields})
