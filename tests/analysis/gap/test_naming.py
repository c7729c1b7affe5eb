# SPDX-License-Identifier: MIT
"""What keeps a fit from being a name although little of the gap is left."""

import numpy as np
import pytest

from jointbench.analysis.gap.catalogue_nonlinear import BOUC_WEN, IWAN, JENKINS
from jointbench.analysis.gap.effects import Candidate, Effect, Site
from jointbench.analysis.gap.fit import Fit
from jointbench.analysis.gap.naming import at_the_end, model_error

JOINT = Site("link", "joint")


def fit_of(effect: Effect, coordinates: list[float], sd: float = 0.01) -> Fit:
    """Return a fit of one effect to nothing at all, every coordinate known to `sd`."""
    n = 1 + len(coordinates)
    x = np.array([0.0, *coordinates])
    nothing = np.zeros(n)
    candidates = (Candidate(effect, JOINT),)
    return Fit(x, 1, candidates, nothing, np.eye(n) / sd, 0.0, nothing, nothing)


def test_a_shape_at_the_end_of_its_range_is_told_by_name() -> None:
    """A Bouc-Wen element of exponent 6 stands in for a Jenkins slider."""
    found = at_the_end(fit_of(BOUC_WEN.effect, [0.01, -1.0, np.log(6.0), 0.0]))
    assert found == "n of bouc_wen@link:joint is at its limit"


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 4.0])
def test_a_shape_inside_its_range_is_no_objection(exponent: float) -> None:
    """Exponents that joints have are far from the limit."""
    fit = fit_of(BOUC_WEN.effect, [0.01, -1.0, np.log(exponent), 0.0])
    assert at_the_end(fit) == ""


def test_a_shape_that_the_data_do_not_know_is_no_objection() -> None:
    """At its limit by chance: its sd is as wide as its range."""
    fit = fit_of(BOUC_WEN.effect, [0.01, -1.0, np.log(6.0), 0.0], sd=10.0)
    assert at_the_end(fit) == ""


def test_only_a_law_that_cannot_be_exact_may_leave_much() -> None:
    """The sliders of an Iwan element are counted by its maker; a Jenkins has one."""
    iwan = model_error(fit_of(IWAN.effect, [0.01, -1.0, 0.5, 2.6]))
    jenkins = model_error(fit_of(JENKINS.effect, [0.01, -1.0, 2.6]))
    assert iwan >= 10 * jenkins
