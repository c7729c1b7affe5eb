# SPDX-License-Identifier: MIT
"""Modes over their amplitude, judged on masses with a joint and another integrator."""

from functools import cache

import numpy as np
import pytest
from jointed_masses import (
    SAMPLE_RATE,
    Joint,
    Structure,
    chain,
    micro_slip,
    strike,
    true_curve,
    with_joint,
)

from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.analysis.lumped.identify_links import identify_links
from jointbench.analysis.lumped.lumped_model import Body, Link, LumpedModel
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode, Dependence
from jointbench.signal.amplitude.amplitude_modes import amplitude_modes
from jointbench.signal.amplitude.resolved_model import resolved_model
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.signal.modal.modes import identify_modes

LEVELS = np.repeat(np.geomspace(1 / 30, 1.0, 4), 2)
EXPONENT = 0.6


@cache
def slipping() -> tuple[Structure, float]:
    """One mass at 80 Hz that softens by 2 % at the hardest hit; joint amplitude."""
    base = chain(np.random.default_rng(1), 1)
    omega, shapes = base.modes()
    size = float(abs(shapes[0, 0]) ** 2 / omega[0])
    joint = micro_slip(0.04 * omega[0] ** 2 / shapes[0, 0] ** 2, size, EXPONENT)
    return with_joint(base, joint, float(joint.slider_stiffness.sum())), size


def struck(structure: Structure, levels: np.ndarray, decibel: float) -> Recording:
    """Return one recording of several hits, 2 s each, judged good."""
    rng = np.random.default_rng(7)
    pairs = [strike(structure, float(level), where=0) for level in levels]
    size = pairs[0][0].size
    samples = np.array(
        [np.concatenate([p[0] for p in pairs])]
        + [
            np.concatenate([p[1][mass] for p in pairs])
            for mass in range(structure.mass.size)
        ]
    )
    noise = samples[1:, -size:].std() * 10 ** (-decibel / 20)
    samples[1:] += rng.normal(0.0, noise, samples[1:].shape)
    trigger = round(0.01 * SAMPLE_RATE) + 1
    hits = tuple(
        Hit(i, i + trigger, i + size, "1", 1.0, Verdict.OK, 0.0, "simulated")
        for i in range(0, samples.shape[1], size)
    )
    channels = [Channel("hammer", Quantity.FORCE, "1")]
    channels += [
        Channel(f"a{m}", Quantity.ACCELERATION, str(m))
        for m in range(structure.mass.size)
    ]
    return Recording("made", samples, SAMPLE_RATE, tuple(channels), hits=hits)


def resolved(recording: Recording) -> tuple[ModalModel, tuple[AmplitudeMode, ...]]:
    """Return the linear modal model and the modes over amplitude."""
    model = identify_modes(estimate_frf([recording])).model
    return model, amplitude_modes([recording], model)


@cache
def slipping_modes() -> tuple[ModalModel, tuple[AmplitudeMode, ...]]:
    """Modes of the softening mass, 60 dB."""
    return resolved(struck(slipping()[0], LEVELS, 60.0))


def softening() -> AmplitudeMode:
    """Return the mode at 80 Hz."""
    return min(slipping_modes()[1], key=lambda m: abs(m.soft.frequency - 80.0))


def test_a_softening_mode_depends_on_amplitude() -> None:
    """2 % at the hardest of four levels, 60 dB."""
    assert softening().dependence is Dependence.DEPENDS


def test_a_change_too_small_to_report_is_in_the_interval() -> None:
    """0.09 % at the hardest hit, 60 dB: a linear fit gives two tight poles for it."""
    base = chain(np.random.default_rng(1), 1)
    omega, shapes = base.modes()
    size = float(abs(shapes[0, 0]) ** 2 / omega[0])
    lost = 2.0 * 9e-4 * omega[0] ** 2 / shapes[0, 0] ** 2
    joint = micro_slip(lost, size, EXPONENT)
    stuck = with_joint(base, joint, float(joint.slider_stiffness.sum()))
    model, found = resolved(struck(stuck, LEVELS, 60.0))
    true = float(stuck.modes()[0][0] / 2 / np.pi)
    limit = resolved_model(model, found)
    assert found[0].dependence is Dependence.NONE
    assert abs(model.natural_frequency[0] - true) > 3.0 * model.frequency_sd[0]
    assert limit.natural_frequency.size == 1
    assert limit.frequency_sd[0] > 1e-4 * true
    assert abs(limit.natural_frequency[0] - true) < 2.0 * limit.frequency_sd[0]


def test_poles_on_one_curve_become_one_mode_at_small_amplitude() -> None:
    """A linear estimator reports several; the soft limit is that of the stuck joint."""
    model, found = slipping_modes()
    merged = resolved_model(model, found)
    linear, left = model.natural_frequency, merged.natural_frequency
    assert np.sum(np.abs(linear - 80.0) < 6.0) > 1
    assert np.sum(np.abs(left - 80.0) < 6.0) == 1
    at = int(np.argmin(np.abs(left - 80.0)))
    assert abs(left[at] - 80.0) < 3.0 * merged.frequency_sd[at]


def test_identification_gets_the_joint_at_small_amplitude() -> None:
    """The stiffness of the stuck joint is in its interval; linear poles are outside."""
    structure, (model, found) = slipping()[0], slipping_modes()
    stuck = float(structure.stiffness[0, 0] + structure.joint.slider_stiffness.sum())
    body = LumpedModel(
        (Body("mass", float(structure.mass[0])),),
        (Link("joint", ("ground", "mass"), 0.9 * stuck, 1.0),),
    )

    def deviation(modes: ModalModel) -> float:
        at = int(np.argmin(np.abs(modes.natural_frequency - 79.9)))
        measured = MeasuredModes(
            modes.natural_frequency[[at]],
            modes.frequency_sd[[at]],
            modes.damping_ratio[[at]],
            modes.damping_ratio_sd[[at]],
        )
        (stiffness, _) = identify_links(body, measured).parameters
        return float((stiffness.value - stuck) / stiffness.sd)

    assert abs(deviation(resolved_model(model, found))) < 2.0
    assert abs(deviation(model)) > 5.0


def test_the_curve_is_that_of_harmonic_balance() -> None:
    """Frequency within 200 ppm, damping within 1 % over the upper half of ln a."""
    structure, size = slipping()
    curve = softening().curve
    assert curve is not None
    truth = true_curve(structure, 0, size * np.geomspace(1e-4, 3.0, 40))
    upper = slice(curve.amplitude.size // 2, -2)
    frequency, damping = truth.at(0, curve.amplitude[upper])
    assert np.abs(curve.frequency[upper] / frequency - 1).max() < 2e-4
    assert np.abs(curve.damping_ratio[upper] / damping - 1).max() < 1e-2


def test_the_bands_hold_the_truth() -> None:
    """At least nine of ten points of the 95 % bands, frequency and damping."""
    structure, size = slipping()
    curve = softening().curve
    assert curve is not None
    truth = true_curve(structure, 0, size * np.geomspace(1e-4, 3.0, 40))
    frequency, damping = truth.at(0, curve.amplitude)
    held = np.abs(curve.frequency - frequency) < 1.96 * curve.frequency_sd
    kept = np.abs(curve.damping_ratio - damping) < 1.96 * curve.damping_sd
    assert held.mean() >= 0.9
    assert kept.mean() >= 0.9


def test_the_exponent_of_micro_slip_is_found() -> None:
    """Within 0.03 of the Iwan joint's own; the power law is ranked first."""
    best = softening().laws[0]
    assert best.name == "micro-slip power law"
    assert best.exponent == pytest.approx(EXPONENT, abs=0.03)
    assert softening().family == "friction or micro-slip"


def test_a_cubic_spring_changes_frequency_alone() -> None:
    """Its family is elastic: damping does not follow."""
    base = chain(np.random.default_rng(1), 1)
    omega, shapes = base.modes()
    size = float(abs(shapes[0, 0]) ** 2 / omega[0])
    joint = Joint(cubic=0.02 * omega[0] ** 2 / shapes[0, 0] ** 2 / (0.75 * size**2))
    _, found = resolved(struck(with_joint(base, joint, 0.0), LEVELS, 60.0))
    mode = min(found, key=lambda m: abs(m.soft.frequency - 80.0))
    assert mode.dependence is Dependence.DEPENDS
    assert mode.family.startswith("elastic")
    assert mode.frequency_change > 0


def test_the_onset_of_a_stop_is_followed_at_80_db() -> None:
    """Its bend takes knots finer than a quarter of ln a; the law is found with it."""
    base = chain(np.random.default_rng(1), 1)
    omega, shapes = base.modes()
    size = float(abs(shapes[0, 0]) ** 2 / omega[0])
    lost = 2.0 * 0.017 * omega[0] ** 2 / shapes[0, 0] ** 2
    joint = Joint(clearance=0.3 * size, stop_stiffness=1.5 * lost)
    _, found = resolved(struck(with_joint(base, joint, 0.0), LEVELS, 80.0))
    mode = min(found, key=lambda m: abs(m.soft.frequency - 80.0))
    assert mode.residual_ratio < 2.0
    assert mode.dependence is Dependence.DEPENDS and mode.curve is not None
    assert mode.laws[0].name == "clearance or opening"


def test_a_linear_structure_does_not_depend() -> None:
    """Three masses without a joint, 60 dB: no mode depends, the model is untouched."""
    base = chain(np.random.default_rng(2), 3)
    model, found = resolved(struck(base, LEVELS, 60.0))
    assert all(mode.dependence is not Dependence.DEPENDS for mode in found)
    assert resolved_model(model, found) is model


def test_hits_of_one_level_decide_nothing() -> None:
    """A change along a decay may be a neighbour: levels are needed to decide."""
    structure, _ = slipping()
    _, found = resolved(struck(structure, np.ones(4), 60.0))
    assert all(mode.dependence is Dependence.NOT_DECIDED for mode in found)
    assert "hit softly and hard" in found[0].reason


def test_two_modes_on_a_cubic_joint_have_the_curves_of_harmonic_balance() -> None:
    """Far apart, one joint: f within 200 ppm where known to 100, hard end left out."""
    structure = chain(np.random.default_rng(4), 2)
    omega, shapes = structure.modes()
    size = np.abs(structure.direction @ shapes * shapes[0]) / omega
    share = np.abs(structure.direction @ shapes)
    mode = int(np.argmax(size))
    lost = 2 * 0.002 * omega[mode] ** 2 / share[mode] ** 2
    joint = Joint(cubic=float(lost / (0.75 * size[mode] ** 2)))
    jointed = with_joint(structure, joint, 0.0)
    _, found = resolved(struck(jointed, np.geomspace(1 / 30, 1.0, 4), 60.0))
    for number, one in enumerate(omega / 2 / np.pi):
        near = min(found, key=lambda m, one=one: abs(m.soft.frequency - one))
        curve = near.curve
        assert curve is not None
        truth = true_curve(jointed, number, size[mode] * np.geomspace(1e-4, 3.0, 30))
        at = int(curve.channel.split("@")[1])
        frequency, _ = truth.at(at, curve.amplitude)
        known = curve.frequency_sd < 1e-4 * frequency
        assert known.sum() >= 10
        assert np.abs(curve.frequency / frequency - 1)[known][:-2].max() < 2e-4
