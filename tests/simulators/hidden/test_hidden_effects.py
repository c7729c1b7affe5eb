"""Linear hidden effects against the closed form of the two bodies."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.hidden.campaign_design import draw_design
from jointbench.simulators.hidden.campaign_response import (
    simulate_records,
    sketch_responses,
)
from jointbench.simulators.hidden.campaign_sampling import SAMPLE_RATE
from jointbench.simulators.hidden.hidden_effects import HiddenEffect

DESIGN = draw_design(3, grid="small")
SIZE = 8192
# Damped Fourier transform: wrap-around is down by exp(-18).
DECAY = 18 * SAMPLE_RATE / SIZE
S = DECAY + 2j * np.pi * np.fft.rfftfreq(SIZE, 1 / SAMPLE_RATE)


def _exact(force, change):
    """Accelerations by the 2x2 closed form; `change` edits its ingredients."""
    time = np.arange(SIZE) / SAMPLE_RATE
    rows = []
    for condition, row in zip(DESIGN.conditions, force, strict=True):
        p = dict(DESIGN.physical)
        parts = {
            "joint": p["kj"] + p["cj"] * S,
            "base": p["m1"] * S**2 + p["k0"] + p["c0"] * S,
            "top": p["m2"] * S**2,
            "sensor": np.ones((2, 1)) * np.ones_like(S),
            "mix": 0.0,
        }
        parts.update(change(p, parts, condition))
        joint, base, top = parts["joint"], parts["base"], parts["top"]
        inner = np.array([[base + joint, -joint], [-joint, top + joint]])
        determinant = inner[0, 0] * inner[1, 1] - joint**2
        inverse = np.array([[inner[1, 1], joint], [joint, inner[0, 0]]]) / determinant
        padded = np.concatenate((row, np.zeros(SIZE - row.size)))
        struck = np.fft.rfft(padded * np.exp(-DECAY * time))
        seen = S**2 * inverse[:, condition.hit_dof] * struck
        seen[0] += parts["mix"] * seen[1]
        out = np.fft.irfft(parts["sensor"] * seen, SIZE) * np.exp(DECAY * time)
        rows.append(out[:, : row.size])
    return np.stack(rows)


def _only(channel, response):
    sensor = np.ones((2, S.size), dtype=complex)
    sensor[channel] = response
    return sensor


def _appendix(mass, k, c):
    """Dynamic stiffness of a body on a spring, seen from its foot."""
    link = k + c * S
    return mass * S**2 * link / (mass * S**2 + link)


CASES = {
    "none": ((), lambda p, q, c: {}),
    "added_mass": (
        {"m": 0.2, "dof": 0},
        lambda p, q, c: {"base": q["base"] + 0.2 * S**2},
    ),
    "extra_damping": ({"c": 400.0}, lambda p, q, c: {"top": q["top"] + 400 * S}),
    "hidden_mode": (
        {"m": 0.25, "k": 2.5e6, "c": 16.0, "dof": 1},
        lambda p, q, c: {"top": q["top"] + _appendix(0.25, 2.5e6, 16.0)},
    ),
    "maxwell": (
        {"k": 2e7, "tau": 1.2e-4},
        lambda p, q, c: {"joint": q["joint"] + 2e7 * S * 1.2e-4 / (1 + S * 1.2e-4)},
    ),
    "preload_stiffness": (
        {"n": 0.3},
        lambda p, q, c: {
            "joint": p["kj"] * (c.preload / DESIGN.preload_reference) ** 0.3
            + p["cj"] * S
        },
    ),
    "preload_damping": (
        {"n": 0.5},
        lambda p, q, c: {"joint": p["kj"] + p["cj"] * c.preload_ratio**0.5 * S},
    ),
    "preload_ground": (
        {"n": 0.5},
        lambda p, q, c: {
            "base": p["m1"] * S**2 + p["k0"] * c.preload_ratio**0.5 + p["c0"] * S
        },
    ),
    "loosening": (
        {"frac": 0.08},
        lambda p, q, c: {"joint": p["kj"] * (1 - 0.08 * c.order / 7) + p["cj"] * S},
    ),
    "thermal_drift": (
        {"frac": 0.08},
        lambda p, q, c: {
            "joint": p["kj"] * (1 + 0.08 * (c.order / 7) ** 2) + p["cj"] * S
        },
    ),
    "delay": (
        {"tau": 4e-5, "dof": 1},
        lambda p, q, c: {"sensor": _only(1, np.exp(-S * 4e-5))},
    ),
    "sensor_lowpass": (
        {"fc": 2500.0, "dof": 0},
        lambda p, q, c: {"sensor": _only(0, 1 / (1 + S / (2 * np.pi * 2500)))},
    ),
    "sensor_resonance": (
        {"f0": 3000.0, "zeta": 0.1, "dof": 0},
        lambda p, q, c: {
            "sensor": _only(
                0, 1 / (1 + 0.2 * S / (6e3 * np.pi) + (S / (6e3 * np.pi)) ** 2)
            )
        },
    ),
    "gain_error": (
        {"frac": -0.04, "dof": 1},
        lambda p, q, c: {"sensor": _only(1, 0.96)},
    ),
    "polarity": ({"dof": 0}, lambda p, q, c: {"sensor": _only(0, -1.0)}),
    "cross_talk": ({"frac": 0.05}, lambda p, q, c: {"mix": 0.05}),
}


@pytest.mark.parametrize("name", CASES)
def test_a_linear_effect_has_its_closed_form(name):
    """Noise-free records against the damped Fourier transform, 2e-5 of the peak."""
    parameters, change = CASES[name]
    effects = () if name == "none" else (HiddenEffect(name, parameters),)
    force, acceleration = simulate_records(DESIGN, effects)
    exact = _exact(force, change)
    # The record is cut before the filter of the closed form sees its end.
    assert_allclose(
        acceleration[:, :, :-64],
        exact[:, :, :-64],
        atol=2e-5 * np.abs(exact).max(),
    )


def test_saturation_clips_every_channel_at_its_limit():
    """Nothing passes amax, and the largest hits reach it."""
    _, acceleration = simulate_records(
        DESIGN, [HiddenEffect("saturation", {"amax": 60.0})]
    )
    assert acceleration.max() == 60.0
    assert acceleration.min() == -60.0


def test_hum_is_a_tone_of_the_stated_amplitude_on_one_channel():
    """Before the hit there is nothing else: its amplitude by projection."""
    _, acceleration = simulate_records(
        DESIGN, [HiddenEffect("hum", {"amp": 0.5, "freq": 512.0, "dof": 1})]
    )
    quiet = acceleration[:, :, :96]
    tone = np.exp(-2j * np.pi * 512 * np.arange(96) / SAMPLE_RATE)
    amplitude = 2 * np.abs(quiet @ tone) / 96
    assert_allclose(amplitude[:, 1], 0.5, rtol=0.02)
    assert amplitude[:, 0].max() < 1e-3


def test_clock_drift_reads_the_accelerations_ahead_of_time():
    """A record read 1 % too fast is the record at 1.01 times its times."""
    _, plain = simulate_records(DESIGN, ())
    _, fast = simulate_records(DESIGN, [HiddenEffect("clock_drift", {"rate": 0.01})])
    late = np.arange(1600) * 1.01
    # Band-limited interpolation of the plain record at those times.
    kernel = np.sinc(late[:, None] - np.arange(2048))
    assert_allclose(
        fast[0, 1, :1600], kernel @ plain[0, 1], atol=5e-3 * np.abs(plain[0]).max()
    )


def test_a_zero_shift_stays_after_the_ringing_has_gone():
    """Two per cent of the peak, decaying with its time constant."""
    effect = HiddenEffect("zero_shift", {"frac": 0.02, "tau": 0.05, "dof": 0})
    _, plain = simulate_records(DESIGN, ())
    _, shifted = simulate_records(DESIGN, [effect])
    shift = (shifted - plain)[0, 0]
    start = DESIGN.conditions[0].pulse.start
    time = np.arange(300, 1900) / SAMPLE_RATE - start
    expected = 0.02 * np.abs(plain[0, 0]).max() * np.exp(-time / 0.05)
    assert_allclose(shift[300:1900], expected, rtol=0.02)


def test_the_sketch_follows_the_records_to_a_per_cent_of_a_change():
    """What sizes effects is close to what is written."""
    effect = HiddenEffect("cubic_stiffness", {"k3": 1e16})
    _, base = simulate_records(DESIGN, ())
    _, bent = simulate_records(DESIGN, [effect])
    change = sketch_responses(DESIGN, [effect]) - sketch_responses(DESIGN)
    error = np.linalg.norm(change - (bent - base)) / np.linalg.norm(bent - base)
    assert error < 0.01


def test_the_order_of_recording_is_what_loosening_follows():
    """The first record is untouched, the last has lost all of `frac`."""
    effect = HiddenEffect("loosening", {"frac": 0.1})
    values = dict(DESIGN.physical)
    values["kj"] *= 0.9
    loose = sketch_responses(DESIGN, [effect])
    assert_allclose(loose[0], sketch_responses(DESIGN)[0], atol=1e-12)
    assert_allclose(loose[-1], sketch_responses(DESIGN, physical=values)[-1])


def test_sites_are_words_an_analyst_uses():
    """Links, bodies and channels."""
    sites = {
        "jenkins": "link:joint",
        "extra_damping": "body:m2",
        "saturation": "channel:all",
        "cross_talk": "channel:a0",
    }
    for name, site in sites.items():
        assert HiddenEffect(name, {}).site == site
    assert HiddenEffect("hidden_mode", {"dof": 1}).site == "body:m2"
    assert HiddenEffect("delay", {"dof": 1}).site == "channel:a1"


def test_an_unknown_effect_is_refused_with_a_near_match():
    """The message suggests the probable name."""
    with pytest.raises(UsageError, match="did you mean cubic_stiffness"):
        HiddenEffect("cubic_stifness", {"k3": 1.0})


def test_the_scatter_of_the_hand_scales_the_response():
    """A force that acts by one per cent more moves the bodies by one per cent more."""
    first = DESIGN.conditions[0]
    strong = replace(first, force_factor=1.01)
    one = replace(DESIGN, conditions=(first,))
    two = replace(DESIGN, conditions=(strong,))
    assert_allclose(sketch_responses(two), 1.01 * sketch_responses(one), rtol=1e-9)
