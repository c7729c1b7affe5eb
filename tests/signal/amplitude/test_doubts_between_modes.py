# SPDX-License-Identifier: MIT
"""Weak modes at multiples of a strong one, and modes that beat, are not decided."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.signal.amplitude.amplitude_curve import (
    AmplitudeCurve,
    AmplitudeMode,
    Dependence,
    SoftLimit,
)
from jointbench.signal.amplitude.doubts_between_modes import with_doubts


def mode(frequency: float, largest: float, change: float = 0.0) -> AmplitudeMode:
    """Return a mode that depends on amplitude, up to an acceleration."""
    one = np.ones(3)
    curve = AmplitudeCurve(
        np.geomspace(0.1, 1.0, 3) * largest,
        frequency * one,
        one,
        0.01 * one,
        one,
        "a1@1",
        "m/s^2",
        one,
        one,
    )
    soft = SoftLimit(frequency, 0.1, 0.005, 1e-4)
    return AmplitudeMode(Dependence.DEPENDS, "", curve, soft, 0.0, 1.0, 9.0, change)


@pytest.mark.parametrize(
    ("frequency", "largest", "outcome"),
    [
        (240.1, 1.0, Dependence.NOT_DECIDED),
        (160.0, 1.0, Dependence.NOT_DECIDED),
        (250.0, 1.0, Dependence.DEPENDS),
        (240.1, 400.0, Dependence.DEPENDS),
    ],
)
def test_a_weak_mode_at_a_multiple_is_not_decided(
    frequency: float, largest: float, outcome: Dependence
) -> None:
    """Beside 80 Hz of 400 m/s2: at three or two times, elsewhere, as strong."""
    strong, other = with_doubts((mode(80.0, 400.0), mode(frequency, largest)))
    assert strong.dependence is Dependence.DEPENDS
    assert other.dependence is outcome


@pytest.mark.parametrize(
    ("frequency", "change", "outcome"),
    [
        (84.0, -0.004, Dependence.NOT_DECIDED),
        (84.0, -0.0005, Dependence.DEPENDS),
        (100.0, -0.004, Dependence.DEPENDS),
    ],
)
def test_modes_that_beat_on_a_joint_are_not_decided(
    frequency: float, change: float, outcome: Dependence
) -> None:
    """5 % from 80 Hz with a change of 0.4 %, of 0.05 %; 25 % from it."""
    found = with_doubts((mode(80.0, 1.0), mode(frequency, 1.0, change)))
    assert [one.dependence for one in found] == [outcome, outcome]


def test_a_mode_beats_with_one_that_seems_not_to_depend() -> None:
    """The joint works both modes; which of them shows it is a matter of noise."""
    still = replace(mode(80.0, 1.0), dependence=Dependence.NONE)
    found = with_doubts((still, mode(84.0, 1.0, -0.004)))
    outcomes = [one.dependence for one in found]
    assert outcomes == [Dependence.NONE, Dependence.NOT_DECIDED]
