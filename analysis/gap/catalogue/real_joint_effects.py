# SPDX-License-Identifier: MIT
"""Extended catalogue: laws of real joints that contain simpler ones of the catalogue.

Each law here has one parameter more than a law of the default catalogue and includes
that law, or is close to one, so that both fit the same records. It is tried on request
(``--with``), and on records of real structures.
"""

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
_SPEED = CATALOGUE_SETTINGS.damping_reference_speed


def _bouc_wen_free(v: FloatArray) -> Law:
    """Bouc and Wen with loading and unloading coefficients on the unit circle."""
    tables, tops = slider_tables(float(np.cos(v[3])), float(np.sin(v[3])), float(v[2]))
    return Law(integration.SLIDERS, v[:1], v[1:2], v[:1], tables, tops)


def _bouc_wen_free_report(v: FloatArray) -> tuple[Reported, ...]:
    loading, unloading = float(np.cos(v[3])), float(np.sin(v[3]))
    return (
        Reported("k", "N/m", float(v[0])),
        Reported("zy", "m", float(v[1])),
        Reported("n", "-", float(v[2])),
        Reported("b", "-", (loading + unloading) / 2),
        Reported("g", "-", (loading - unloading) / 2),
        Reported("loading", "-", loading),
    )


def segalman_sliders(
    phimax: float, chi: float, beta: float
) -> tuple[FloatArray, FloatArray]:
    """Return shares of stiffness [-] and slip displacements [m], shape (n_sliders,).

    Args:
        phimax: largest slip displacement [m].
        chi: exponent of the density; dissipation grows as amplitude^(chi + 3).
        beta: stiffness of the sliders at `phimax` over that of all others [-].

    Source:
        Segalman 2005, J. Appl. Mech. 72, 752, eqs. (14), (26) to (32).
    """
    count, least = CATALOGUE_SETTINGS.segalman_sliders
    edges = np.concatenate([[0.0], np.geomspace(least, 1.0, count)])
    power = chi + 1.0
    share = np.diff(edges**power)
    centre = np.diff(edges ** (power + 1.0)) / share * power / (power + 1.0)
    shares = np.append(share, beta) / (1.0 + beta)
    return shares, phimax * np.append(centre, 1.0)


def _iwan_segalman(v: FloatArray) -> Law:
    shares, slips = segalman_sliders(float(v[1]), float(v[2]) - 2.0, float(v[3]))
    tables, tops = slider_tables(1.0, 0.0, CATALOGUE_SETTINGS.segalman_sharpness)
    return Law(integration.SLIDERS, v[:1], slips, v[0] * shares, tables, tops)


def _iwan_segalman_report(v: FloatArray) -> tuple[Reported, ...]:
    chi, beta = float(v[2]) - 2.0, float(v[3])
    slip_force = v[0] * v[1] * (beta + (chi + 1.0) / (chi + 2.0)) / (1.0 + beta)
    return (
        Reported("kt", "N/m", float(v[0])),
        Reported("Fs", "N", float(slip_force)),
        Reported("chi", "-", chi),
        Reported("beta", "-", beta),
        Reported("phimax", "m", float(v[1])),
    )


def _clearance(v: FloatArray) -> Law:
    """Two stops; at rest between them, or closed at one of them under a preload.

    Closed at rest, the stop is part of the linear link, and only its opening counts.
    """
    upper, lower = v[1] * (v[2] + 1.0), v[1] * (v[2] - 1.0)
    slope = v[0] if abs(v[2]) > 1.0 else 0.0
    return Law(integration.TWO_SIDED, np.array([v[0], upper, lower, slope]))


def _clearance_report(v: FloatArray) -> tuple[Reported, ...]:
    closed = max(abs(float(v[2])) - 1.0, 0.0) * float(v[1])
    return (
        Reported("k", "N/m", float(v[0])),
        Reported("width", "m", 2.0 * float(v[1])),
        Reported("offset", "m", float(v[2] * v[1])),
        Reported("preload", "N", float(v[0]) * closed),
    )


def _quadratic_cubic(v: FloatArray) -> Law:
    return Law(integration.POLYNOMIAL, np.array([v[0] * v[1], v[0]]))


def _quadratic_cubic_report(v: FloatArray) -> tuple[Reported, ...]:
    return (
        Reported("k3", "N/m^3", float(v[0])),
        Reported("k2", "N/m^2", float(v[0] * v[1])),
    )


def _cubic_quintic(v: FloatArray) -> Law:
    return Law(integration.FIFTH_POWER, np.array([v[0], v[0] * v[1]]))


def _cubic_quintic_report(v: FloatArray) -> tuple[Reported, ...]:
    return (
        Reported("k3", "N/m^3", float(v[0])),
        Reported("k5", "N/m^5", float(v[0] * v[1])),
    )


def _power_damping(v: FloatArray) -> Law:
    return Law(integration.POWER_DAMPING, np.array([v[0], v[1], _SPEED]))


def _power_damping_report(v: FloatArray) -> tuple[Reported, ...]:
    return (
        Reported("c", "N (s/m)^p", float(v[0] / _SPEED ** v[1])),
        Reported("p", "-", float(v[1])),
    )


_STIFFNESS = Parameter("k", "N/m", "stiffness", 0.0, 0.95, off=0.0)

BOUC_WEN_FREE = LumpedEffect(
    Effect(
        "bouc_wen_free",
        "friction",
        (
            _STIFFNESS,
            Parameter("zy", "m", "travel", 0.005, 30.0, (0.1, 0.4, 1.5), _LOG),
            Parameter("n", "-", "one", 0.5, 6.0, (1.0, 2.0), _LOG, (1.4, 0.5)),
            Parameter("angle", "rad", "one", -0.7, 2.35, (0.7, 1.7)),
        ),
        "Wen 1976, J. Eng. Mech. Div. 102, 249, eq. (2), with a loading coefficient of "
        "either sign as in Noel and Schoukens 2016, Workshop on Nonlinear System "
        "Identification Benchmarks, hysteretic benchmark",
        {"bouc_wen": "harder hits: a loop with a negative coefficient grows stiffer"},
        report=_bouc_wen_free_report,
        has_sliders=True,
        generalises=("bouc_wen",),
    ),
    ("link",),
    law=_bouc_wen_free,
)
IWAN_SEGALMAN = LumpedEffect(
    Effect(
        "iwan_segalman",
        "friction",
        (
            Parameter("kt", "N/m", "stiffness", 0.0, 0.95, off=0.0),
            Parameter("phimax", "m", "travel", 0.02, 20.0, (0.2, 0.6, 1.5), _LOG),
            Parameter("chi_plus_2", "-", "one", 1.05, 2.2, (1.5,), _LOG, (1.6, 0.3)),
            Parameter("beta", "-", "one", 0.01, 30.0, (0.3, 3.0), _LOG, (1.0, 1.5)),
        ),
        "Segalman 2005, J. Appl. Mech. 72, 752, eqs. (14) and (26) to (32): four "
        "parameters, dissipation ~ amplitude^(chi + 3)",
        {
            "iwan": "hits beyond gross slip: a break of the slope of the damping",
            "jenkins": "four levels below gross slip: the slope of damping",
        },
        report=_iwan_segalman_report,
        has_sliders=True,
        model_error=5e-5,
        generalises=("iwan", "jenkins"),
    ),
    ("link",),
    law=_iwan_segalman,
)
CLEARANCE = LumpedEffect(
    Effect(
        "clearance",
        "contact",
        (
            Parameter("k", "N/m", "stiffness", -0.9, 20.0, off=0.0),
            Parameter("half_width", "m", "travel", 0.004, 2.0, (0.1, 0.3, 0.7), _LOG),
            Parameter("offset", "-", "one", -4.0, 4.0, (-1.5, -0.5, 0.5, 1.5)),
        ),
        "Padmanabhan and Singh 1995, J. Sound Vib. 184, 767: clearance under a mean "
        "load; offset of the middle over half of the width",
        {"gap": "hit from both sides: a clearance has a second stop"},
        report=_clearance_report,
        generalises=("gap",),
    ),
    ("link",),
    law=_clearance,
)
QUADRATIC_CUBIC = LumpedEffect(
    Effect(
        "quadratic_cubic",
        "stiffness",
        (
            Parameter("k3", "N/m^3", "stiffness/travel^2", -5.0, 50.0, off=0.0),
            Parameter("k2_over_k3", "m", "travel", -10.0, 10.0, (-1.0, -0.2, 0.2, 1.0)),
        ),
        "Kovacic and Brennan 2011, The Duffing Equation, ch. 7: a spring with a "
        "square and a cube",
        {"gap": "more levels: a gap has a threshold, a polynomial has none"},
        report=_quadratic_cubic_report,
        generalises=("cubic_stiffness", "quadratic_stiffness"),
    ),
    ("link",),
    law=_quadratic_cubic,
)
CUBIC_QUINTIC = LumpedEffect(
    Effect(
        "cubic_quintic",
        "stiffness",
        (
            Parameter("k3", "N/m^3", "stiffness/travel^2", -5.0, 50.0, off=0.0),
            Parameter("k5_over_k3", "1/m^2", "1/travel^2", -5.0, 50.0, (-0.5, 1.0)),
        ),
        "Kerschen et al. 2006, Mech. Syst. Signal Process. 20, 505, sec. 2: odd "
        "polynomial spring",
        {"cubic_stiffness": "harder hits: a fifth power rises faster"},
        report=_cubic_quintic_report,
        generalises=("cubic_stiffness",),
    ),
    ("link",),
    law=_cubic_quintic,
)
POWER_DAMPING = LumpedEffect(
    Effect(
        "power_damping",
        "damping",
        (
            Parameter("force", "N", "force", 0.0, 5.0, off=0.0),
            Parameter("p", "-", "one", 0.5, 4.0, (0.6, 1.5, 2.5), _LOG),
        ),
        "Elliott, Ghandchi Tehrani and Langley 2015, Phil. Trans. R. Soc. A 373, "
        "20140402: damping force c |v|^p sgn v",
        {
            "coulomb": "damping falls with level as 1/amplitude for dry friction only",
            "quadratic_damping": "four levels: the slope of damping on amplitude",
        },
        report=_power_damping_report,
        generalises=("quadratic_damping",),
    ),
    ("link",),
    law=_power_damping,
)
REAL_JOINTS: tuple[LumpedEffect, ...] = (
    BOUC_WEN_FREE,
    IWAN_SEGALMAN,
    CLEARANCE,
    QUADRATIC_CUBIC,
    CUBIC_QUINTIC,
    POWER_DAMPING,
)
"""Effects beside the default catalogue."""
