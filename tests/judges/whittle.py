# SPDX-License-Identifier: MIT
"""D by the spectrum of the height differences: a check that uses no lags."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Profile

ALIASES = 30
"""Images of the spectrum on each side that sampling folds in [-]."""
FEWEST_POINTS = 64
HURST_RANGE = (0.02, 0.98)


@dataclass(frozen=True, slots=True)
class WhittleFit:
    """D of a clean self-affine profile by Whittle's likelihood.

    Attributes:
        dimension: D [-].
        dimension_sd: its standard deviation, the Cramer-Rao bound [-].
        spectral_dimension: D by a straight line through lg PSD over lg frequency, as
            a rough second check [-].
    """

    dimension: float
    dimension_sd: float
    spectral_dimension: float


def fit_whittle(profile: Profile) -> WhittleFit:
    """Fit the spectrum of the increments of a profile without gaps or instrument.

    Args:
        profile: complete; noise or blur would move D, as it is not modelled here.

    Returns:
        D, its bound and the slope of the spectrum.

    Raises:
        UsageError: points are missing, or there are fewer than 64.

    Source:
        Whittle, Ark. Mat. 2 (1953) 423; spectrum of fractional Gaussian noise: Sinai,
        Theory Probab. Appl. 21 (1976) 64.
    """
    count = profile.heights.size
    if not profile.valid.all() or count < FEWEST_POINTS:
        raise UsageError(
            f"profile {profile.name!r} has {int(profile.valid.sum())} of {count} "
            f"points measured; the spectrum needs {FEWEST_POINTS} and no gap"
        )
    increments = np.diff(profile.heights)
    increments = increments - increments.mean()
    power = np.abs(np.fft.rfft(increments))[1:-1] ** 2
    omega = 2 * np.pi * np.arange(1, power.size + 1) / increments.size

    def deviance(hurst: float) -> float:
        shape = _log_shape(omega, hurst)
        return float(np.log(np.mean(power / np.exp(shape))) + shape.mean())

    best = minimize_scalar(deviance, bounds=HURST_RANGE, method="bounded")
    hurst = float(best.x)
    turn = (_log_shape(omega, hurst + 1e-4) - _log_shape(omega, hurst - 1e-4)) / 2e-4
    return WhittleFit(
        dimension=2 - hurst,
        dimension_sd=float(1 / np.sqrt(omega.size * np.var(turn))),
        spectral_dimension=_line(omega, power),
    )


def _log_shape(omega: FloatArray, hurst: float) -> FloatArray:
    """Return ln of the sampled spectrum of the increments, up to a constant."""
    power = -1 - 2 * hurst
    total = omega**power
    for k in range(1, ALIASES + 1):
        total += (2 * np.pi * k + omega) ** power + (2 * np.pi * k - omega) ** power
    # What lies beyond the last image, as an integral.
    beyond = (
        2 * (2 * np.pi * (ALIASES + 0.5)) ** (power + 1) / (2 * np.pi * -(power + 1))
    )
    shape: FloatArray = np.log(4 * np.sin(omega / 2) ** 2 * (total + beyond))
    return shape


def _line(omega: FloatArray, power: FloatArray) -> float:
    """Return D by the slope of the heights' spectrum, f^(-1-2H), below a fifth."""
    low = omega < 0.2 * np.pi
    heights = power[low] / (4 * np.sin(omega[low] / 2) ** 2)
    slope = np.polyfit(np.log(omega[low]), np.log(heights), 1)[0]
    return float(2 + (slope + 1) / 2)
