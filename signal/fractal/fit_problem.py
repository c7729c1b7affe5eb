# SPDX-License-Identifier: MIT
"""The fit of a model to a structure function: data, lags and covariance."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, read_only
from jointbench.signal.fractal.levelling_loss import levelling_loss
from jointbench.signal.fractal.self_affine import (
    TIP_TOLERANCE,
    SeenSurface,
    rolled_off,
)
from jointbench.signal.fractal.structure_covariance import Seen, structure_covariance
from jointbench.signal.surface.structure_function import StructureFunction

PLANE_LOSS = 0.5
"""Loss by a mean plane over that by a mean line: between 0 and 1, unknown [-]."""

MAP_ERROR = 1e-3
"""Error of S at each lag of a map that its covariance does not include [-]: without it
one smooth clean map in ten is rejected at a level of 1 %, by directions in which
heights that are not levelled would hardly scatter."""
INDEPENDENT_ROWS = 8.0
"""Rows farther apart than this are independent profiles [samples]."""


@dataclass(frozen=True, slots=True)
class SeenInMetres:
    """Structure function of a measured surface over lags in metres.

    Attributes:
        surface: with lengths in samples.
        spacing: of the samples [m].
    """

    surface: SeenSurface
    spacing: float

    def __call__(self, lag: FloatArray) -> FloatArray:
        """Return the structure function at lags [m], of any shape."""
        return self.surface.seen(lag / self.spacing)


@dataclass(frozen=True, slots=True, eq=False)
class FractalProblem:
    """A structure function at the lags of a fit, with its covariance.

    Attributes:
        estimate: at the lags of the fit; all values above 0.
        covariance_of: relative covariance of the values for any model.
        tolerance: relative model error allowed at each lag in addition to its scatter
            [-].
        lag: lags of the estimate [samples], shape (n_lags,).
        pivot: geometric middle of the lags [samples].
        axes: directions in which the instrument acts: 2 on a map with related rows.
        least: smallest value of the structure function [m^2].
        log_pivot: natural logarithm of `pivot`.
        points: of a profile [-].
        loss_share: loss by levelling over that by a mean line [-].
    """

    estimate: StructureFunction
    covariance_of: Callable[[Seen], FloatArray]
    tolerance: float = 0.0
    lag: FloatArray = field(init=False)
    pivot: float = field(init=False)
    axes: int = field(init=False)
    least: float = field(init=False)
    log_pivot: float = field(init=False)
    points: float = field(init=False)
    loss_share: float = field(init=False)

    def __post_init__(self) -> None:
        """Work out the lags once: a search looks at them thousands of times."""
        lag = read_only(self.estimate.lag / self.estimate.spacing)
        points = float(self.estimate.points)
        part = 1.0 if self.estimate.separate else PLANE_LOSS
        object.__setattr__(self, "lag", lag)
        object.__setattr__(self, "pivot", float(np.sqrt(lag[0] * lag[-1])))
        object.__setattr__(self, "log_pivot", math.log(self.pivot))
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "loss_share", part)
        object.__setattr__(self, "axes", _axes(self.estimate))
        object.__setattr__(self, "least", float(self.estimate.value.min()))

    def loss(self, seen: SeenSurface) -> FloatArray:
        """Return the loss of S by levelling at the fit's lags [m^2].

        A surface with a corner within the profile has a smaller slope, and so a smaller
        loss.
        """
        points, part = self.points, self.loss_share
        unit = levelling_loss(self.lag / points, seen.exponent)
        power = seen.amplitude * points**seen.exponent
        if np.isfinite(seen.corner):
            ceiling = seen.amplitude * seen.corner**seen.exponent
            kept = rolled_off(np.array(power), ceiling) / power
            power *= float(kept) ** 2
        loss: FloatArray = part * power * unit
        return loss

    def predicted(self, seen: SeenSurface) -> FloatArray:
        """Return the expected structure function of the levelled surface [m^2]."""
        predicted: FloatArray = seen.seen(self.lag) - self.loss(seen)
        return predicted

    @property
    def tails(self) -> float:
        """Variance of S over that of Gaussian differences [-].

        The variance of a mean of squares is in proportion to kurtosis - 1.
        """
        return max(1.0, (float(np.median(self.estimate.kurtosis)) - 1) / 2)

    def scatter(self, seen: SeenSurface) -> FloatArray:
        """Return the covariance of S over the S of `seen`, shape (n, n) [-]."""
        spacing = self.estimate.spacing
        scatter = self.covariance_of(SeenInMetres(seen, spacing))
        tailed: FloatArray = self.tails * scatter
        return tailed

    def model_error(self, seen: SeenSurface) -> FloatArray:
        """Return the covariance of the model error, as `scatter` [-].

        With a tolerance, and on a map, the whole loss by levelling is added as an
        unknown of that size: the loss by a mean plane is not known, and a surface may
        lack waves longer than the profile, which bends S in the same way. The loss of a
        self-affine profile is known exactly, the form of a tip's path to one percent.
        The covariance of a map is that of heights that are not levelled: `MAP_ERROR`.
        """
        if seen.traced:
            return TIP_TOLERANCE**2 * np.eye(self.lag.size)
        if self.tolerance == 0 and self.estimate.separate:
            return np.zeros((self.lag.size, self.lag.size))
        loss = self.loss(seen) / seen.seen(self.lag)
        spread = np.hypot(self.tolerance, 0.0 if self.estimate.separate else MAP_ERROR)
        error: FloatArray = spread**2 * np.eye(loss.size)
        return error + np.outer(loss, loss)

    def within(self, keep: BoolArray) -> "FractalProblem":
        """Return the problem at the lags marked in `keep` only."""
        whole, chosen = self.covariance_of, np.ix_(keep, keep)
        return replace(
            self,
            estimate=self.estimate.only(keep),
            covariance_of=lambda seen: whole(seen)[chosen],
        )

    def straight(self, *, up_to: float = np.inf) -> SeenSurface:
        """Return the unweighted power law through the values, as a start.

        Args:
            up_to: longest lag to use [samples]; at least three lags are used.
        """
        count = max(3, int(np.count_nonzero(self.lag <= up_to)))
        log_lag, log_value = (
            np.log(self.lag[:count]),
            np.log(self.estimate.value[:count]),
        )
        middle = float(log_lag.mean())
        place = log_lag - middle
        slope = float(place @ log_value) / float(place @ place)
        exponent = min(max(slope, 0.1), 1.9)
        level = float(log_value.mean()) - exponent * middle
        return SeenSurface(exponent=exponent, amplitude=math.exp(level))


def pose(estimate: StructureFunction, *, tolerance: float = 0.0) -> FractalProblem:
    """Prepare the fit of a structure function at its lags."""
    return FractalProblem(estimate, structure_covariance(estimate), tolerance)


def _axes(estimate: StructureFunction) -> int:
    """Return 2 for a map with related rows, 1 for profiles and independent rows."""
    sampling = estimate.samplings[0]
    hangs_together = sampling.row_distance < INDEPENDENT_ROWS * sampling.spacing
    return 2 if sampling.profiles > 1 and hangs_together else 1
