# SPDX-License-Identifier: MIT
"""Fits a self-affine surface and its instrument by generalised least squares.

Neighbouring lags share most of their pairs, so their errors are strongly correlated;
weights from the full covariance reach the precision that the data allow. The
covariance depends on the surface, so it is renewed with the fitted one.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import LinAlgError, cholesky, solve_triangular
from scipy.optimize import OptimizeResult, least_squares
from scipy.stats import chi2 as chi2_distribution

from jointbench.acquisition.arrays import FloatArray
from jointbench.signal.fractal_problem import FractalProblem
from jointbench.signal.self_affine import InstrumentModel, SeenSurface

EXPONENT_RANGE = (0.02, 1.98)
"""Range of s = 4 - 2D the search may enter [-]."""
NOISE_STARTS = (0.02, 0.6)
"""Noise from which the search starts, over the smallest value of S [-]."""
PSF_STARTS = (0.3, 1.5, 6.0)
"""Point spreads from which the search starts [samples]."""
NARROWEST_PSF = 1e-2
"""Point spread below which nothing is blurred [samples]."""
WIDEST_PSF = 30.0
"""Point spread beyond which no instrument would be sampled so finely [samples]."""
WIDEST_PSF_SHARE = 0.25
"""The same as a share of the longest lag: beyond, nothing is left [-]."""
CORNER_STARTS = (0.03, 0.5)
"""Corners from which the search starts, over the longest lag [-]."""
CORNER_RANGE = (0.5, 10.0)
"""Corners searched, from so many samples to so many longest lags [-]."""
JITTERS = (1e-9, 1e-7, 1e-5, 1e-3)
"""Variance added on the diagonal, as a share of it [-]; the first that suffices."""
RENEWALS = 2
"""How often the covariance is renewed; it settles at once [-]."""


@dataclass(frozen=True, slots=True)
class Model:
    """What is fitted: the instrument, and whether the surface has a corner.

    Attributes:
        instrument: what the instrument does.
        rolls_off: whether the surface stops to grow rougher at some lag.
    """

    instrument: InstrumentModel = InstrumentModel.NONE
    rolls_off: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class GlsFit:
    """One model fitted to the structure function at chosen lags.

    Attributes:
        model: what was fitted.
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
        log_determinant: of the covariance that weighed them [-].
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
        """Chance of a larger chi2 if the model holds [-]."""
        return float(chi2_distribution.sf(self.chi2, self.dof))

    @property
    def criterion(self) -> float:
        """Akaike's information criterion up to a constant [-].

        Between fits weighed by one covariance; `likelihood_criterion` otherwise.
        """
        return self.chi2 + 2 * self.parameters.size

    @property
    def likelihood_criterion(self) -> float:
        """Akaike's criterion with each model's own scatter in the likelihood [-]."""
        return self.criterion + self.log_determinant

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
    at: SeenSurface,
    *,
    start: FloatArray | None = None,
) -> GlsFit:
    """Fit one model with the covariance that belongs to another.

    Args:
        problem: the structure function to fit.
        model: the model.
        at: surface and instrument whose covariance weighs the lags. Models are
            comparable by chi2 when they are fitted at the same one.
        start: parameters of an earlier fit of the model to start from; by default
            the search starts from several places.

    Returns:
        The best of all starts.
    """
    scatter = problem.scatter(at)
    # Mean squares are spread like chi2: their cube root is nearly Gaussian.
    bias = np.diag(scatter) / 9
    # A poor step of the search may lose everything to levelling.
    floor = 1e-6 * problem.estimate.value

    def gap(expected: FloatArray) -> FloatArray:
        """Return relative residuals that are nearly Gaussian, also far from 0."""
        ratio = problem.estimate.value / np.maximum(expected, floor)
        cubic: FloatArray = 3 * (np.cbrt(ratio) - 1 + bias)
        return cubic

    starts = _starts(problem, model) if start is None else [start]
    root = _root(scatter + problem.misfit(at))
    return _result(problem, model, root, _least(problem, model, root, gap, starts))


def polish(problem: FractalProblem, fit: GlsFit) -> GlsFit:
    """Return the fit with parameters free of the bias of curved residuals.

    Residuals linear in S, with weights that do not move with the parameters, average
    to zero at the truth whatever the spread of S; they need a good start. How well
    the model fits is still said by the first fit.
    """
    reference = fit.predicted

    def gap(expected: FloatArray) -> FloatArray:
        """Return relative residuals linear in S."""
        linear: FloatArray = (problem.estimate.value - expected) / reference
        return linear

    root = _root(problem.scatter(fit.seen) + problem.misfit(fit.seen))
    best = _least(problem, fit.model, root, gap, [fit.parameters])
    polished = _result(problem, fit.model, root, best)
    return replace(polished, chi2=fit.chi2, log_determinant=fit.log_determinant)


def settle(problem: FractalProblem, model: Model, at: SeenSurface) -> GlsFit:
    """Fit one model and renew the covariance with the result until it settles."""
    result = fit_model(problem, model, at)
    for _ in range(RENEWALS):
        start = result.parameters
        result = fit_model(problem, model, result.seen, start=start)
    return result


def _root(covariance: FloatArray) -> FloatArray:
    """Return the lower Cholesky root, with as little added variance as it takes.

    On very smooth surfaces neighbouring lags tell the same to more digits than the
    sums have; the added variance keeps their last digits out of the fit.
    """
    diagonal = np.diag(np.diag(covariance))
    for jitter in JITTERS:
        try:
            return np.asarray(cholesky(covariance + jitter * diagonal, lower=True))
        except LinAlgError:
            continue
    return np.asarray(np.sqrt(diagonal))


def _least(
    problem: FractalProblem,
    model: Model,
    root: FloatArray,
    gap: Callable[[FloatArray], FloatArray],
    starts: list[FloatArray],
) -> OptimizeResult:
    """Minimise the whitened residuals from every start; return the best."""
    lower, upper = _bounds(problem, model)
    margin = 1e-6 * (upper - lower)

    def residual(parameters: FloatArray) -> FloatArray:
        """Return the whitened residuals."""
        expected = problem.predicted(_unpack(problem, model, parameters))
        white: FloatArray = solve_triangular(root, gap(expected), lower=True)
        return white

    found = [
        least_squares(
            residual,
            np.clip(start, lower + margin, upper - margin),
            bounds=(lower, upper),
            x_scale="jac",
        )
        for start in starts
    ]
    return min(found, key=lambda one: float(one.cost))


def _result(
    problem: FractalProblem, model: Model, root: FloatArray, best: OptimizeResult
) -> GlsFit:
    """Put the outcome of a search into a record."""
    seen = _unpack(problem, model, best.x)
    predicted = problem.predicted(seen)
    covariance = np.linalg.pinv(best.jac.T @ best.jac)
    whitening = solve_triangular(root, np.eye(predicted.size), lower=True)
    return GlsFit(
        model=model,
        seen=seen,
        lag=problem.lag,
        predicted=predicted,
        parameters=best.x,
        covariance=covariance,
        gain=-covariance @ best.jac.T @ whitening,
        pivot=problem.pivot,
        chi2=float(2 * best.cost),
        log_determinant=2 * float(np.sum(np.log(np.diag(root)))),
        dof=max(1, problem.lag.size - best.x.size),
    )


def _unpack(
    problem: FractalProblem, model: Model, parameters: FloatArray
) -> SeenSurface:
    """Return the surface and instrument that a vector of parameters stands for."""
    exponent, level, *rest = (float(value) for value in parameters)
    instrument = model.instrument
    noise = rest.pop(0) if instrument.has_noise else 0.0
    return SeenSurface(
        exponent=exponent,
        amplitude=float(np.exp(level - exponent * np.log(problem.pivot))),
        noise=0.5 * noise * float(problem.estimate.value.min()),
        psf_width=rest.pop(0) if instrument.has_psf else 0.0,
        psf_axes=problem.psf_axes,
        band_limited=instrument is InstrumentModel.BAND_LIMIT,
        corner=float(np.exp(rest.pop(0))) if model.rolls_off else np.inf,
    )


def widest_psf(problem: FractalProblem) -> float:
    """Return the widest point spread of the search [samples]."""
    return max(1.0, min(WIDEST_PSF, WIDEST_PSF_SHARE * float(problem.lag[-1])))


def _bounds(problem: FractalProblem, model: Model) -> tuple[FloatArray, FloatArray]:
    """Return the lower and upper bounds of the parameters."""
    values = np.log(problem.estimate.value)
    bounds = [EXPONENT_RANGE, (float(values.min()) - 20, float(values.max()) + 20)]
    if model.instrument.has_noise:
        bounds.append((0.0, 2.0))
    if model.instrument.has_psf:
        bounds.append((NARROWEST_PSF, widest_psf(problem)))
    if model.rolls_off:
        longest = CORNER_RANGE[1] * float(problem.lag[-1])
        bounds.append((float(np.log(CORNER_RANGE[0])), float(np.log(longest))))
    lower, upper = np.array(bounds).T
    return lower, upper


def _starts(problem: FractalProblem, model: Model) -> list[FloatArray]:
    """Return the points from which a search starts."""
    line = problem.straight()
    base = [line.exponent, np.log(line.surface(np.array(problem.pivot)))]
    noises = [[n] for n in NOISE_STARTS] if model.instrument.has_noise else [[]]
    widths = [[w] for w in PSF_STARTS] if model.instrument.has_psf else [[]]
    if not model.rolls_off:
        return [np.array([*base, *n, *w]) for n in noises for w in widths]
    starts = []
    for corner in np.array(CORNER_STARTS) * problem.lag[-1]:
        below = problem.straight(up_to=float(corner))
        level = np.log(below.surface(np.array(problem.pivot)))
        law, last = [below.exponent, level], np.log(corner)
        starts += [np.array([*law, *n, *widths[0], last]) for n in noises]
        starts += [np.array([*law, *noises[0], *w, last]) for w in widths[1:]]
    return starts
