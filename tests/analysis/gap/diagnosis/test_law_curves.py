# SPDX-License-Identifier: MIT
"""Loops, f(a) and zeta(a) of fitted force laws, and their figure."""

from dataclasses import replace

import gap_bench as made
import numpy as np
import pytest

from jointbench.analysis.gap.catalogue.nonlinear_effects import NONLINEAR
from jointbench.analysis.gap.diagnosis.law_curves_of_fit import law_curves
from jointbench.analysis.gap.model.law_curves import LawCurves, law_curves_json
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.effect_hooks import Law
from jointbench.analysis.gap.response.law_loops import force_along, harmonic_loops
from jointbench.analysis.gap.search.descent import minimise
from jointbench.station.report.gap_law_figures import law_figure

AMPLITUDE = np.array([1e-6, 1e-5])


def law(name: str, *values: float) -> Law:
    """Return a law of the catalogue."""
    entry = next(e for e in NONLINEAR if e.name == name)
    assert entry.law is not None
    return entry.law(np.array(values))


def test_the_first_harmonic_of_a_cubic_spring_is_three_quarters() -> None:
    """Equivalent stiffness 3/4 k3 a^2, no damping."""
    loops = harmonic_loops(law("cubic_stiffness", 4e15), AMPLITUDE, 1000.0)
    assert loops.stiffness == pytest.approx(3e15 * AMPLITUDE**2, rel=1e-6)
    assert np.abs(loops.damping).max() < 1e-6 * loops.stiffness.min() / 1000.0


def test_the_first_harmonic_of_damping_laws_is_known() -> None:
    """8/(3 pi) c a omega for a square of the speed; 4 Fc/(pi a omega) for friction."""
    omega = 2000.0
    square = harmonic_loops(law("quadratic_damping", 50.0), AMPLITUDE, omega)
    expected = 8.0 / (3.0 * np.pi) * 50.0 * AMPLITUDE * omega
    assert square.damping == pytest.approx(expected, rel=1e-3)
    rubbing = harmonic_loops(law("coulomb", 5.0, 1e-5), AMPLITUDE, omega)
    expected = 4.0 * 5.0 / (np.pi * AMPLITUDE * omega)
    assert rubbing.damping == pytest.approx(expected, rel=1e-2)


def test_a_sharp_slider_has_the_loop_of_a_parallelogram() -> None:
    """Dissipation 4 Fs (a - Fs/kt) in gross slip; none before."""
    kt, slip = 1e7, 2e-6
    loops = harmonic_loops(law("jenkins", kt, slip, 200.0), AMPLITUDE, 1000.0)
    lost = np.pi * 1000.0 * loops.damping * AMPLITUDE**2
    assert lost[1] == pytest.approx(4 * kt * slip * (AMPLITUDE[1] - slip), rel=1e-2)
    assert abs(lost[0]) < 1e-3 * lost[1]


def test_columns_are_evaluated_apart() -> None:
    """A column gives the force that it gives alone."""
    motion = np.sin(np.linspace(0.0, 9.0, 300))[:, None] * np.linspace(1e-6, 1e-5, 11)
    slider = law("jenkins", 1e7, 3e-6, 14.0)
    both = force_along(slider, motion)
    assert np.array_equal(both[:, 4], force_along(slider, motion[:, 4]))


@pytest.fixture(scope="module")
def curves() -> LawCurves:
    """Return the curves of a fitted cubic spring."""
    k3 = 0.05 * made.NOMINAL["kj"] / 1.8e-5**2
    bench = make_bench(made.made_campaign([("cubic_stiffness", "link:joint", [k3])]))
    term = made.term_of(bench, "cubic_stiffness", "link:joint", [k3])
    problem = make_problem(bench, (term.candidate,))
    start = np.concatenate([made.BASE, term.coordinates])
    (found,) = law_curves(bench, minimise(problem, start, MIDDLE, iterations=1))
    return found


def test_frequencies_rise_with_amplitude_inside_a_narrow_band(
    curves: LawCurves,
) -> None:
    """A hardening spring: the upper mode rises by more than ten times its sd."""
    rise = curves.frequency[1, -1] - curves.frequency[1, 0]
    assert np.all(np.diff(curves.frequency[1]) > 0)
    assert rise > 10 * curves.frequency_sd[1].max() > 0
    assert np.all(curves.damping > 0) and np.all(curves.damping_sd > 0)
    assert law_curves_json(curves)["effect"] == "cubic_stiffness@link:joint"


def test_the_figure_has_loops_and_bands_in_three_panels(curves: LawCurves) -> None:
    """Every loop has its band, every mode a curve and a band in both panels."""
    drawn = law_figure(curves)
    panels = [trace.get("xaxis", "x") for trace in drawn["data"]]
    assert panels.count("x") == 3 * len(curves.motion)
    assert panels.count("x2") == panels.count("x3") == 3 * len(curves.frequency)


def test_curves_beside_a_relaxation_of_any_size_have_the_modes_of_the_fit() -> None:
    """Draws whose relaxation has more or fewer oscillating poles change no shape."""
    cubic, relaxing = ("cubic_stiffness", [8e15]), ("maxwell", [2e7, 1e-4])
    laws = [(name, "link:joint", values) for name, values in (cubic, relaxing)]
    bench = make_bench(made.made_campaign(laws))
    terms = [made.term_of(bench, *one) for one in laws]
    problem = make_problem(bench, tuple(t.candidate for t in terms))
    start = np.concatenate([made.BASE, *(t.coordinates for t in terms)])
    fit = minimise(problem, start, MIDDLE, iterations=1)
    slopes, prior = fit.jacobian.copy(), fit.prior.copy()
    slopes[:, -2:], prior[-2:] = 0.0, 0.25
    (found,) = law_curves(bench, replace(fit, jacobian=slopes, prior=prior))
    assert found.frequency.shape == found.frequency_sd.shape
    assert np.all(found.frequency > 0)
