# SPDX-License-Identifier: MIT
"""Choose the smallest instrument model that the data support."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.fractal.fit_problem import FractalProblem
from jointbench.signal.fractal.lag_weights import weigh
from jointbench.signal.fractal.least_squares import (
    GlsFit,
    Model,
    by_own_weights,
    fit_model,
    settle,
)
from jointbench.signal.fractal.self_affine import (
    InstrumentModel,
    SeenSurface,
    tip_radius,
)

ACCEPT_PROBABILITY = 0.01
"""Least probability of a larger chi2 at which a model is accepted [-]."""
_PRUNING_PROBABILITY = 1e-6
"""Probability of the largest model below which simpler ones are not tried."""
_ONE_MORE = 7.88
"""Gain of chi2 by one more parameter with a probability of 0.5 % by chance [-], so that
all tests together choose a larger model by chance in at most 1 %."""
_TWO_MORE = 11.4
"""The same for two more parameters, with a probability of 0.33 % [-]."""
_CAST_DOUBT = {1: (1.5, 1.5), 2: (5.0, _TWO_MORE)}
"""Gains of chi2 by one or two more parameters from which they add uncertainty to D, and
at which their whole distance counts [-]: lower limits cover more insignificant noise,
and widen more clean surfaces. Blur and noise that almost cancel leave D nearly unknown:
they count in full only where they are nearly significant."""
_EVEN = 14.0
"""Gain of chi2 by one or two more parameters for equal weights of both models in D [-]:
one clean profile in 200 has a noise, a blur or a bend of 12 and more by chance. With
Akaike's 2 and 4, D would scatter by 10 to 25 percent more."""
_FAR_WORSE = 40.0
"""Excess of chi2 of a smaller model, by the weights of the largest, above which its own
weights are not worked out [-]."""
_BLUNTEST_TIP = 100e-6
"""Largest radius of a stylus [m]: twice that of the bluntest in use, as it is known
within a factor of two only."""
_NOISE_START = 0.02
"""Least noise at which a tip is tried, over the smallest value of S [-]."""
_SETTLED_WEIGHT = 0.999
"""Weight of the larger model in D above which the smaller is ignored [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Doubt:
    """Effect of a larger, insignificant model on the power law of the chosen one.

    Attributes:
        shift: of the power law, shape (2,).
        covariance: added by it, shape (2, 2).
    """

    shift: FloatArray
    covariance: FloatArray


def choose_instrument(
    problem: FractalProblem, at: SeenSurface, *, rolls_off: bool
) -> tuple[GlsFit, Doubt]:
    """Choose the smallest instrument model that no larger one improves significantly.

    Args:
        problem: the structure function to fit.
        at: surface of the first weights.
        rolls_off: whether the surface has a corner.

    Returns:
        The fit, and the effect of an insignificantly better, larger model on its law.
    """
    kinds = InstrumentModel
    plain = settle(problem, Model(kinds.NONE, rolls_off), at)
    own = weigh(problem, plain.seen)
    # With a poor model the weights do not converge; all three use the last ones.
    plain = fit_model(problem, plain.model, own, start=plain.parameters)
    noisy = fit_model(problem, Model(kinds.NOISE, rolls_off), own)
    both = fit_model(problem, Model(kinds.PSF_AND_NOISE, rolls_off), own)
    gains = (plain.chi2 - noisy.chi2, plain.chi2 - both.chi2)
    if gains[0] < _ONE_MORE and gains[1] < _TWO_MORE:
        doubt = _doubt(plain, noisy if gains[0] > _CAST_DOUBT[1][0] else both)
        return by_own_weights(problem, plain), doubt
    best, doubt = _without_tip(problem, plain, noisy, both)
    strict = problem.tolerance == 0 and problem.axes == 1 and not rolls_off
    if strict and best.model.instrument.has_psf:
        return _or_tip(problem, best, doubt)
    return best, doubt


def _without_tip(
    problem: FractalProblem, plain: GlsFit, noisy: GlsFit, both: GlsFit
) -> tuple[GlsFit, Doubt]:
    """Choose the smallest of the models with a Gaussian blur, a limit or noise."""
    kinds, rolls_off = InstrumentModel, plain.model.rolls_off
    richest = settle(problem, both.model, both.seen)
    if richest.probability < _PRUNING_PROBABILITY:
        return richest, no_doubt()
    own = weigh(problem, richest.seen)
    best, doubt = richest, no_doubt()
    for kind in (kinds.BAND_LIMIT, kinds.NOISE, kinds.PSF):
        quick = fit_model(problem, Model(kind, rolls_off), own)
        if quick.chi2 - richest.chi2 > _FAR_WORSE:
            continue
        fit = settle(problem, quick.model, quick.seen, start=quick.parameters)
        small, rival = _with_rival(problem, fit, richest)
        more = richest.parameters.size - fit.parameters.size
        stands = small.chi2 - rival.chi2 < (_ONE_MORE if more == 1 else _TWO_MORE)
        better = fit.likelihood_criterion < best.likelihood_criterion
        accepted = fit.probability >= ACCEPT_PROBABILITY
        if stands and accepted and (better or best is richest):
            best, doubt = fit, _doubt(small, rival)
    # A blur alone was found as significant by the test of both.
    known = {kinds.NOISE: noisy, kinds.PSF: both, kinds.PSF_AND_NOISE: both}
    if best.model.instrument in known:
        doubt = _held_back(plain, known[best.model.instrument], best, doubt)
    return best, doubt


def _or_tip(
    problem: FractalProblem, blurred: GlsFit, doubt: Doubt
) -> tuple[GlsFit, Doubt]:
    """Replace the blur by the path of a round tip where that is more likely.

    The path of a tip has creases, so its spectrum falls by a power law, faster with a
    Gaussian point spread; both have as many parameters. A bend of the spectrum looks
    similar, so a tip must fit within the error of its path's form, and have the radius
    of a real stylus.
    """
    kinds = InstrumentModel
    begin = [*blurred.parameters[:2], _NOISE_START, blurred.seen.psf_width]
    own = weigh(problem, blurred.seen)
    glance = fit_model(
        problem, Model(kinds.STYLUS_AND_NOISE), own, start=np.array(begin)
    )
    sizes = glance.parameters.size, blurred.parameters.size
    likelier = glance.chi2 + 2 * sizes[0] < blurred.chi2 + 2 * sizes[1]
    if not likelier:
        return blurred, doubt
    # If the Gaussian fits poorly, its weights cannot judge the fit of a tip.
    own = weigh(problem, glance.seen)
    glance = fit_model(problem, glance.model, own, start=glance.parameters)
    if glance.probability < _PRUNING_PROBABILITY:
        return blurred, doubt
    large = settle(problem, glance.model, glance.seen)
    fit = settle(problem, Model(kinds.STYLUS), glance.seen)
    small, rival = _with_rival(problem, fit, large)
    found = (large, no_doubt())
    if small.chi2 - rival.chi2 < _ONE_MORE and fit.probability >= ACCEPT_PROBABILITY:
        found = (fit, _doubt(small, rival))
    tip = found[0]
    holds = tip.probability >= ACCEPT_PROBABILITY and _sharp_enough(problem, tip)
    return found if holds else (blurred, doubt)


def _sharp_enough(problem: FractalProblem, fit: GlsFit) -> bool:
    """Return whether a stylus can cause the fitted blur."""
    spacing = problem.estimate.spacing
    return tip_radius(fit.seen) * spacing**2 < _BLUNTEST_TIP


def _with_rival(
    problem: FractalProblem, small: GlsFit, large: GlsFit
) -> tuple[GlsFit, GlsFit]:
    """Fit a model and a larger one, both with the weights of the smaller."""
    own = weigh(problem, small.seen)
    return (
        fit_model(problem, small.model, own, start=small.parameters),
        fit_model(problem, large.model, own, start=large.parameters),
    )


def no_doubt() -> Doubt:
    """Return the effect of no larger model."""
    return Doubt(np.zeros(2), np.zeros((2, 2)))


def _doubt(small: GlsFit, large: GlsFit) -> Doubt:
    """Return the effect of a larger model on the power law where it gains at all.

    A noise too small to be significant still shifts D. The larger model includes the
    true one, so its full distance from the average counts as uncertainty, not only its
    weighted share; of two more parameters as much of it as they gain.

    Source:
        Weights by likelihood and the variance within the models: Burnham and Anderson,
        Model Selection and Multimodel Inference (2002), eq. (4.9).
    """
    more = large.parameters.size - small.parameters.size
    gain = small.chi2 - large.chi2
    begins, whole = _CAST_DOUBT[more]
    if gain < begins:
        return no_doubt()
    share = 1.0 if gain >= whole else (gain - begins) / (whole - begins)
    weight = _weight(small, large)
    apart = large.parameters[:2] - small.parameters[:2]
    widened = large.covariance[:2, :2] - small.covariance[:2, :2]
    left = share * (1 - weight) * apart
    return Doubt(weight * apart, weight * widened + np.outer(left, left))


def _held_back(plain: GlsFit, large: GlsFit, best: GlsFit, doubt: Doubt) -> Doubt:
    """Return the doubt of a model that is only just significant.

    Without it D would jump where the gain passes its limit, and the few clean profiles
    there by chance would dominate the scatter.

    Args:
        plain: without instrument.
        large: the model of `best` by the weights of `plain`.
        best: the chosen model.
        doubt: effect of a still larger model.
    """
    weight = _weight(plain, large)
    # If `plain` fits poorly, its weights cannot judge the larger model.
    if weight > _SETTLED_WEIGHT or large.chi2 >= plain.chi2:
        return doubt
    back = (1 - weight) * (plain.parameters[:2] - best.parameters[:2])
    return Doubt(doubt.shift + back, doubt.covariance + np.outer(back, back))


def _weight(small: GlsFit, large: GlsFit) -> float:
    """Return the weight of the larger of two models with the same weights of lags."""
    excess = small.chi2 - large.chi2 - _EVEN
    return float(1 / (1 + np.exp(-np.clip(excess, -100.0, 100.0) / 2)))
