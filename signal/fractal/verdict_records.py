# SPDX-License-Identifier: MIT
"""Records of the result of a fractal fit."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.array_checks import require_ascending, require_shape
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.records.provenance import Provenance

NORMAL_97_5 = 1.959963984540054
"""97.5 % point of the normal distribution [-]."""
WIDEST_ROUGHNESS = 10.0
"""Widest 95 % interval of G, as a factor, at which G is reported [-]."""


class SurfaceVerdict(StrEnum):
    """Verdict on the scaling of roughness with the lag."""

    FRACTAL = "fractal"
    BAND = "fractal within a band"
    INSTRUMENT = "instrument-limited"
    NONE = "no scaling range"


@dataclass(frozen=True, slots=True)
class InstrumentParameter:
    """One number of the instrument, fitted with the surface.

    Attributes:
        name: ``"noise"`` (standard deviation of each height) or
            ``"point_spread"`` (standard deviation of the Gaussian blur, or of the one
            with the same effect on long waves as a stylus).
        value: [m].
        sd: its standard deviation [m].
    """

    name: str
    value: float
    sd: float


@dataclass(frozen=True, slots=True, eq=False)
class LocalSlope:
    """Slope of ln S over ln lag, lag by lag.

    Attributes:
        lag: [m], shape (n,), ascending.
        slope: 4 - 2D where S is straight [-], same shape.
        sd: standard deviation [-], same shape.
    """

    lag: FloatArray
    slope: FloatArray
    sd: FloatArray

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_ascending("lag", self.lag)
        require_shape("slope", self.slope, self.lag.shape)
        require_shape("sd", self.sd, self.lag.shape)
        freeze(self, "lag", "slope", "sd")


@dataclass(frozen=True, slots=True, eq=False)
class FittedCurve:
    """The fitted structure function, for a plot.

    Attributes:
        lag: [m], shape (n,), ascending.
        value: with instrument and levelling [m^2], same shape.
        surface: of the surface itself, a straight line in the logarithms [m^2].
    """

    lag: FloatArray
    value: FloatArray
    surface: FloatArray

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_ascending("lag", self.lag)
        require_shape("value", self.value, self.lag.shape)
        require_shape("surface", self.surface, self.lag.shape)
        freeze(self, "lag", "value", "surface")


@dataclass(frozen=True, slots=True, eq=False)
class Scaling:
    """The power law found, at a pivot where its two numbers are nearly independent.

    Attributes:
        dimension: D of a profile [-].
        dimension_sd: its standard deviation [-].
        pivot: lag in the middle of the fit [m].
        pivot_value: S of the surface itself there [m^2].
        covariance: of (D, ln `pivot_value`), shape (2, 2) [-].
        roughness: G [m].
        roughness_interval: 2.5 % and 97.5 % points of G, log-normal [m].
    """

    dimension: float
    dimension_sd: float
    pivot: float
    pivot_value: float
    covariance: FloatArray
    roughness: float
    roughness_interval: tuple[float, float]

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_shape("covariance", self.covariance, (2, 2))
        freeze(self, "covariance")

    @property
    def roughness_known(self) -> bool:
        """Whether the interval of G is within a decade, so that G can be reported."""
        low, high = self.roughness_interval
        return bool(high <= WIDEST_ROUGHNESS * low)

    @property
    def pivot_value_interval(self) -> tuple[float, float]:
        """2.5 % and 97.5 % points of S at the pivot, log-normal [m^2]."""
        reach = float(np.exp(NORMAL_97_5 * np.sqrt(self.covariance[1, 1])))
        return self.pivot_value / reach, self.pivot_value * reach


@dataclass(frozen=True, slots=True, eq=False)
class FractalFit:
    """Result of the fractal fit of a structure function.

    Attributes:
        verdict: on the scaling.
        reason: one line with the numbers.
        scaling: the power law, or None where there is no scaling range.
        fit_band: shortest and longest lag at which the surface itself dominates S [m].
        chi2_per_dof: of the fit, or None where none was accepted [-].
        instrument: instrument model by name, ``"none"`` if none was needed.
        instrument_parameters: its numbers, of the accepted fit.
        local_slope: slope lag by lag, for every verdict.
        curve: the accepted fit, or None.
        provenance: of the structure function and the fit.
    """

    verdict: SurfaceVerdict
    reason: str
    scaling: Scaling | None
    fit_band: tuple[float, float] | None
    chi2_per_dof: float | None
    instrument: str
    instrument_parameters: tuple[InstrumentParameter, ...]
    local_slope: LocalSlope
    curve: FittedCurve | None
    provenance: Provenance = field(default=())

    @property
    def dimension(self) -> float | None:
        """D of a profile [-], None without a scaling range."""
        return None if self.scaling is None else self.scaling.dimension

    @property
    def dimension_sd(self) -> float | None:
        """Standard deviation of D [-], None without a scaling range."""
        return None if self.scaling is None else self.scaling.dimension_sd

    @property
    def roughness(self) -> float | None:
        """G [m], None without a scaling range; valid only with its interval."""
        return None if self.scaling is None else self.scaling.roughness

    @property
    def roughness_interval(self) -> tuple[float, float] | None:
        """2.5 % and 97.5 % points of G [m], None without a scaling range."""
        return None if self.scaling is None else self.scaling.roughness_interval

    @property
    def pivot(self) -> float | None:
        """Lag in the middle of the fit [m], None without a scaling range."""
        return None if self.scaling is None else self.scaling.pivot

    @property
    def pivot_value(self) -> float | None:
        """S of the surface at the pivot [m^2], None without a scaling range."""
        return None if self.scaling is None else self.scaling.pivot_value

    @property
    def covariance(self) -> FloatArray | None:
        """Covariance of (D, ln S at the pivot), None without a scaling range."""
        return None if self.scaling is None else self.scaling.covariance
