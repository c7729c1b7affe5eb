# SPDX-License-Identifier: MIT
"""The two methods for a response compared, and the null test against draws."""

import importlib.util
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import gap_bench as made
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnosis.base_fit import fit_base
from jointbench.analysis.gap.judgement.expected_residual import noise_sd
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import Parameter
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.curve_law import curve_law
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.analysis.gap.response.predict_records import respond
from jointbench.analysis.gap.search.screening import screen
from jointbench.analysis.gap.second_method.verify import (
    Verification,
    second_response,
    verify_fit,
    verify_response,
)
from jointbench.analysis.lumped.lumped_model import Output


def load(path: Path) -> ModuleType:
    """Load a module from its file."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


BENCHMARKS = Path(__file__).parents[4] / "benchmarks" / "gap"
with pytest.MonkeyPatch.context() as path:
    path.syspath_prepend(BENCHMARKS)
    drawing = load(BENCHMARKS / "null_bootstrap.py")

TRAVEL = 1.8e-5  # [m], elongation of the joint under the hardest hit
STIFFNESS = made.NOMINAL["kj"]
SPEED = 0.07  # [m/s]
FASTEST = np.sqrt(STIFFNESS * (1 / made.NOMINAL["m1"] + 1 / made.NOMINAL["m2"]))
"""Upper mode of the specimen [rad/s], the ground spring left out."""
BAND_LIMITED = 1e-7
"""The wrap-around of the fast route is exp(-16) = 1.1e-7 of what still rings at the end
of a record, the integrator's local error 1e-8, the force's spline 1e-8; seen: 6e-8."""
STRAIGHT = ("none", "maxwell", "extra_damping", "added_mass", "hidden_mode")
STRAIGHT += ("preload_stiffness", "preload_damping", "loosening", "delay", "gain_error")
STRAIGHT += ("sensor_lowpass", "polarity", "cross_talk", "saturation")
SAMPLE = 1 / made.RATE
VALUES = {
    "maxwell": ("link:joint", [0.3 * STIFFNESS, 8e-4]),
    "extra_damping": ("body:m2", [440.0]),
    "added_mass": ("body:m1", [0.4]),
    "hidden_mode": ("body:m2", [0.3, 170.0, 0.02]),
    "preload_stiffness": ("link:joint", [0.4]),
    "preload_damping": ("link:joint", [-0.7]),
    "loosening": ("link:joint", [0.1]),
    "delay": ("channel:all", [-2.7 * SAMPLE]),
    "gain_error": ("channel:a1", [0.05]),
    "sensor_lowpass": ("channel:a1", [0.7 * SAMPLE]),
    "polarity": ("channel:a0", [1.0]),
    "cross_talk": ("channel:a0", [0.04]),
    "saturation": ("channel:a1", [1 / 150.0]),
    "cubic_stiffness": ("link:joint", [0.3 * STIFFNESS / TRAVEL**2]),
    "quadratic_stiffness": ("link:joint", [0.3 * STIFFNESS / TRAVEL]),
    "gap": ("link:joint", [0.3 * STIFFNESS, 0.2 * TRAVEL]),
    "jenkins": ("link:joint", [0.3 * STIFFNESS, 0.2 * TRAVEL, 14.0]),
    "iwan": ("link:joint", [0.3 * STIFFNESS, 0.6 * TRAVEL, 0.5, 14.0]),
    "bouc_wen": ("link:joint", [0.3 * STIFFNESS, 0.3 * TRAVEL, 1.5, 1.8]),
    "coulomb": ("link:joint", [55.0, 0.003 * SPEED]),
    "quadratic_damping": ("link:joint", [660.0 / SPEED]),
    "hum": ("channel:a1", [1.0, 50.0]),
}


RECORDS = [0, 2, 5, 7]
"""A soft and a hard hit, one on the other body, one at twice the preload."""


def bench_of() -> LumpedBench:
    """Return hits without a response, with scales for faults of channels."""
    campaign = made.quiet_campaign(samples=448)
    rows = ("force", "response", "hit", "level", "preload", "order")
    few = {name: getattr(campaign, name)[RECORDS] for name in rows}
    bench = make_bench(replace(campaign, **few))
    bench.scales.update(peak=250.0, noise=0.05)
    return bench


def actions_of(bench: LumpedBench, *names: str) -> list[Action]:
    """Return effects of typical size."""
    return bench.actions([made.term_of(bench, n, *VALUES[n]) for n in names])


def compare(*names: str, oversampling: int = 8) -> Verification:
    """Compare the methods for effects of typical size."""
    bench = bench_of()
    return verify_response(
        bench.campaign.model,
        bench.campaign.model.nominal,
        bench.excitation,
        actions_of(bench, *names),
        oversampling=oversampling,
        tolerance=1e-8,
    )


def first_order_hold(oversampling: int) -> float:
    """Return the error of a force that is linear within a step.

    A component of frequency omega has a mean error of (omega h)^2/12; three times that
    allows for the harmonics of a nonlinear force.
    """
    return float(3 * (FASTEST * SAMPLE / oversampling) ** 2 / 12)


def extrapolated(oversampling: int) -> float:
    """Return the error of the extrapolated solution.

    The next term is of order (omega h)^4; three times that allows for the harmonics.
    """
    return float(3 * (FASTEST * SAMPLE / oversampling) ** 4)


def test_every_effect_of_the_catalogue_is_verified() -> None:
    """The tests below cover every entry."""
    assert {entry.effect.name for entry in CATALOGUE} == set(VALUES)


@pytest.mark.parametrize("name", STRAIGHT)
def test_linear_effects_and_faults_agree_to_the_wrap_around(name: str) -> None:
    """Seen: 5e-9 of the peak of each channel, in every record."""
    names = () if name == "none" else (name,)
    assert compare(*names).over_peak.max() < BAND_LIMITED


@pytest.mark.parametrize(
    "name",
    ["cubic_stiffness", "quadratic_stiffness", "quadratic_damping"],
)
def test_smooth_laws_agree_to_the_extrapolated_integration_step(name: str) -> None:
    """Bound 5.2e-6; seen: 9.7e-7, 9.1e-7, 9.9e-7."""
    assert compare(name).over_peak.max() < extrapolated(8)


@pytest.mark.parametrize("name", ["cubic_stiffness", "quadratic_stiffness"])
def test_half_the_step_leaves_far_less_than_a_quarter_of_the_difference(
    name: str,
) -> None:
    """Steps of h and h/2 are extrapolated: a sixteenth; seen: 1/19 and 1/14."""
    coarse, fine = (compare(name, oversampling=o).over_peak.max() for o in (4, 8))
    assert 1 / 32 < fine / coarse < 1 / 8


@pytest.mark.parametrize("name", ["gap", "jenkins", "iwan", "bouc_wen"])
def test_laws_with_corners_agree_to_the_integration_step(name: str) -> None:
    """Bound 3.3e-4; seen: 1.1e-4, 5.8e-5, 4.8e-5, 1.1e-4."""
    assert compare(name).over_peak.max() < first_order_hold(8)


def test_dry_friction_agrees_to_a_jump_misplaced_within_a_step() -> None:
    """A jump is off by half a step at most: bound omega h/4 = 9e-3, seen 3.4e-3."""
    assert compare("coulomb").over_peak.max() < FASTEST * SAMPLE / 8 / 4


def test_hum_is_found_at_its_phase() -> None:
    """The second method finds the true phases, the first up to leakage of the line."""
    bench = bench_of()
    model, theta = bench.campaign.model, bench.campaign.model.nominal
    actions = actions_of(bench, "hum")
    clean = respond(model, theta, bench.excitation)
    phase = np.random.default_rng(3).uniform(0, 2 * np.pi, (4, 1))
    angle = 2 * np.pi * 50.0 * np.arange(clean.shape[-1]) * SAMPLE
    truth = clean.copy()
    truth[:, 1] += np.cos(angle + phase)
    first, second = (
        route(model, theta, bench.excitation, actions, measured=truth)
        for route in (respond, second_response)
    )
    assert np.abs(second - truth)[..., :-64].max() < 1e-5
    assert np.abs(first - truth).max() < 1 / (angle[-1] / 2)


@pytest.mark.parametrize("output", [Output.DISPLACEMENT, Output.VELOCITY])
def test_the_methods_agree_for_all_quantities(output: Output) -> None:
    """Displacement and velocity agree as well."""
    bench = bench_of()
    model = replace(bench.campaign.model, output=output)
    apart = verify_response(model, model.nominal, bench.excitation)
    assert apart.over_peak.max() < BAND_LIMITED


def test_both_methods_include_the_settling_of_a_joint() -> None:
    """The settling of each record changes its stiffness by exp(settling)."""
    bench = bench_of()
    settling = np.linspace(-0.01, 0.01, 4)
    conditions = replace(bench.excitation.conditions, settling=settling)
    excitation = replace(bench.excitation, conditions=conditions)
    model = bench.campaign.model
    apart = verify_response(model, model.nominal, excitation)
    assert apart.over_peak.max() < BAND_LIMITED


def test_a_mass_added_to_a_nonlinear_joint_is_a_heavier_body() -> None:
    """The second method is correct for pairs: the first agrees for the heavier body."""
    bench = bench_of()
    model, theta = bench.campaign.model, bench.campaign.model.nominal
    heavier = theta.copy()
    heavier[0] += 0.4
    cubic = actions_of(bench, "cubic_stiffness")
    pair = actions_of(bench, "cubic_stiffness", "added_mass")
    first = respond(model, heavier, bench.excitation, cubic, oversampling=16)
    second = second_response(model, theta, bench.excitation, pair)
    apart = np.abs(first - second)[..., :-64].max()
    assert apart < first_order_hold(16) * np.abs(second).max()


@pytest.mark.parametrize(
    "other", ["added_mass", "loosening", "hidden_mode", "maxwell", "preload_stiffness"]
)
def test_a_nonlinear_joint_with_a_linear_effect_agrees_as_without_it(
    other: str,
) -> None:
    """The integration must use the link compliance including the linear effect."""
    assert compare("cubic_stiffness", other).over_peak.max() < first_order_hold(8)


@pytest.mark.parametrize("other", ["jenkins", "gap"])
def test_two_laws_at_one_link_agree_as_each_alone(other: str) -> None:
    """Both forces act on the same joint at the same time."""
    assert compare("cubic_stiffness", other).over_peak.max() < first_order_hold(8)


def own_effect(name: str, *, curves: bool) -> LumpedEffect:
    """Return an effect outside the catalogue."""
    amplitude = Parameter("k5", "N/m^5", off=0.0)
    effect = Effect(name, "stiffness", (amplitude,), "made for this test")
    if curves:
        return LumpedEffect(
            effect, ("link",), law=lambda v: curve_law(spring=lambda r: v[0] * r**5)
        )
    return LumpedEffect(effect, ("link",), stiffness=lambda state, v: v[0] * state.s)


def test_a_user_defined_effect_is_verified_by_its_curves() -> None:
    """A fifth power given as a curve agrees as the laws of the catalogue do."""
    bench = bench_of()
    k5 = np.array([0.1 * STIFFNESS / TRAVEL**4])
    action = Action(own_effect("fifth_power", curves=True), "link", 1, k5)
    model = bench.campaign.model
    apart = verify_response(model, model.nominal, bench.excitation, [action])
    assert apart.over_peak.max() < first_order_hold(8)


def test_an_effect_without_a_second_route_is_refused_by_name() -> None:
    """Agreement is not reported if there is only one method."""
    bench = bench_of()
    action = Action(own_effect("odd_damper", curves=False), "link", 1, np.ones(1))
    model = bench.campaign.model
    with pytest.raises(UsageError, match="odd_damper"):
        second_response(model, model.nominal, bench.excitation, [action])


def test_a_diverging_law_is_reported() -> None:
    """A joint that softens beyond its peak load diverges: an error, not a number."""
    bench = bench_of()
    softening = made.term_of(
        bench, "cubic_stiffness", "link:joint", [-4 * STIFFNESS / TRAVEL**2]
    )
    model = bench.campaign.model
    with pytest.raises(BadData, match="second integrator stopped"):
        second_response(
            model, model.nominal, bench.excitation, bench.actions([softening])
        )


@pytest.fixture(scope="module")
def null() -> tuple[LumpedBench, Fit]:
    """Return the fitted base of a campaign without a missing effect."""
    bench, fit = fit_base(make_bench(made.made_campaign([], noise=0.05, seed=4)))
    assert isinstance(bench, LumpedBench)
    return bench, fit


def test_a_fit_is_verified_against_its_noise(null: tuple[LumpedBench, Fit]) -> None:
    """At a fitted base the methods differ by a millionth of the noise in chi2."""
    bench, fit = null
    apart = verify_fit(bench, fit)
    assert apart.over_noise is not None and apart.chi2 is not None
    assert apart.over_noise.max() < 1e-3
    assert apart.chi2 < 1e-6 * bench.blocks.dof


def test_the_threshold_agrees_with_directions_projected_by_least_squares(
    null: tuple[LumpedBench, Fit],
) -> None:
    """Both quantiles scatter by their draws: 0.45 and 0.2 units of chi2."""
    bench, fit = null
    tested = drawing.directions(bench, fit)
    drops = drawing.linearised_drops(tested, 20_000, np.random.default_rng(5))
    threshold = screen(bench, fit, bench.candidates).threshold
    assert abs(np.quantile(drops, 0.995) - threshold) < 4 * np.hypot(0.45, 0.2)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_campaign_drawn_from_a_base_is_explained_by_it(
    seed: int, null: tuple[LumpedBench, Fit]
) -> None:
    """Chi2/dof is 1 within the sd of the acceptance criterion; nothing is missing."""
    drawn = drawing.drawn_campaign(*null, np.random.default_rng(seed))
    bench, fit = drawing.fitted(drawn)
    found = drawing.judge(bench, fit)
    assert abs(found["chi2_per_dof"] - 1) < 4 * noise_sd(bench)
    assert found["reason"] == ""
