# SPDX-License-Identifier: MIT
"""Reasons against naming a fit although little of the gap is left."""

import gap_bench as made
import numpy as np
import pytest

from jointbench.analysis.gap.catalogue.linear_effects import GAIN_ERROR
from jointbench.analysis.gap.catalogue.nonlinear_effects import (
    BOUC_WEN,
    GAP,
    IWAN,
    JENKINS,
    SATURATION,
)
from jointbench.analysis.gap.judgement.amplitudes import at_the_end
from jointbench.analysis.gap.judgement.expected_residual import forgiven
from jointbench.analysis.gap.judgement.rivals import without_duplicates
from jointbench.analysis.gap.model.effect import Candidate, Effect, Site
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.make_bench import make_bench

JOINT = Site("link", "joint")


def fit_of(effect: Effect, coordinates: list[float], sd: float = 0.01) -> Fit:
    """Return a fit of one effect to zero data, with sd `sd` of each coordinate."""
    n = 1 + len(coordinates)
    x = np.array([0.0, *coordinates])
    nothing = np.zeros(n)
    candidates = (Candidate(effect, JOINT),)
    return Fit(x, 1, candidates, nothing, np.eye(n) / sd, 0.0, nothing, nothing)


def test_a_shape_at_the_end_of_its_range_is_named() -> None:
    """A Bouc-Wen element of exponent 6 imitates a Jenkins slider."""
    found = at_the_end(fit_of(BOUC_WEN.effect, [0.01, -1.0, np.log(6.0), 0.0]))
    assert found == "n of bouc_wen@link:joint is at its limit"


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 4.0])
def test_a_shape_inside_its_range_is_no_objection(exponent: float) -> None:
    """Exponents of real joints are far from the limit."""
    fit = fit_of(BOUC_WEN.effect, [0.01, -1.0, np.log(exponent), 0.0])
    assert at_the_end(fit) == ""


def test_an_undetermined_shape_is_no_objection() -> None:
    """It is at its limit by chance: its sd is as large as its range."""
    fit = fit_of(BOUC_WEN.effect, [0.01, -1.0, np.log(6.0), 0.0], sd=10.0)
    assert at_the_end(fit) == ""


def test_only_an_inexact_law_has_a_large_model_error() -> None:
    """The number of sliders of an Iwan element is unknown; a Jenkins has one."""
    base = bare_fit((), 1e6)
    iwan = forgiven(fit_of(IWAN.effect, [0.01, -1.0, 0.5, 2.6]), (base,), 100)
    jenkins = forgiven(fit_of(JENKINS.effect, [0.01, -1.0, 2.6]), (base,), 100)
    assert iwan >= 10 * jenkins


def test_the_model_error_of_a_law_does_not_cover_another_one() -> None:
    """An Iwan element excuses little of the residual of a stop."""
    stop, loose = Candidate(GAP.effect, JOINT), Candidate(IWAN.effect, JOINT)
    base, alone = bare_fit((), 1e9), bare_fit((stop,), 6000.0)
    both = bare_fit((stop, loose), 5900.0)
    one = forgiven(alone, (base, alone, both), 1000)
    assert forgiven(both, (base, alone, both), 1000) == pytest.approx(one)
    assert forgiven(both, (base,), 1000) > 10 * one


def bare_fit(candidates: tuple[Candidate, ...], chi2: float) -> Fit:
    """Return a fit with given candidates and chi2."""
    nothing = np.zeros(1)
    left = np.array([np.sqrt(chi2)])
    return Fit(nothing, 1, candidates, left, np.eye(1), chi2, nothing, nothing)


def two_channel_fit(site: str) -> Fit:
    """Return a fit of a gain and of a converter that clips at a site."""
    clipping = Candidate(SATURATION.effect, Site("channel", site))
    gain = Candidate(GAIN_ERROR.effect, Site("channel", "a0"))
    nothing = np.zeros(3)
    return Fit(nothing, 1, (gain, clipping), nothing, np.eye(3), 0.0, nothing, nothing)


def test_a_fault_of_one_channel_is_a_duplicate_of_that_of_all() -> None:
    """Also with another effect: only one channel may reach the common range."""
    bench = make_bench(made.quiet_campaign())
    every, one = two_channel_fit("all"), two_channel_fit("a1")
    assert without_duplicates(bench, [one, every]) == [every]
    assert without_duplicates(bench, [every]) == [every]


def test_faults_of_two_channels_are_no_duplicates() -> None:
    """Only a fault of all channels replaces another."""
    bench = make_bench(made.quiet_campaign())
    fits = [two_channel_fit("a0"), two_channel_fit("a1")]
    assert without_duplicates(bench, fits) == fits
