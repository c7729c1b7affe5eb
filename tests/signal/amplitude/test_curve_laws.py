# SPDX-License-Identifier: MIT
"""Laws on curves of known joints; curves that turn round like a beat."""

import numpy as np
import pytest
from jointed_masses import equivalent, micro_slip

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.amplitude.amplitude_curve import Dependence
from jointbench.signal.amplitude.curve_laws import fit_laws
from jointbench.signal.amplitude.curve_of_fit import LevelCurve, clear_turns
from jointbench.signal.amplitude.dependence_test import (
    Change,
    DependenceEvidence,
    change_of,
    decide,
)

OMEGA, ZETA = 500.0, 0.005


def curve_of(level: FloatArray, omega: FloatArray, zeta: FloatArray) -> LevelCurve:
    """Return a curve whose ln omega is known to 10 ppm and ln zeta to 0.2 %."""
    own = np.eye(level.size)
    none = np.zeros(level.size)
    return LevelCurve(
        level=level,
        log_omega=np.log(omega),
        log_zeta=np.log(zeta),
        omega_covariance=1e-5**2 * own,
        zeta_covariance=2e-3**2 * own,
        cross_covariance=0.0 * own,
        channel=0,
        inflation=1.0,
        omega_model_sd=none,
        zeta_model_sd=none,
    )


@pytest.mark.parametrize("exponent", [0.5, 0.8, 1.1])
def test_the_exponent_is_that_of_the_sliders_above_the_smallest(
    exponent: float,
) -> None:
    """Sliders from a thousandth on, amplitudes from 1e-4: the law has an onset."""
    joint = micro_slip(1.0, 1.0, exponent, sliders=400)
    sizes = np.geomspace(1e-4, 1.0, 40)
    stuck = float(joint.slider_stiffness.sum())
    stiff = np.array([equivalent(joint, float(a), OMEGA) for a in sizes])
    change = 0.04 * (stiff - stuck)
    omega = OMEGA * np.sqrt(1.0 + change.real)
    zeta = (ZETA + 0.5 * change.imag) * OMEGA**2 / omega**2
    curve = curve_of(np.log(sizes), omega, zeta)
    best = fit_laws(curve, change_of(curve), 0)[0]
    assert best.name == "micro-slip power law"
    assert abs(best.exponent - exponent) < 1.96 * best.exponent_sd
    assert best.exponent_sd < 0.01
    assert best.chi2 < 2 * sizes.size


def swinging() -> LevelCurve:
    """Return a curve that swings by 100 ppm four times over ten units of ln a."""
    level = np.linspace(-10.0, 0.0, 40)
    omega = OMEGA * (1.0 + 1e-4 * np.sin(0.8 * np.pi * level))
    return curve_of(level, omega, np.full(40, ZETA))


def test_a_beat_turns_round_once_each_half_period_and_a_law_does_not() -> None:
    """Eight half periods have seven or eight turns; a softening curve has none."""
    level = np.linspace(-10.0, 0.0, 40)
    soft = curve_of(level, OMEGA * (1 - 0.01 * np.exp(level)), np.full(40, ZETA))
    assert clear_turns(swinging()) in (7, 8)
    assert clear_turns(soft) == 0


def test_a_curve_that_swings_is_called_a_beat() -> None:
    """Whatever the other signs say, its outcome is not decided, with the reason."""
    change = Change(-0.01, 1e-4, 0.001, 1e-5, ZETA, (-10.0, 0.0))
    signs = (0.0, 0.95, 3.0, 1.0, change, change, 0.0, "")
    assert decide(DependenceEvidence(*signs))[0] is Dependence.DEPENDS
    turns = clear_turns(swinging())
    outcome, reason = decide(DependenceEvidence(*signs, turns))
    assert outcome is Dependence.NOT_DECIDED
    assert reason.startswith("a beat: the curve turns round")
