# SPDX-License-Identifier: MIT
"""Catalogue v1, part 2: force laws of links, and nonlinear channels."""

from functools import lru_cache

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.catalogue.catalogue_settings import CATALOGUE_SETTINGS
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import (
    Parameter,
    Reported,
    Transform,
)
from jointbench.analysis.gap.response import law_forces as integration
from jointbench.analysis.gap.response.effect_hooks import Law, LumpedEffect
from jointbench.analysis.gap.response.slider_integration import slider_tables

_LOG = Transform.LOG
_SHARPNESS = CATALOGUE_SETTINGS.slider_sharpness


def _cubic(v: FloatArray) -> Law:
    return Law(integration.POLYNOMIAL, np.array([0.0, v[0]]))


def _quadratic(v: FloatArray) -> Law:
    return Law(integration.POLYNOMIAL, np.array([v[0], 0.0]))


def _gap(v: FloatArray) -> Law:
    return Law(integration.ONE_SIDED, np.array([v[0], v[1]]))


def _gap_report(v: FloatArray) -> tuple[Reported, ...]:
    return Reported("k", "N/m", float(v[0])), Reported("g", "m", float(v[1]))


def _coulomb(v: FloatArray) -> Law:
    return Law(integration.COULOMB, np.array([v[0], v[1]]))


def _coulomb_report(v: FloatArray) -> tuple[Reported, ...]:
    return (Reported("Fc", "N", float(v[0])),)


def _quadratic_damping(v: FloatArray) -> Law:
    return Law(integration.QUADRATIC_DAMPING, np.array([v[0]]))


def _sliders(
    stiffness: FloatArray,
    slips: FloatArray,
    loading: float,
    unloading: float,
    sharpness: float,
) -> Law:
    tables, tops = slider_tables(loading, unloading, sharpness)
    total = np.array([float(stiffness.sum())])
    return Law(integration.SLIDERS, total, slips, stiffness, tables, tops)


def _jenkins(v: FloatArray) -> Law:
    return _sliders(v[:1], v[1:2], 1.0, 0.0, float(v[2]))


def _jenkins_report(v: FloatArray) -> tuple[Reported, ...]:
    return (
        Reported("kt", "N/m", float(v[0])),
        Reported("Fs", "N", float(v[0] * v[1])),
        Reported("sharpness", "-", float(v[2])),
    )


def _iwan(v: FloatArray) -> Law:
    edges = np.linspace(0.0, 1.0, CATALOGUE_SETTINGS.iwan_sliders + 1)
    power = float(v[2])
    share = np.diff(edges**power)
    centre = np.diff(edges ** (power + 1.0)) / share * power / (power + 1.0)
    return _sliders(v[0] * share, v[1] * centre, 1.0, 0.0, float(v[3]))


def _iwan_report(v: FloatArray) -> tuple[Reported, ...]:
    return (
        Reported("kt", "N/m", float(v[0])),
        Reported("phimax", "m", float(v[1])),
        Reported("chi", "-", float(v[2] - 2.0)),
        Reported("sharpness", "-", float(v[3])),
    )


def _bouc_wen(v: FloatArray) -> Law:
    """Bouc and Wen with b + g = 1: a common factor scales the yield displacement."""
    return _sliders(v[:1], v[1:2], 1.0, float(v[3]), float(v[2]))


def _bouc_wen_report(v: FloatArray) -> tuple[Reported, ...]:
    return (
        Reported("k", "N/m", float(v[0])),
        Reported("zy", "m", float(v[1])),
        Reported("n", "-", float(v[2])),
        Reported("b", "-", float(1 + v[3]) / 2),
        Reported("g", "-", float(1 - v[3]) / 2),
    )


def _saturate(
    model: FloatArray, measured: FloatArray, v: FloatArray, rate: float
) -> FloatArray:
    if v[0] <= 0.0:
        return model
    limit = 1.0 / v[0]
    return np.clip(model, -limit, limit)


def _saturation_report(v: FloatArray) -> tuple[Reported, ...]:
    return (Reported("amax", "unit of the channel", float(1.0 / max(v[0], 1e-12))),)


@lru_cache(maxsize=16)
def _line(step: float, count: int) -> tuple[FloatArray, FloatArray]:
    """Return cosine and sine of a line, shape (2, count), and their inner products.

    Both are kept for calls in which the frequency stays; they are never written to.

    Args:
        step: phase between two samples [rad].
        count: number of samples.
    """
    phase = step * np.arange(count)
    line = np.stack([np.cos(phase), np.sin(phase)])
    return line, line @ line.T


def _hum(
    model: FloatArray, measured: FloatArray, v: FloatArray, rate: float
) -> FloatArray:
    """Add a line whose phase is fitted in each record."""
    if v[0] == 0.0:
        return model
    line, gram = _line(float(2 * np.pi * v[1] / rate), model.shape[-1])
    found = np.linalg.solve(
        gram, line @ np.moveaxis(measured - model, -1, 0).reshape(line.shape[1], -1)
    )
    size = np.maximum(np.hypot(*found), 1e-300)
    return np.asarray(model + v[0] * ((found / size).T @ line).reshape(model.shape))


CUBIC = LumpedEffect(
    Effect(
        "cubic_stiffness",
        "stiffness",
        (Parameter("k3", "N/m^3", "stiffness/travel^2", -5.0, 50.0, off=0.0),),
        "Kovacic and Brennan 2011, The Duffing Equation, ch. 2",
        {
            "gap": "hit from the other side; look for even harmonics",
            "jenkins": "damping rises with level only for friction",
        },
    ),
    ("link",),
    law=_cubic,
)
QUADRATIC = LumpedEffect(
    Effect(
        "quadratic_stiffness",
        "stiffness",
        (Parameter("k2", "N/m^2", "stiffness/travel", -5.0, 5.0, off=0.0),),
        "Kovacic and Brennan 2011, The Duffing Equation, ch. 7",
        {"gap": "more levels: a gap has a threshold, a quadratic law has none"},
    ),
    ("link",),
    law=_quadratic,
)
GAP = LumpedEffect(
    Effect(
        "gap",
        "contact",
        (
            Parameter("k", "N/m", "stiffness", -0.9, 20.0, off=0.0),
            Parameter(
                "g", "m", "travel", 0.004, 1.0, (0.03, 0.1, 0.2, 0.35, 0.55, 0.8), _LOG
            ),
        ),
        "Shaw and Holmes 1983, J. Sound Vib. 90, 129: one-sided stop",
        {
            "cubic_stiffness": "hit from the other side; look for even harmonics",
            "quadratic_stiffness": "more levels: a gap has a threshold",
        },
        report=_gap_report,
    ),
    ("link",),
    law=_gap,
)
JENKINS = LumpedEffect(
    Effect(
        "jenkins",
        "friction",
        (
            Parameter("kt", "N/m", "stiffness", 0.0, 0.95, off=0.0),
            Parameter(
                "slip", "m", "travel", 0.003, 3.0, (0.02, 0.07, 0.15, 0.3, 0.6), _LOG
            ),
            Parameter(
                "sharpness",
                "-",
                "one",
                2.0,
                200.0,
                _SHARPNESS[:1],
                _LOG,
                _SHARPNESS,
            ),
        ),
        "Jenkins 1962; smooth corner after Wen 1976, eq. (2)",
        {
            "iwan": "four levels below gross slip: the slope of damping on amplitude",
            "bouc_wen": "slow load cycles through the joint: shape of the corner",
            "cubic_stiffness": "damping rises with level only for friction",
        },
        report=_jenkins_report,
        has_sliders=True,
    ),
    ("link",),
    law=_jenkins,
)
IWAN = LumpedEffect(
    Effect(
        "iwan",
        "friction",
        (
            Parameter("kt", "N/m", "stiffness", 0.0, 0.95, off=0.0),
            Parameter("phimax", "m", "travel", 0.02, 10.0, (0.2, 0.6, 1.5), _LOG),
            Parameter("chi_plus_2", "-", "one", 1.05, 2.2, (1.6,), _LOG, (1.6, 0.3)),
            Parameter(
                "sharpness",
                "-",
                "one",
                2.0,
                200.0,
                _SHARPNESS[:1],
                _LOG,
                _SHARPNESS,
            ),
        ),
        "Segalman 2005, J. Appl. Mech. 72, 752, eq. (14), stiffness ~ phi^(chi + 2): "
        "chi is one less than there",
        {
            "jenkins": "four levels below gross slip: the slope of damping",
            "bouc_wen": "slow load cycles with reversals inside the loop",
            "cubic_stiffness": "damping rises with level only for friction",
        },
        report=_iwan_report,
        has_sliders=True,
        # The number of sliders of a real element is unknown.
        model_error=5e-5,
    ),
    ("link",),
    law=_iwan,
)
BOUC_WEN = LumpedEffect(
    Effect(
        "bouc_wen",
        "friction",
        (
            Parameter("k", "N/m", "stiffness", 0.0, 0.95, off=0.0),
            Parameter("zy", "m", "travel", 0.005, 10.0, (0.07, 0.3, 1.0), _LOG),
            Parameter("n", "-", "one", 0.5, 6.0, (1.0, 2.0), _LOG, (1.4, 0.5)),
            Parameter("unloading", "-", "one", -0.9, 4.0, (1.0,)),
        ),
        "Wen 1976, J. Eng. Mech. Div. 102, 249, eq. (2)",
        {
            "jenkins": "slow load cycles through the joint: shape of the corner",
            "iwan": "slow load cycles with reversals inside the loop",
        },
        report=_bouc_wen_report,
        has_sliders=True,
    ),
    ("link",),
    law=_bouc_wen,
)
_COULOMB = LumpedEffect(
    Effect(
        "coulomb",
        "friction",
        (
            Parameter("Fc", "N", "force", 0.0, 2.0, off=0.0),
            Parameter("width", "m/s", "speed", 1e-5, 0.1, (0.003,), _LOG, (0.003, 1.5)),
        ),
        "Den Hartog 1931, Trans. ASME 53, APM-107: dry friction in parallel",
        {"jenkins": "small hits: a slider sticks and adds stiffness, Coulomb does not"},
        report=_coulomb_report,
        model_error=1e-5,
    ),
    ("link",),
    law=_coulomb,
)
_QUADRATIC_DAMPING = LumpedEffect(
    Effect(
        "quadratic_damping",
        "damping",
        (Parameter("c", "N s^2/m^2", "damping/speed", 0.0, 300.0, off=0.0),),
        "Morison et al. 1950, Petrol. Trans. 189, 149: drag c v |v|",
        {"coulomb": "damping rises with level for drag and falls for dry friction"},
    ),
    ("link",),
    law=_quadratic_damping,
)
SATURATION = LumpedEffect(
    Effect(
        "saturation",
        "converter",
        (Parameter("inverse_limit", "-", "1/peak", 0.0, 50.0, (1.002, 1.03), off=0.0),),
        "ISO 7626-5:2019: overload of a measuring channel",
        {"jenkins": "lower the gain and hit again: flat tops vanish"},
        report=_saturation_report,
    ),
    ("channel",),
    shape=_saturate,
    every_channel=True,
)
_HUM = LumpedEffect(
    Effect(
        "hum",
        "sensor",
        (
            Parameter("amp", "unit of the channel", "noise", 0.0, 1e6, off=0.0),
            Parameter(
                "freq",
                "Hz",
                "one",
                5.0,
                2000.0,
                (50.0, 60.0, 100.0, 120.0, 150.0, 180.0),
                _LOG,
            ),
        ),
        "Ott 2009, Electromagnetic Compatibility Engineering, ch. 3: mains pick-up",
        {"hidden_mode": "record without a hit"},
        starts_at_peaks=True,
        own_phases=True,
    ),
    ("channel",),
    shape=_hum,
    every_channel=True,
)
NONLINEAR: tuple[LumpedEffect, ...] = (
    CUBIC,
    QUADRATIC,
    GAP,
    JENKINS,
    IWAN,
    BOUC_WEN,
    _COULOMB,
    _QUADRATIC_DAMPING,
    SATURATION,
    _HUM,
)
