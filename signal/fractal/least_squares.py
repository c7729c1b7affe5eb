# SPDX-License-Identifier: MIT
"""Fit a self-affine surface and its instrument by generalised least squares.

Neighbouring lags share most of their pairs, so their errors are strongly correlated;
weights from the full covariance reach the precision that the data allow. The covariance
depends on the surface, so it is recalculated with the fitted one.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import LinAlgError

from jointbench.acquisition.basics.arrays import FloatArray, read_only
from jointbench.acquisition.basics.tail_probabilities import chi2_above
from jointbench.signal.fractal.bounded_search import Found, Sought, search
from jointbench.signal.fractal.fit_problem import FractalProblem
from jointbench.signal.fractal.instrument_blur import limited_table
from jointbench.signal.fractal.lag_weights import Weights, weigh
from jointbench.signal.fractal.seen_forms import FormEffect
from jointbench.signal.fractal.self_affine import InstrumentModel, SeenSurface

_EXPONENT_RANGE = (0.02, 1.98)
"""Range of s = 4 - 2D in the search [-]."""
_NOISE_STARTS = (0.02, 0.6)
"""Start values of the noise, over the smallest value of S [-]."""
_PSF_STARTS = (0.3, 1.5, 6.0)
"""Start values of the point spread [samples]."""
_NARROWEST_PSF = 1e-2
"""Point spread below which blur is negligible [samples]."""
_WIDEST_PSF = 30.0
"""Largest plausible point spread [samples]; no instrument is sampled more finely."""
_WIDEST_PSF_SHARE = 0.25
"""The same as a share of the longest lag; beyond it S vanishes [-]."""
_CORNER_STARTS = (0.03, 0.5)
"""Start values of the corner, over the longest lag [-]."""
_CORNER_RANGE = (0.5, 10.0)
"""Range of the corner: lowest [samples] and highest [longest lags]."""
_SMALLEST_INFORMATION = 1e-6
"""Lower bound of the singular values of the scaled Jacobian [-]."""
_NO_TABLE = read_only(np.empty((0, 0)))
_RENEWALS = 2
"""Recalculations of the covariance; it converges quickly [-]."""
_PRUNED = 1e-9
"""Probability of a larger chi2 below which no other weights make a model right [-]."""


@dataclass(frozen=True, slots=True)
class Model:
    """Model of a fit: the instrument, and whether the surface has a corner.

    Attributes:
        instrument: the instrument model.
        rolls_off: whether S of the surface has a corner.
    """

    instrument: InstrumentModel = InstrumentModel.NONE
    rolls_off: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class GlsFit:
    """One model fitted to the structure function at chosen lags.

    Attributes:
        model: the fitted model.
        seen: the fitted surface and instrument; lengths in samples.
        lag: lags of the fit [samples], shape (n_lags,).
        predicted: fitted S [m^2], loss by levelling included, same shape.
        parameters: s [-], ln S of the surface at the pivot, then, where the
            model has them, 2 noise / smallest S [-], point spread [samples] and ln
            corner.
        covariance: of `parameters`.
        gain: change of `parameters` with relative changes of S, shape
            (n_parameters, n_lags).
        pivot: [samples].
        chi2: sum of squares of the whitened residuals [-].
        log_determinant: of the covariance of S in the weights.
        dof: lags less parameters [-].
    """

    model: Model
    seen: SeenSurface
    lag: FloatArray
    predicted: FloatArray
    parameters: FloatArray
    covariance: FloatArray
    gain: FloatArray
    pivot: float
    chi2: float
    log_determinant: float
    dof: int

    @property
    def probability(self) -> float:
        """Probability of a larger chi2 if the model holds [-]."""
        return chi2_above(self.chi2, self.dof)

    @property
    def likelihood_criterion(self) -> float:
        """Akaike's criterion with each model's own scatter in the likelihood [-]."""
        return self.chi2 + self.log_determinant + 2.0 * self.parameters.size

    @property
    def dimension(self) -> float:
        """D of the profile [-]."""
        return 2 - float(self.parameters[0]) / 2

    @property
    def dimension_sd(self) -> float:
        """Standard deviation of D [-]."""
        return float(np.sqrt(self.covariance[0, 0])) / 2


def fit_model(
    problem: FractalProblem,
    model: Model,
    weights: Weights,
    *,
    start: FloatArray | None = None,
) -> GlsFit:
    """Fit one model with given weights.

    Residuals are linear in S and the weights are fixed, so they average to zero at the
    true values for any skewness of S.

    Args:
        problem: the structure function to fit.
        model: the model.
        weights: models fitted with the same weights are comparable by chi2.
        start: parameters of an earlier fit of the model to start from; by default
            the search starts from several places.

    Returns:
        The best of all starts.
    """
    lower, upper = _bounds(problem, model)
    starts = _starts(problem, model) if start is None else [start]
    found = search(_sought(problem, model, weights), np.array(starts), lower, upper)
    if not np.isfinite(found.squares):
        raise LinAlgError("gaps of a fit are no numbers, or its root is singular")
    return _result(problem, model, weights, found)


def _sought(problem: FractalProblem, model: Model, weights: Weights) -> Sought:
    """Return what a search needs of a problem, a model and weights."""
    limited = model.instrument is InstrumentModel.BAND_LIMIT
    lags = tuple(problem.lag.tolist()) if limited else ()
    return Sought(
        lag=np.array(problem.lag),
        value=np.array(problem.estimate.value),
        reference=np.array(weights.reference),
        root=np.ascontiguousarray(weights.root),
        limit=limited_table(lags, problem.axes) if limited else _NO_TABLE,
        log_pivot=problem.log_pivot,
        least=problem.least,
        points=problem.points,
        loss_share=problem.loss_share,
        quantum=float(problem.estimate.quantum),
        axes=problem.axes,
        effect=int(_effect(model.instrument)),
        noisy=model.instrument.has_noise,
        rolls_off=model.rolls_off,
    )


def _effect(instrument: InstrumentModel) -> FormEffect:
    """Return what acts on the power law."""
    if instrument is InstrumentModel.BAND_LIMIT:
        return FormEffect.LIMIT
    if instrument.is_traced:
        return FormEffect.TIP
    return FormEffect.BLUR if instrument.has_psf else FormEffect.NONE


def settle(
    problem: FractalProblem,
    model: Model,
    at: SeenSurface,
    *,
    start: FloatArray | None = None,
) -> GlsFit:
    """Fit one model and recalculate the weights until they converge.

    Args:
        problem: the structure function to fit.
        model: the model.
        at: surface and instrument of the first weights: near those that the model
            finds if it is right.
        start: see `fit_model`.

    Returns:
        The fit, judged by its own weights: where the model is poor and does not
            converge, those of the last round may belong to another surface.
    """
    result = fit_model(problem, model, weigh(problem, at), start=start)
    for _ in range(_RENEWALS):
        if result.probability < _PRUNED:
            break
        weights = weigh(problem, result.seen)
        result = fit_model(problem, model, weights, start=result.parameters)
    return by_own_weights(problem, result)


def by_own_weights(problem: FractalProblem, fit: GlsFit) -> GlsFit:
    """Return a fit with chi2 and determinant of its own covariance."""
    own = weigh(problem, fit.seen)
    gap = (problem.estimate.value - fit.predicted) / own.reference
    white = own.whitened(gap)
    return replace(fit, chi2=float(white @ white), log_determinant=own.log_determinant)


def _result(
    problem: FractalProblem, model: Model, weights: Weights, best: Found
) -> GlsFit:
    """Build the record of a search."""
    seen = _unpack(problem, model, best.parameters)
    predicted = problem.predicted(seen)
    covariance = _inverse(best.jacobian)
    share = predicted / weights.reference
    return GlsFit(
        model=model,
        seen=seen,
        lag=problem.lag,
        predicted=predicted,
        parameters=best.parameters,
        covariance=covariance,
        gain=-covariance @ weights.backwards(best.jacobian).T * share,
        pivot=problem.pivot,
        chi2=best.squares,
        log_determinant=weights.log_determinant,
        dof=max(1, problem.lag.size - best.parameters.size),
    )


def _inverse(jacobian: FloatArray) -> FloatArray:
    """Return the covariance of the parameters.

    Undetermined parameters get a huge variance instead of a division by zero.
    """
    normal = jacobian.T @ jacobian
    size = np.sqrt(normal.diagonal())
    scale = np.where(size > 0, size, 1.0)
    apart = np.outer(scale, scale)
    values, directions = np.linalg.eigh(normal / apart)
    spread = directions / np.sqrt(np.maximum(values, _SMALLEST_INFORMATION**2))
    covariance: FloatArray = spread @ spread.T / apart
    return covariance


def _unpack(
    problem: FractalProblem, model: Model, parameters: FloatArray
) -> SeenSurface:
    """Return the surface and instrument of a parameter vector."""
    exponent, level, *rest = parameters.tolist()
    instrument = model.instrument
    noise = rest.pop(0) if instrument.has_noise else 0.0
    return SeenSurface(
        exponent=exponent,
        amplitude=math.exp(level - exponent * problem.log_pivot),
        noise=0.5 * noise * problem.least,
        psf_width=rest.pop(0) if instrument.has_psf else 0.0,
        axes=problem.axes,
        band_limited=instrument is InstrumentModel.BAND_LIMIT,
        corner=math.exp(rest.pop(0)) if model.rolls_off else np.inf,
        quantum=problem.estimate.quantum,
        traced=instrument.is_traced,
    )


def widest_psf(problem: FractalProblem) -> float:
    """Return the widest point spread of the search [samples]."""
    return max(1.0, min(_WIDEST_PSF, _WIDEST_PSF_SHARE * float(problem.lag[-1])))


def _bounds(problem: FractalProblem, model: Model) -> tuple[FloatArray, FloatArray]:
    """Return the lower and upper bounds of the parameters."""
    values = np.log(problem.estimate.value)
    bounds = [_EXPONENT_RANGE, (float(values.min()) - 20, float(values.max()) + 20)]
    if model.instrument.has_noise:
        bounds.append((0.0, 2.0))
    if model.instrument.has_psf:
        bounds.append((_NARROWEST_PSF, widest_psf(problem)))
    if model.rolls_off:
        longest = _CORNER_RANGE[1] * float(problem.lag[-1])
        bounds.append((float(np.log(_CORNER_RANGE[0])), float(np.log(longest))))
    lower, upper = np.array(bounds).T
    return lower, upper


def _starts(problem: FractalProblem, model: Model) -> list[FloatArray]:
    """Return the start values of a search."""
    line = problem.straight()
    base = [line.exponent, np.log(line.surface(np.array(problem.pivot)))]
    noises = [[n] for n in _NOISE_STARTS] if model.instrument.has_noise else [[]]
    widths = [[w] for w in _PSF_STARTS] if model.instrument.has_psf else [[]]
    if not model.rolls_off:
        return [np.array([*base, *rest]) for rest in _crossed(noises, widths)]
    starts = []
    for corner in np.array(_CORNER_STARTS) * problem.lag[-1]:
        below = problem.straight(up_to=float(corner))
        level = np.log(below.surface(np.array(problem.pivot)))
        starts += [
            np.array([below.exponent, level, *rest, np.log(corner)])
            for rest in _crossed(noises, widths)
        ]
    return starts


def _crossed(noises: list[list[float]], widths: list[list[float]]) -> list[list[float]]:
    """Combine starts: every noise with the first width, every width with the first."""
    with_noise = [[*noise, *widths[0]] for noise in noises]
    return with_noise + [[*noises[0], *width] for width in widths[1:]]
