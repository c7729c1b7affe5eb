# SPDX-License-Identifier: MIT
"""What modes do to each other that their own fits do not show: harmonics and beats.

A weak mode may be a harmonic of a joint's force under a stronger one. Two modes close
together on one joint beat: its motion is no slow function of time, and the error is of
the order of the change of frequency over the distance of the modes.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.signal.amplitude.amplitude_curve import (
    AmplitudeMode,
    Dependence,
)

# Symmetric joints have odd harmonics; unsymmetric ones (openings) even ones as well.
_ORDERS = (2, 3)
# A harmonic is this close to a multiple of the mode's frequency, and weaker in
# displacement than this share of it.
_CLOSE, _WEAKER = 0.005, 0.05
# Modes this close beat on a joint; the larger change of frequency may be this share of
# their distance (docs/decisions/0192).
_BESIDE, _BEAT = 0.1, 0.012


def with_doubts(found: Sequence[AmplitudeMode]) -> tuple[AmplitudeMode, ...]:
    """Return the modes; harmonics and strong beats are not decided.

    Args:
        found: all modes of a structure.
    """
    return tuple(_doubted(mode, found) for mode in found)


def _doubted(mode: AmplitudeMode, found: Sequence[AmplitudeMode]) -> AmplitudeMode:
    for other in found:
        if other is mode or not _depends(mode) or other.curve is None:
            continue
        beat = _beat(mode, other)
        words = (_harmonic(mode, other) if _depends(other) else "") or beat
        if words:
            return replace(
                mode,
                dependence=Dependence.NOT_DECIDED,
                reason=words,
                family="",
                laws=(),
                # The band of a curve does not know what a beat moves.
                curve=None if beat else mode.curve,
            )
    return mode


def _depends(mode: AmplitudeMode) -> bool:
    return mode.dependence is Dependence.DEPENDS and mode.curve is not None


def _harmonic(mode: AmplitudeMode, strong: AmplitudeMode) -> str:
    """Return why a mode may be a harmonic, or nothing."""
    ratio = mode.soft.frequency / strong.soft.frequency
    close = any(abs(ratio / order - 1.0) < _CLOSE for order in _ORDERS)
    if not close or _size(mode) >= _WEAKER * _size(strong):
        return ""
    return (
        f"{ratio:.3f} times the frequency of the stronger mode at "
        f"{strong.soft.frequency:.5g} Hz: may be a harmonic of the joint's force"
    )


def _beat(mode: AmplitudeMode, other: AmplitudeMode) -> str:
    """Return why two modes are not resolved, or nothing."""
    apart = abs(other.soft.frequency / mode.soft.frequency - 1.0)
    change = max(abs(mode.frequency_change), abs(other.frequency_change))
    if apart > _BESIDE or change <= _BEAT * apart:
        return ""
    return (
        f"not resolved from the mode at {other.soft.frequency:.5g} Hz: frequency "
        f"changes by {100 * change:.2g} %, over {100 * _BEAT:g} % of their distance"
    )


def _size(mode: AmplitudeMode) -> float:
    """Return the largest amplitude over omega^2: proportional to displacement."""
    curve = mode.curve
    assert curve is not None
    return float(np.max(curve.amplitude / curve.frequency**2))
