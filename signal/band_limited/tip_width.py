# SPDX-License-Identifier: MIT
"""The blur that a stylus of known radius causes on a surface."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.band_limited.known_transfer import KnownTransfer
from jointbench.signal.band_limited.matern_spectrum import BandLimited
from jointbench.signal.surface.structure_constant import spectral_integral

SHARE = 0.64
"""Width of the blur over the contact length [-]: mean of exact paths of tips of 2 and 5
um on profiles of H = 0.3 to 0.85, three of each; it depends on neither."""
SPREAD = 0.14
"""Standard deviation of its logarithm [-]: 0.085 over 60 paths of tips exactly as
stated, and 0.08 to 0.13 by the radius, which is within 25 % of the stated one (ISO
3274, 2 um); the width goes with its 1 / (2 - H)."""
_NUDGE = 0.1
"""Step of the derivatives over a standard deviation [-]."""
_SMOOTHEST = 0.95
"""Highest H at which S at short lags follows from the power law [-]."""


class TracedSample(Protocol):
    """Heights of lines or of a map, in units of their pitch and root mean square."""

    @property
    def transfer(self) -> KnownTransfer:
        """What the instrument is known to do."""
        ...

    @property
    def scale(self) -> float:
        """Root mean square of the heights [m]."""
        ...

    @property
    def pitch(self) -> float:
        """Distance of neighbours [m]."""
        ...


def contact_length(model: BandLimited, sample: TracedSample) -> float:
    """Return the lag at which the tip bends as the surface does [samples].

    There the root of S is the square of the lag over the radius: a parabola and a
    self-affine profile have this one length in common.
    """
    radius = sample.transfer.tip or 0.0
    exponent = 2 * min(model.hurst, _SMOOTHEST)
    far = np.array(2 * np.pi)
    power = float(model.surface(far)) * float(far) ** (1 + exponent)
    step = 4 * power * float(spectral_integral(exponent))
    steepness = step * (sample.scale / sample.pitch) ** 2
    return float((steepness * radius**2) ** (1 / (4 - exponent)))


def tip_surprise(model: BandLimited, sample: TracedSample) -> float:
    """Return how far the blur is from that of the stated tip, in standard deviations.

    Zero without a stated radius.
    """
    if sample.transfer.tip is None:
        return 0.0
    width = SHARE * contact_length(model, sample)
    return float((np.sqrt(model.blur) / width - 1) / SPREAD)


def tip_deviation(
    surprise: Callable[[FloatArray], float], at: FloatArray, covariance: FloatArray
) -> float:
    """Return a surprise over the scatter of the fit and of the prior together [sd].

    Args:
        surprise: of parameters, as `tip_surprise`.
        at: the most likely parameters without the tip as a prior, shape (n,).
        covariance: of the parameters, 0 where they were held, shape (n, n).
    """
    slopes = np.zeros(at.size)
    for k in np.flatnonzero(np.diag(covariance) > 0):
        moved = at.copy()
        moved[k] += _NUDGE * np.sqrt(covariance[k, k])
        slopes[k] = (surprise(moved) - surprise(at)) / (moved[k] - at[k])
    return surprise(at) / float(np.sqrt(1 + slopes @ covariance @ slopes))


def tip_information(parameters: FloatArray, width: float) -> float:
    """Return the information of a stated tip on the blur, the fourth parameter."""
    blur = max(float(parameters[3]), 0.01 * width**2)
    return float(0.25 / (blur * (SPREAD * width) ** 2))
