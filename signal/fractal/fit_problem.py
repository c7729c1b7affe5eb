# SPDX-License-Identifier: MIT
"""What a structure function and a model of it have to say to each other in a fit."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, read_only
from jointbench.signal.fractal.levelling_loss import levelling_loss
from jointbench.signal.fractal.self_affine import TIP_TOLERANCE, SeenSurface, rolled_off
from jointbench.signal.fractal.structure_covariance import Seen, structure_covariance
from jointbench.signal.surface.structure_function import StructureFunction

PLANE_LOSS = 0.5
"""Part of a mean line's loss that a mean plane costs: between 0 and 1, unknown [-]."""

INDEPENDENT_ROWS = 8.0
"""Rows farther apart than this are profiles of their own [samples]."""


@dataclass(frozen=True, slots=True, eq=False)
class FractalProblem:
    """A structure function at the lags of a fit, with its covariance laid out.

    Attributes:
        estimate: at the lags of the fit; all values above 0.
        covariance_of: relative covariance of the values for any model.
        tolerance: relative misfit allowed at each lag beside its scatter [-].
        lag: lags of the estimate [samples], shape (n_lags,).
    """

    estimate: StructureFunction
    covariance_of: Callable[[Seen], FloatArray]
    tolerance: float = 0.0
    lag: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        """Work out the lags once: a search looks at them thousands of times."""
        lag = self.estimate.lag / self.estimate.spacing
        object.__setattr__(self, "lag", read_only(lag))

    @property
    def pivot(self) -> float:
        """Geometric middle of the lags [samples]."""
        return float(np.sqrt(self.lag[0] * self.lag[-1]))

    @property
    def axes(self) -> int:
        """Directions the instrument acts in: all around on a map whose rows relate."""
        face = self.estimate.faces[0]
        hangs_together = face.row_distance < INDEPENDENT_ROWS * face.spacing
        return 2 if face.profiles > 1 and hangs_together else 1

    def loss(self, seen: SeenSurface) -> FloatArray:
        """Return what levelling takes from S at the fit's lags [m^2].

        A surface that stops growing rougher within the profile has less of a slope
        to lose.
        """
        points = float(self.estimate.points)
        part = 1.0 if self.estimate.separate else PLANE_LOSS
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
        """How much more S scatters than for Gaussian differences [-].

        The variance of a mean of squares is in proportion to kurtosis - 1.
        """
        return max(1.0, (float(np.median(self.estimate.kurtosis)) - 1) / 2)

    def scatter(self, seen: SeenSurface) -> FloatArray:
        """Return the covariance of S over what `seen` shows, shape (n, n) [-]."""
        spacing = self.estimate.spacing
        scatter = self.covariance_of(lambda lag: seen.seen(lag / spacing))
        tailed: FloatArray = self.tails * scatter
        return tailed

    def misfit(self, seen: SeenSurface) -> FloatArray:
        """Return the covariance of what the model leaves open, as `scatter` [-].

        Where a misfit is allowed, and on a map, the whole loss by levelling enters
        once more as an unknown of that size: how much a mean plane takes is not known,
        and a surface may lack waves longer than the profile, which bends S likewise.
        The loss of a self-affine profile is known exactly. Of the path of a tip the
        form is known to a percent only.
        """
        if seen.traced:
            return TIP_TOLERANCE**2 * np.eye(self.lag.size)
        if self.tolerance == 0 and self.estimate.separate:
            return np.zeros((self.lag.size, self.lag.size))
        loss = self.loss(seen) / seen.seen(self.lag)
        misfit: FloatArray = self.tolerance**2 * np.eye(loss.size)
        return misfit + np.outer(loss, loss)

    def within(self, keep: BoolArray) -> "FractalProblem":
        """Return the problem at the lags marked in `keep` only."""
        whole, chosen = self.covariance_of, np.ix_(keep, keep)
        return replace(
            self,
            estimate=self.estimate.only(keep),
            covariance_of=lambda seen: whole(seen)[chosen],
        )

    def straight(self, *, up_to: float = np.inf) -> SeenSurface:
        """Return the power law through the values, without weights: a start.

        Args:
            up_to: longest lag to take [samples]; three lags are taken at least.
        """
        count = max(3, int(np.count_nonzero(self.lag <= up_to)))
        log_lag = np.log(self.lag[:count])
        slope, level = np.polyfit(log_lag, np.log(self.estimate.value[:count]), 1)
        exponent = float(np.clip(slope, 0.1, 1.9))
        shift = (slope - exponent) * float(np.mean(log_lag))
        return SeenSurface(exponent=exponent, amplitude=float(np.exp(level + shift)))


def pose(estimate: StructureFunction, *, tolerance: float = 0.0) -> FractalProblem:
    """Lay out the fit of a structure function at the lags it has."""
    return FractalProblem(estimate, structure_covariance(estimate), tolerance)
