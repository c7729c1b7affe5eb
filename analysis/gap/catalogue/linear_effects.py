# SPDX-License-Identifier: MIT
"""Catalogue v1, part 1: effects that are linear in the response."""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
    Transform,
)
from jointbench.analysis.gap.response.effect_hooks import (
    ElementState,
    HitConditions,
    LumpedEffect,
    one_row,
)

_LOG = Transform.LOG


def _maxwell(state: ElementState, v: FloatArray) -> ComplexArray:
    return one_row(v[0] * state.s * v[1] / (1.0 + state.s * v[1]))


def _maxwell_poles(v: FloatArray) -> ComplexArray:
    return np.array([-1.0 / v[1]], dtype=np.complex128)


def _extra_damping(state: ElementState, v: FloatArray) -> ComplexArray:
    return one_row(v[0] * state.s)


def _added_mass(state: ElementState, v: FloatArray) -> ComplexArray:
    return one_row(v[0] * state.s * state.s)


def _hidden_mode(state: ElementState, v: FloatArray) -> ComplexArray:
    omega = 2 * np.pi * v[1]
    coupling = v[0] * (omega * omega + 2 * v[2] * omega * state.s)
    inertia = v[0] * state.s * state.s
    unit = state.s**2 + 2 * v[2] * omega * state.s + omega * omega
    if v[0] == 0.0:
        return one_row(np.zeros_like(state.s))
    return one_row(coupling * inertia / (v[0] * unit))


def _hidden_mode_poles(v: FloatArray) -> ComplexArray:
    upper = 2 * np.pi * v[1] * complex(-v[2], np.sqrt(1 - v[2] ** 2))
    return np.array([upper, upper.conjugate()], dtype=np.complex128)


def _hidden_mode_report(v: FloatArray) -> tuple[Reported, ...]:
    omega = 2 * np.pi * v[1]
    return (
        Reported("m", "kg", float(v[0])),
        Reported("k", "N/m", float(v[0] * omega**2)),
        Reported("c", "N s/m", float(2 * v[2] * v[0] * omega)),
    )


def _preload_rise(conditions: HitConditions, v: FloatArray) -> FloatArray:
    return np.asarray(conditions.preload ** v[0] - 1.0)


def _preload_stiffness(state: ElementState, v: FloatArray) -> ComplexArray:
    rise = state.stiffness * _preload_rise(state.conditions, v)
    return np.asarray(rise[:, None] * np.ones_like(state.s))


def _preload_damping(state: ElementState, v: FloatArray) -> ComplexArray:
    rise = state.damping * (state.conditions.preload ** v[0] - 1.0)
    return np.asarray(rise[:, None] * state.s)


def _loosening_rise(conditions: HitConditions, v: FloatArray) -> FloatArray:
    return np.asarray(-v[0] * conditions.progress)


def _loosening(state: ElementState, v: FloatArray) -> ComplexArray:
    loss = state.stiffness * _loosening_rise(state.conditions, v)
    return np.asarray(loss[:, None] * np.ones_like(state.s))


def _delay(s: ComplexArray, v: FloatArray) -> ComplexArray:
    return np.asarray(np.exp(-s * v[0]))


def _gain(s: ComplexArray, v: FloatArray) -> ComplexArray:
    return np.full_like(s, 1.0 + v[0])


def _lowpass(s: ComplexArray, v: FloatArray) -> ComplexArray:
    return np.asarray(1.0 / (1.0 + s * v[0]))


def _lowpass_report(v: FloatArray) -> tuple[Reported, ...]:
    return (Reported("fc", "Hz", float(1 / (2 * np.pi * max(v[0], 1e-12)))),)


def _polarity(s: ComplexArray, v: FloatArray) -> ComplexArray:
    return np.full_like(s, 1.0 - 2.0 * v[0])


def _no_parameters(v: FloatArray) -> tuple[Reported, ...]:
    return ()


MAXWELL = LumpedEffect(
    Effect(
        "maxwell",
        "damping",
        (
            Parameter("k", "N/m", "stiffness", 0.0, 3.0, off=0.0),
            Parameter(
                "tau", "s", "period", 0.003, 3.0, (0.02, 0.06, 0.16, 0.4, 1.0), _LOG
            ),
        ),
        "Flugge 1975, Viscoelasticity, ch. 1: spring and dashpot in series",
        {
            "extra_damping": "compare the loss of two modes a factor 3 apart",
            "iwan": "repeat over 30x in level: Maxwell does not depend on it",
        },
    ),
    ("link",),
    stiffness=_maxwell,
    poles=_maxwell_poles,
)
_EXTRA_DAMPING = LumpedEffect(
    Effect(
        "extra_damping",
        "damping",
        (Parameter("c", "N s/m", "damping", 0.0, 100.0, off=0.0),),
        "Ewins 2000, Modal Testing, sec. 2.4: viscous damper to the ground",
        {
            "maxwell": "compare the loss of two modes a factor 3 apart",
            "hidden_mode": "look for a split peak with a finer frequency resolution",
            "delay": "phase slope away from the resonances",
        },
    ),
    ("body",),
    stiffness=_extra_damping,
)
_ADDED_MASS = LumpedEffect(
    Effect(
        "added_mass",
        "mass",
        (Parameter("m", "kg", "mass", 0.0, 1.0, off=0.0),),
        "Ewins 2000, Modal Testing, sec. 3.10: mass loading",
        {
            "gain_error": "move the sensor; compare the rigid-body line",
            "hidden_mode": "weigh the body; look above the mode",
        },
        by_prior=True,
        refit_nominal=True,
    ),
    ("body",),
    stiffness=_added_mass,
)
_HIDDEN_MODE = LumpedEffect(
    Effect(
        "hidden_mode",
        "mode",
        (
            Parameter("m", "kg", "mass", 0.0, 0.5, off=0.0),
            Parameter(
                "f",
                "Hz",
                "frequency",
                0.4,
                6.0,
                tuple(float(x) for x in np.geomspace(0.42, 4.0, 26)),
                _LOG,
            ),
            Parameter("zeta", "-", "one", 1e-3, 0.1, (0.02,), _LOG, prior=(0.015, 1.0)),
        ),
        "Den Hartog 1956, Mechanical Vibrations, sec. 3.2: attached oscillator",
        {
            "extra_damping": "look for a split peak with a finer frequency resolution",
            "added_mass": "excite well above the mode, where the mass decouples",
        },
        report=_hidden_mode_report,
        starts_at_peaks=True,
    ),
    ("body",),
    stiffness=_hidden_mode,
    poles=_hidden_mode_poles,
)
_PRELOAD_STIFFNESS = LumpedEffect(
    Effect(
        "preload_stiffness",
        "preload",
        (Parameter("n", "-", "one", -1.5, 1.5, off=0.0, far=(0.1, 0.25, 0.5)),),
        "Greenwood and Williamson 1966: k grows with a power of the load",
        {"loosening": "repeat the preload sequence backwards"},
    ),
    ("link",),
    stiffness=_preload_stiffness,
    rise=_preload_rise,
)
_PRELOAD_DAMPING = LumpedEffect(
    Effect(
        "preload_damping",
        "preload",
        (Parameter("n", "-", "one", -3.0, 3.0, off=0.0),),
        "Liu et al. 2023, sec. 2.3: damping of the joint grows with its load",
        {"preload_stiffness": "compare frequency and damping against preload"},
    ),
    ("link",),
    stiffness=_preload_damping,
)
_LOOSENING = LumpedEffect(
    Effect(
        "loosening",
        "preload",
        (Parameter("frac", "-", "one", -0.9, 0.9, off=0.0, far=(0.05, 0.2)),),
        "Junker 1969, SAE 690055: stiffness lost from hit to hit",
        {"preload_stiffness": "repeat the preload sequence backwards"},
        follows_order=True,
    ),
    ("link",),
    stiffness=_loosening,
    rise=_loosening_rise,
)
DELAY = LumpedEffect(
    Effect(
        "delay",
        "sensor",
        (Parameter("tau", "s", "sample", -8.0, 8.0, off=0.0),),
        "Ewins 2000, Modal Testing, sec. 3.5: phase error of a measuring chain",
        {
            "sensor_lowpass": "amplitude at high frequency: only a filter lowers it",
            "extra_damping": "phase slope away from the resonances",
        },
    ),
    ("channel",),
    transfer=_delay,
    every_channel=True,
)
GAIN_ERROR = LumpedEffect(
    Effect(
        "gain_error",
        "sensor",
        (Parameter("frac", "-", "one", -0.7, 1.0, off=0.0),),
        "ISO 16063-21:2003: calibration of a vibration transducer",
        {
            "added_mass": "move the sensor; compare the rigid-body line",
            "gain_error": "swap the two sensors",
        },
        by_prior=True,
        refit_nominal=True,
    ),
    ("channel",),
    transfer=_gain,
    every_channel=True,
)
_SENSOR_LOWPASS = LumpedEffect(
    Effect(
        "sensor_lowpass",
        "sensor",
        (Parameter("tau", "s", "sample", 0.0, 12.0, off=0.0),),
        "ISO 5347-22: mounted response of an accelerometer, first order",
        {"delay": "amplitude at high frequency: only a filter lowers it"},
        report=_lowpass_report,
    ),
    ("channel",),
    transfer=_lowpass,
    every_channel=True,
)
_POLARITY = LumpedEffect(
    Effect(
        "polarity",
        "sensor",
        (Parameter("flip", "-", "one", 0.999999, 1.000001, (1.0,), off=0.0),),
        "ISO 7626-1:2011: sign of a transducer",
        {"gain_error": "push the sensor by hand and watch the sign"},
        report=_no_parameters,
        refit_nominal=True,
    ),
    ("channel",),
    transfer=_polarity,
    every_channel=True,
)


def _cross_talk(v: FloatArray) -> float:
    return float(v[0])


CROSS_TALK = LumpedEffect(
    Effect(
        "cross_talk",
        "sensor",
        (Parameter("frac", "-", "one", -0.6, 0.6, off=0.0),),
        "ISO 16063-31: sensitivity to what another channel measures",
        {
            "gain_error": "unplug the other sensor and hit again",
            "extra_damping": "unplug the other sensor and hit again",
        },
    ),
    ("channel",),
    mixing=_cross_talk,
)
LINEAR: tuple[LumpedEffect, ...] = (
    MAXWELL,
    _EXTRA_DAMPING,
    _ADDED_MASS,
    _HIDDEN_MODE,
    _PRELOAD_STIFFNESS,
    _PRELOAD_DAMPING,
    _LOOSENING,
    DELAY,
    GAIN_ERROR,
    _SENSOR_LOWPASS,
    _POLARITY,
    CROSS_TALK,
)
