# SPDX-License-Identifier: MIT
"""Records of a fit: groups of its rows, its minimum, settled hits."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.residuals.slopes import SlopeArray, curvature


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Groups of the rows of a residual.

    Attributes:
        group: group of each row (a record), shape (n_rows,), 0-based.
        labels: words of each group by view, for example ``{"level": "300 N"}``.
        dof: number of rows with weight.
        shape: records, channels and samples, whose product is the number of rows.
        white: False if sigma includes a stated repeatability: a residual below it may
            have any shape, so directed tests are not meaningful.
    """

    group: IntArray
    labels: tuple[dict[str, str], ...]
    dof: int
    shape: tuple[int, int, int]
    white: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A minimum of the cost.

    Attributes:
        x: base coordinates, then those of each candidate, shape (n,).
        n_base: number of base coordinates.
        candidates: effects of the fit.
        residual: whitened, shape (n_rows,).
        jacobian: d residual / d x, shape (n_rows, n).
        cost: chi2 of the data plus that of the priors.
        prior: diagonal of the prior's precision, shape (n,).
        centre: of the prior, shape (n,).
        kept: covariance of x, where it is kept without the slopes, shape (n, n).
        late: whether the slopes are still those of an earlier step.
    """

    x: FloatArray
    n_base: int
    candidates: tuple[Candidate, ...]
    residual: FloatArray
    jacobian: SlopeArray
    cost: float
    prior: FloatArray
    centre: FloatArray
    kept: FloatArray | None = None
    late: bool = False

    @property
    def base(self) -> FloatArray:
        """Base coordinates, shape (n_base,)."""
        return self.x[: self.n_base]

    @property
    def terms(self) -> tuple[Term, ...]:
        """The effects with their coordinates."""
        return split(self.x, self.n_base, self.candidates)

    @property
    def chi2(self) -> float:
        """Of the data alone."""
        return float(self.residual @ self.residual)

    @property
    def covariance(self) -> FloatArray:
        """Of x by the curvature of the cost, shape (n, n)."""
        if self.kept is not None:
            return self.kept
        hessian = curvature(self.jacobian) + np.diag(self.prior)
        return np.asarray(np.linalg.pinv(hessian, hermitian=True))

    @property
    def prior_deviations(self) -> FloatArray:
        """Deviation of the base from its nominal parameters [sd], shape (n_base,)."""
        scaled = np.sqrt(self.prior[: self.n_base])
        return np.asarray(self.base * scaled)


def without_slopes(fit: Fit) -> Fit:
    """Return a fit that takes little memory; its covariance is not known any more."""
    return replace(fit, jacobian=np.zeros((0, fit.x.size)))


def without_late_slopes(fit: Fit) -> Fit:
    """Return a fit without slopes, if these are those of an earlier step."""
    return without_slopes(fit) if fit.late else fit


def with_covariance_alone(fit: Fit) -> Fit:
    """Return a fit that takes little memory, with the covariance of its slopes."""
    covariance = fit.covariance if fit.jacobian.size else fit.kept
    return replace(without_slopes(fit), kept=covariance)


def split(
    x: FloatArray, n_base: int, candidates: Sequence[Candidate]
) -> tuple[Term, ...]:
    """Split a coordinate vector into terms."""
    terms, at = [], n_base
    for candidate in candidates:
        n = len(candidate.effect.parameters)
        terms.append(Term(candidate, x[at : at + n]))
        at += n
    return tuple(terms)


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """Expansion of the model about the joint's stiffness in each hit.

    The data determine that stiffness far better than its mean, so the mean must be free
    to change without it: the response is computed at the stiffness of each hit, and
    mean and scatter enter by the slope. Over a hundred radians the response is
    nonlinear within the scatter, which would otherwise block a fit of the base.

    Attributes:
        anchor: base at which the model was expanded, shape (n_base,).
        slope: derivative of the response by log stiffness, shape of the response.
        rise: relative change of the joint's stiffness by laws [-], (n_records,).
    """

    anchor: FloatArray
    slope: FloatArray
    rise: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class HitGains:
    """Expansion of a clipped model about the gains of each hit.

    The samples determine the product of gain and response far better than the mean
    gain, so the base must be free to change its scale without crossing the limit: as
    the response grows, the gain falls, and its deviation enters by the slope.

    Attributes:
        factor: gain of each channel in each hit, shape (n_records, n_channels).
        anchor: response ahead of the converter at which it was estimated, shape
            (n_records, n_channels, n_samples).
        slope: change of the clipped response by a relative gain, same shape.
    """

    factor: FloatArray
    anchor: FloatArray
    slope: FloatArray

    def beside(self, response: FloatArray) -> FloatArray:
        """Return the gains at which a response shows what the anchor showed.

        Args:
            response: ahead of the converter, shape of the anchor.
        """
        along = np.einsum("rcn,rcn->rc", response, self.anchor)
        power = np.einsum("rcn,rcn->rc", self.anchor, self.anchor)
        low, high = RESIDUALS.least_grown, 1.0 / RESIDUALS.least_grown
        grown = np.clip(along / np.where(power > 0.0, power, 1.0), low, high)
        return np.asarray(self.factor / np.where(power > 0.0, grown, 1.0))

    def cut(self, length: int) -> "HitGains":
        """Return the expansion of the first samples."""
        return replace(
            self, anchor=self.anchor[:, :, :length], slope=self.slope[:, :, :length]
        )
