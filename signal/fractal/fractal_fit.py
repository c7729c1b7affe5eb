# SPDX-License-Identifier: MIT
"""Fractal dimension D and roughness G of a surface, or the reason for none."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.signal.fractal.fit_judgement import Judgement, judge
from jointbench.signal.fractal.fit_problem import FractalProblem, pose
from jointbench.signal.fractal.fit_result import accepted_fit, rejected_fit
from jointbench.signal.fractal.local_slope import local_slope
from jointbench.signal.fractal.model_choice import Choice, choose, spans_decade
from jointbench.signal.fractal.scaling_bands import FEWEST_LAGS, find_band
from jointbench.signal.fractal.spectral_bend import Kink, find_kink
from jointbench.signal.fractal.spectral_law import spectral_choice
from jointbench.signal.fractal.verdict_records import (
    FractalFit,
    LocalSlope,
    SurfaceVerdict,
)
from jointbench.signal.surface.structure_constant import (
    DEFAULT_GAMMA,
    ConstantForm,
    structure_constant,
)
from jointbench.signal.surface.structure_function import StructureFunction

FIT_LAGS = 25
"""Lags of the fit; more add cost, not information [-]."""
LONGEST_FIT_SHARE = 0.1
"""Longest lag of the fit over the length of a profile [-]; beyond it too few
independent pairs are left for a Gaussian description of their mean."""
LONGEST_MAP_SHARE = 0.2
"""The same on a map, where every row adds pairs [-]."""
MAP_PROFILES = 16
"""Least number of profiles of a map [-]."""
MODEL_TOLERANCE = 0.02
"""Relative error of S tolerated in a power law [-], tried where the scatter alone
rejects it: real surfaces are never exact, and long ones show it."""
_EVEN_BEND = 20.0
"""Gain of chi2 by a bend of the spectrum for equal weights of one side and of all lags
in D [-]; one clean profile in some thousands has it by chance."""


@dataclass(frozen=True, slots=True)
class FractalLine:
    """Fractal parameters of a straight line through lg S over lg lag.

    Attributes:
        dimension: D of a profile [-].
        roughness: G [m].
    """

    dimension: float
    roughness: float


def fractal_from_line(
    slope: float,
    intercept: float,
    *,
    gamma: float = DEFAULT_GAMMA,
    constant: ConstantForm = "corrected",
) -> FractalLine:
    """Convert a line lg S = slope lg lag + intercept to D and G.

    Args:
        slope: of the line, between 0 and 2 [-].
        intercept: lg of S in m^2 at a lag of 1 m.
        gamma: frequency ratio of the surface [-].
        constant: ``"corrected"``, or ``"as-printed"`` to reproduce the papers.

    Returns:
        D = (4 - slope) / 2 and G = 10^((intercept - lg C) / (2 (D - 1))).

    Raises:
        UsageError: the slope is not between 0 and 2, or gamma not above 1.

    Source:
        Appl. Sci. 2025, 15, 9040, eqs. (9) and (10).
    """
    dimension = (4 - slope) / 2
    level = intercept - np.log10(structure_constant(dimension, gamma, constant))
    return FractalLine(dimension, float(10 ** (level / (2 * (dimension - 1)))))


@one_thread()
def fit_fractal(
    estimate: StructureFunction,
    *,
    gamma: float = DEFAULT_GAMMA,
    constant: ConstantForm = "corrected",
) -> FractalFit:
    """Fit D and G together with the instrument, or give the reason for no D.

    Generalised least squares with the exact covariance of S for Gaussian heights;
    the smallest of five instrument models that the data support. Tried in turn: the
    spectrum of a smooth profile (D below 1.25); all lags within their scatter; all
    lags with a tolerance of 2 %; bands of a decade or more.

    Args:
        estimate: of one surface, or of two combined.
        gamma: frequency ratio in the constant of G [-].
        constant: form of the constant of G.

    Returns:
        Verdict, reason and, where the surface scales, D, G and their uncertainty.

    Raises:
        UsageError: gamma not above 1 or no such constant.

    Source:
        Covariance of the increments of fractional Brownian motion: Istas and Lang,
        Ann. Inst. H. Poincare 33 (1997) 407. Structure function and G: S1 eq. (9).
    """
    structure_constant(1.5, gamma, constant)  # refuse bad input first
    # Differences within half a height step are not Gaussian.
    rough = estimate.only(estimate.value > 0.25 * estimate.quantum**2)
    for_fit, for_slope = _thinned(rough)
    if not _worth_a_fit(rough.only(for_fit)):
        reason = _too_coarse(estimate) or _too_short(rough.only(for_fit))
        return rejected_fit(estimate, reason, _unfitted_slope(rough))
    # The slope reaches further; its covariance is needed once, that of the fit often.
    problem = pose(rough.only(for_fit))
    found, judgement = _search(problem)
    whole = pose(rough.only(for_slope))
    slope = local_slope(whole.estimate, whole.scatter(found.fit.seen))
    if judgement is None:
        judgement = Judgement(
            SurfaceVerdict.NONE,
            f"no decade of lags is straight within {100 * MODEL_TOLERANCE:g} %",
        )
    if judgement.verdict is SurfaceVerdict.NONE:
        said = f"{judgement.reason}; the slope of ln S runs {_course(slope, problem)}"
        return rejected_fit(estimate, replace(judgement, reason=said), slope)
    return accepted_fit(found, judgement, slope, gamma=gamma, constant=constant)


def _search(problem: FractalProblem) -> tuple[Choice, Judgement | None]:
    """Return the best description of S, and its judgement if it was accepted."""
    smooth = spectral_choice(problem)
    if smooth is not None:
        return smooth, judge(smooth)
    loose = replace(problem, tolerance=MODEL_TOLERANCE)
    for attempt in (problem, loose):
        found = choose(attempt)
        if found.accepted:
            kink = None
            if not found.fit.model.rolls_off:
                kink = find_kink(attempt, found.fit.seen)
            if kink is None:
                return found, judge(found)
            return _one_side(attempt, found, kink)
    band = find_band(loose)
    if band is None:
        return found, None
    return band, replace(judge(band), verdict=SurfaceVerdict.BAND)


def _one_side(
    problem: FractalProblem, whole: Choice, kink: Kink
) -> tuple[Choice, Judgement]:
    """Fit the wider side of a bend of the spectrum, and report the bend."""
    lag = problem.lag
    sides = sorted((lag <= kink.lag, lag >= kink.lag), key=lambda k: -_octaves(lag[k]))
    spacing = 1e6 * problem.estimate.spacing
    bend = (
        f"the spectrum bends at a lag of {spacing * kink.lag:.3g} um: S runs as "
        f"lag^{kink.slope_below:.2f} below and lag^{kink.slope_above:.2f} above"
    )
    part = problem.within(sides[0])
    if _worth_a_fit(part.estimate):
        found = _held_back(choose(part), whole, kink)
        judgement = judge(found)
        if found.accepted and judgement.scales:
            said = f"{judgement.reason}; {bend}"
            return found, Judgement(SurfaceVerdict.BAND, said)
    return whole, Judgement(SurfaceVerdict.NONE, bend)


def _held_back(side: Choice, whole: Choice, kink: Kink) -> Choice:
    """Return one side of a bend with the doubt of one that is only just significant.

    Without it D of the few clean profiles with a bend by chance would be that of a part
    of their lags, ten standard deviations away.
    """
    doubted = float(expit(0.5 * (_EVEN_BEND - kink.gain)))
    apart = np.log(side.fit.pivot / whole.fit.pivot)
    law = whole.law + np.array([0.0, apart * float(whole.law[0])])
    back = doubted * (law - side.law)
    return replace(
        side, law=side.law + back, covariance=side.covariance + np.outer(back, back)
    )


def _octaves(lag: FloatArray) -> float:
    """Return the span of lags as a logarithm."""
    return float(np.log(lag[-1] / lag[0])) if lag.size else 0.0


def _longest_share(estimate: StructureFunction) -> float:
    """Return the longest lag of the fit over the length of a profile."""
    is_map = estimate.profiles >= MAP_PROFILES
    return LONGEST_MAP_SHARE if is_map else LONGEST_FIT_SHARE


def _thinned(estimate: StructureFunction) -> tuple[BoolArray, BoolArray]:
    """Mark the lags of the fit, and those of the slope, which reach further."""
    share = estimate.lag / (estimate.spacing * estimate.points)
    inside = share <= _longest_share(estimate) * (1 + 1e-9)
    keep = np.zeros(estimate.lag.size, dtype=np.bool_)
    allowed = np.flatnonzero(inside)
    if allowed.size:
        log_lag = np.log(estimate.lag[allowed])
        wanted = np.linspace(log_lag[0], log_lag[-1], FIT_LAGS)
        keep[allowed[np.argmin(np.abs(log_lag[:, None] - wanted), axis=0)]] = True
    beyond = np.flatnonzero(~inside)
    slope = keep.copy()
    slope[beyond[::2]] = True
    return keep, slope


def _worth_a_fit(estimate: StructureFunction) -> bool:
    """Return whether the lags span a decade with lags to spare."""
    lag = estimate.lag
    return lag.size >= FEWEST_LAGS and spans_decade((float(lag[0]), float(lag[-1])))


def _too_short(estimate: StructureFunction) -> Judgement:
    """Return the reason for too few lags to fit."""
    count, share = estimate.lag.size, 100 * _longest_share(estimate)
    if count == 0:
        reason = (
            f"no height differences at lags up to {share:g} % of the length: "
            "the surface is flat, or too short"
        )
    else:
        reason = (
            f"profiles of {estimate.points} points give {count} lags up to "
            f"{share:g} % of the length, less than a decade; measure a longer line"
        )
    return Judgement(SurfaceVerdict.NONE, reason)


def _too_coarse(estimate: StructureFunction) -> Judgement | None:
    """Return the judgement that the height steps mask the surface, if they do."""
    if estimate.quantum == 0 or not _worth_a_fit(estimate.only(_thinned(estimate)[0])):
        return None
    return Judgement(
        SurfaceVerdict.INSTRUMENT,
        f"heights come in steps of {1e9 * estimate.quantum:.3g} nm, which mask the "
        "surface at all but a few lags; measure with a finer height range",
    )


def _unfitted_slope(estimate: StructureFunction) -> LocalSlope:
    """Return the local slope with the scatter of a power law through the values."""
    if estimate.lag.size < 2:
        return local_slope(estimate, np.empty((0, 0)))
    problem = pose(estimate)
    return local_slope(estimate, problem.scatter(problem.straight()))


def _course(slope: LocalSlope, problem: FractalProblem) -> str:
    """Describe how the local slope varies over the lags of the fit."""
    inside = slope.lag <= problem.estimate.lag[-1] * (1 + 1e-9)
    lag, value = slope.lag[inside], slope.slope[inside]
    marks = sorted({0, int(np.argmin(value)), int(np.argmax(value)), value.size - 1})
    return ", ".join(f"{value[k]:.2f} at {1e6 * lag[k]:.3g} um" for k in marks)
