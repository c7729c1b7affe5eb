# SPDX-License-Identifier: MIT
"""Measured curves of modes next to those that explanations predict."""

from dataclasses import replace

import gap_bench as made
import numpy as np
import pytest

from jointbench.analysis.gap.diagnosis.amplitude_evidence import (
    CONSISTENT,
    INCONSISTENT,
    OPEN,
    MeasuredCurves,
    amplitude_evidence,
)
from jointbench.analysis.gap.diagnosis.predicted_modes import (
    MeasuredPlace,
    predicted_curve,
)
from jointbench.analysis.gap.model.curve_records import curve_evidence_json
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.search.descent import minimise
from jointbench.signal.amplitude.amplitude_curve import (
    AmplitudeCurve,
    AmplitudeMode,
    Dependence,
    SoftLimit,
)
from jointbench.station.gap.curve_section import curve_section

K3 = 0.05 * made.NOMINAL["kj"] / 1.8e-5**2
AMPLITUDE = np.geomspace(3.0, 300.0, 20)
UPPER = 1


@pytest.fixture(scope="module")
def bench() -> LumpedBench:
    """Return a bench with a hardening joint."""
    return make_bench(
        made.made_campaign([("cubic_stiffness", "link:joint", [K3])], noise=0.5)
    )


@pytest.fixture(scope="module")
def fits(bench: LumpedBench) -> dict[str, Fit]:
    """Return the base, the hidden law, and one of the other sign."""
    found = {"base": minimise(make_problem(bench, ()), made.BASE, MIDDLE, iterations=1)}
    for name, k3 in (("hard", K3), ("soft", -K3)):
        term = made.term_of(bench, "cubic_stiffness", "link:joint", [k3])
        problem = make_problem(bench, (term.candidate,))
        start = np.concatenate([made.BASE, term.coordinates])
        found[name] = replace(minimise(problem, start, MIDDLE, iterations=0), x=start)
    return found


def harmonic_balance(bench: LumpedBench, response: float) -> complex:
    """Return the upper pole of two bodies at an acceleration of the second one.

    Fixed point of the equivalent stiffness 3/4 k3 a^2 at the motion across the joint.
    """
    m1, m2, k0, kj, c0, cj = bench.theta(made.BASE)
    pole, stiffness = 0j, 0.0
    for _ in range(60):
        k = np.array([[k0 + kj + stiffness, -kj - stiffness]] * 2)
        k[1] = [-kj - stiffness, kj + stiffness]
        c = np.array([[c0 + cj, -cj], [-cj, cj]])
        inverse = np.diag([1 / m1, 1 / m2])
        state = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ k, -inverse @ c]])
        poles, shapes = np.linalg.eig(state)
        upper = np.argmax(poles.imag)
        pole, shape = poles[upper], shapes[:2, upper]
        motion = response * abs((shape[1] - shape[0]) / shape[1]) / abs(pole) ** 2
        stiffness = 0.75 * K3 * motion**2
    return complex(pole)


def measured(
    bench: LumpedBench, outcome: Dependence = Dependence.DEPENDS, sd: float = 0.3
) -> AmplitudeMode:
    """Return the upper mode over amplitude, without errors."""
    poles = np.array([harmonic_balance(bench, a) for a in AMPLITUDE])
    frequency, size = np.abs(poles) / (2 * np.pi), np.ones(AMPLITUDE.size)
    curve = AmplitudeCurve(
        amplitude=AMPLITUDE,
        frequency=frequency,
        frequency_sd=sd * size,
        damping_ratio=-poles.real / np.abs(poles),
        damping_sd=sd / 3000 * size,
        channel="a1@m2",
        unit="m/s^2",
        frequency_noise_sd=sd * size,
        damping_noise_sd=sd / 3000 * size,
    )
    soft = SoftLimit(float(frequency[0]), sd, 0.01, 1e-4)
    return AmplitudeMode(outcome, "made", curve, soft, 0.0, 1.0, 1.0)


def test_a_predicted_curve_is_that_of_harmonic_balance(
    bench: LumpedBench, fits: dict[str, Fit]
) -> None:
    """Frequency to 20 ppm and damping to 0.1 % of two bodies computed apart."""
    found = predicted_curve(bench, fits["hard"], MeasuredPlace(UPPER, 1, AMPLITUDE))
    poles = np.array([harmonic_balance(bench, a) for a in AMPLITUDE])
    frequency = np.abs(poles) / (2 * np.pi)
    assert frequency[-1] > 1.005 * frequency[0]
    assert found.frequency == pytest.approx(frequency, rel=2e-5)
    assert found.damping == pytest.approx(-poles.real / np.abs(poles), rel=1e-3)
    assert np.all(np.diff(found.motion) > 0) and np.all(found.frequency_sd > 0)


def test_a_curve_speaks_for_the_right_law_and_against_others(
    bench: LumpedBench, fits: dict[str, Fit]
) -> None:
    """The hidden law is consistent; the other sign and no law are not."""
    shown = [fits["hard"], fits["soft"]]
    curves = MeasuredCurves((measured(bench),), hits=7)
    evidence = amplitude_evidence(bench, fits["base"], shown, curves)
    lower, upper = evidence.modes
    assert "no measured mode" in lower.words and not lower.matches
    right, wrong, flat = upper.matches
    assert (right.words, wrong.words, flat.words) == (
        CONSISTENT,
        INCONSISTENT,
        INCONSISTENT,
    )
    assert right.scale == pytest.approx(1.0, abs=0.02)
    assert "rises by" in upper.words and "across the joint" in upper.words
    assert "cubic_stiffness@link:joint predicts +" in upper.words
    section = curve_section(evidence)
    assert [item.kind for item in section.items] == ["text", "text", "table", "figure"]
    content = curve_evidence_json(evidence)
    assert content is not None and content["modes"][1]["predicted"][2]["scale"] is None


def test_a_curve_that_is_not_decided_decides_nothing(
    bench: LumpedBench, fits: dict[str, Fit]
) -> None:
    """Nor does one whose uncertainty exceeds the change."""
    for mode in (
        measured(bench, Dependence.NOT_DECIDED),
        measured(bench, Dependence.NONE, sd=300.0),
    ):
        evidence = amplitude_evidence(
            bench, fits["base"], [fits["soft"]], MeasuredCurves((mode,))
        )
        assert evidence.modes[1].matches[0].words == OPEN


def test_without_curves_the_reason_is_stated(
    bench: LumpedBench, fits: dict[str, Fit]
) -> None:
    """No hits, or a mode whose levels cannot be compared."""
    none = amplitude_evidence(bench, fits["base"], [], MeasuredCurves(reason="no hits"))
    assert none.words == ("curves cannot be determined: no hits",)
    mode = replace(measured(bench, Dependence.NOT_DECIDED), curve=None)
    open_ = amplitude_evidence(bench, fits["base"], [], MeasuredCurves((mode,)))
    assert "cannot be determined: made" in open_.words[1]
