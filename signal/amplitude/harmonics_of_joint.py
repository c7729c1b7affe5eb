# SPDX-License-Identifier: MIT
"""Modes that may be harmonics of a joint's force under a stronger mode."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.signal.amplitude.amplitude_curve import (
    AmplitudeCurve,
    AmplitudeMode,
    Dependence,
)

# Symmetric joints have odd harmonics; unsymmetric ones (openings) even ones as well.
_ORDERS = (2, 3)
# A harmonic is this close to a multiple of the mode's frequency, and weaker in
# displacement than this share of it.
_CLOSE, _WEAKER = 0.005, 0.05


def without_harmonics(found: Sequence[AmplitudeMode]) -> tuple[AmplitudeMode, ...]:
    """Return the modes; what may be a harmonic of a stronger one is not decided.

    Args:
        found: all modes of a structure.
    """
    return tuple(_doubted(mode, found) for mode in found)


def _doubted(mode: AmplitudeMode, found: Sequence[AmplitudeMode]) -> AmplitudeMode:
    if mode.dependence is not Dependence.DEPENDS or mode.curve is None:
        return mode
    for strong in found:
        if strong.dependence is not Dependence.DEPENDS or strong.curve is None:
            continue
        ratio = mode.soft.frequency / strong.soft.frequency
        close = any(abs(ratio / order - 1.0) < _CLOSE for order in _ORDERS)
        if close and _size(mode.curve) < _WEAKER * _size(strong.curve):
            return replace(
                mode,
                dependence=Dependence.NOT_DECIDED,
                reason=f"{ratio:.3f} times the frequency of the stronger mode at "
                f"{strong.soft.frequency:.5g} Hz: may be a harmonic of the joint's "
                "force",
                family="",
                laws=(),
            )
    return mode


def _size(curve: AmplitudeCurve) -> float:
    """Return the largest amplitude over omega^2: proportional to displacement."""
    return float(np.max(curve.amplitude / curve.frequency**2))
