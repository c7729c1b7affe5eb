# SPDX-License-Identifier: MIT
"""Weak modes at multiples of a strong one's frequency are not decided."""

import numpy as np
import pytest

from jointbench.signal.amplitude.amplitude_curve import (
    AmplitudeCurve,
    AmplitudeMode,
    Dependence,
    SoftLimit,
)
from jointbench.signal.amplitude.harmonics_of_joint import without_harmonics


def mode(frequency: float, largest: float) -> AmplitudeMode:
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
    return AmplitudeMode(Dependence.DEPENDS, "", curve, soft, 0.0, 1.0, 9.0)


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
    strong, other = without_harmonics((mode(80.0, 400.0), mode(frequency, largest)))
    assert strong.dependence is Dependence.DEPENDS
    assert other.dependence is outcome
