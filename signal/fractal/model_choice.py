# SPDX-License-Identifier: MIT
"""Choose the smallest instrument model that the data support."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.fractal.fit_problem import FractalProblem
from jointbench.signal.fractal.instrument_choice import (
    ACCEPT_PROBABILITY,
    Doubt,
    choose_instrument,
    no_doubt,
)
from jointbench.signal.fractal.lag_weights import Weights
from jointbench.signal.fractal.least_squares import GlsFit, Model, fit_model, settle
from jointbench.signal.fractal.long_lags import long_lag_probability
from jointbench.signal.fractal.self_affine import rolled_off

_ACCEPT_LONG_PROBABILITY = 0.002
"""The same for the values at long lags alone [-]."""
_DECADE = 10.0
"""Least ratio of lags of a power law [-]."""
_CLEAR_CORNER = 9.0
"""Gain of the likelihood criterion by a significant corner of the surface [-]; one
clean profile in 60 has it by chance."""
_RULE_FACTOR = 2.0
"""The surface dominates S where the instrument changes it by less than this factor [-].
"""
_CORNER_SEEN = 0.5
"""A corner is present if the share of S at the longest lag is below this [-]."""
_CORNER_FACTOR = 0.8
"""The power law ends where a corner reduces S below this share [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """The model chosen for one range of lags, and the power law found there.

    Attributes:
        fit: of the smallest model that the data support, by its own covariance.
        law: s = 4 - 2D [-] and ln S of the surface at the pivot of `fit`, averaged with
            those of an insignificantly better, larger model, shape (2,).
        covariance: of `law`, with the effect of the insignificant instrument; on a map
            no less than the scatter of its strips, shape (2, 2).
        problem: data of the fit.
        long_probability: probability of long-lag values as far from the fit [-].
    """

    fit: GlsFit
    law: FloatArray
    covariance: FloatArray
    problem: FractalProblem
    long_probability: float

    @property
    def dimension(self) -> float:
        """D of a profile [-]."""
        return 2 - float(self.law[0]) / 2

    @property
    def dimension_sd(self) -> float:
        """Standard deviation of D [-]."""
        return float(np.sqrt(self.covariance[0, 0])) / 2

    @property
    def accepted(self) -> bool:
        """Whether the model describes the values within their scatter."""
        return (
            self.fit.probability >= ACCEPT_PROBABILITY
            and self.long_probability >= _ACCEPT_LONG_PROBABILITY
        )

    @property
    def ends_early(self) -> bool:
        """Whether a corner removes most of S at the longest lag of the fit.

        A weaker bend cannot be distinguished from the levelling of a smooth map.
        """
        seen, longest = self.fit.seen, self.fit.lag[-1:]
        ceiling = seen.amplitude * seen.corner**seen.exponent
        power = seen.surface(longest)
        return bool(rolled_off(power, ceiling)[0] < _CORNER_SEEN * power[0])

    @property
    def band(self) -> tuple[float, float] | None:
        """Longest run of lags with S dominated by the surface's power law [samples]."""
        seen, lag = self.fit.seen, self.fit.lag
        power = seen.surface(lag)
        ratio = replace(seen, corner=np.inf).seen(lag) / power
        rules = (ratio > 1 / _RULE_FACTOR) & (ratio < _RULE_FACTOR)
        if self.fit.model.rolls_off:
            ceiling = seen.amplitude * seen.corner**seen.exponent
            rules &= rolled_off(power, ceiling) > _CORNER_FACTOR * power
        return _longest_run(lag, [bool(rule) for rule in rules])

    def instrument_words(self) -> str:
        """Return the instrument's numbers as text, for a reason."""
        seen, words = self.fit.seen, []
        if seen.noise > 0:
            words.append(f"noise of {np.sqrt(seen.noise) * 1e9:.3g} nm")
        if seen.psf_width > 0:
            width = seen.psf_width * self.problem.estimate.spacing * 1e6
            blur = "a tip that blurs like a point spread" if seen.traced else ""
            words.append(f"{blur or 'a point spread'} of {width:.3g} um")
        if seen.band_limited:
            words.append("wavelengths under two samples cut off")
        return " and ".join(words) or "the instrument"


def spans_decade(band: tuple[float, float] | None) -> bool:
    """Return whether a band of lags spans a decade."""
    return band is not None and band[1] >= _DECADE * band[0] * (1 - 1e-9)


def _longest_run(lag: FloatArray, rules: list[bool]) -> tuple[float, float] | None:
    """Return the ends of the run of true entries that spans the most octaves."""
    best: tuple[float, float] | None = None
    start: float | None = None
    for value, rule in zip(lag, rules, strict=True):
        if not rule:
            start = None
            continue
        start = float(value) if start is None else start
        if best is None or value / start > best[1] / best[0]:
            best = (start, float(value))
    return best


def choose(problem: FractalProblem) -> Choice:
    """Fit models of increasing size and choose the smallest that the data support.

    A model is kept unless a larger one gains significantly in likelihood, both weighted
    by the covariance of the smaller, since only then is the distribution of the gain
    known.

    Args:
        problem: the structure function at the lags of the fit.

    Returns:
        The choice; it may still be unacceptable. A surface with a corner is chosen only
        where that is clearly more likely.

    Source:
        Likelihood-ratio tests, 1 % together; as noise and point spread cannot be
        negative, a gain by chance is half as frequent as for chi-squared: Self and
        Liang, J. Am. Stat. Assoc. 82 (1987) 605.
    """
    straight = choose_instrument(problem, problem.straight(), rolls_off=False)
    endless = _chosen(problem, *straight)
    criterion = endless.fit.likelihood_criterion
    nearest = Model(endless.fit.model.instrument, rolls_off=True)
    # A plateau at long lags is in the short tail of a skewed distribution: only its own
    # weights detect it, so likelihoods are compared, determinants included.
    glance = settle(problem, nearest, endless.fit.seen)
    if endless.accepted and criterion - glance.likelihood_criterion < _CLEAR_CORNER:
        return endless
    bent = choose_instrument(problem, glance.seen, rolls_off=True)
    cornered = _chosen(problem, *bent)
    clear = criterion - cornered.fit.likelihood_criterion > _CLEAR_CORNER
    better = clear or (cornered.accepted and not endless.accepted)
    return cornered if better and cornered.ends_early else endless


def choose_straight(problem: FractalProblem, weights: Weights) -> Choice:
    """Fit a straight line, without instrument or corner; it may be unacceptable."""
    return _chosen(problem, fit_model(problem, Model(), weights), no_doubt())


def _chosen(problem: FractalProblem, fit: GlsFit, doubt: Doubt) -> Choice:
    """Return a fit as a choice; on a map with at least the scatter of its strips."""
    covariance = fit.covariance[:2, :2] + doubt.covariance
    strips = _strip_scatter(problem, fit) / fit.dimension_sd
    return Choice(
        fit=fit,
        law=fit.parameters[:2] + doubt.shift,
        covariance=covariance * max(1.0, strips**2),
        problem=problem,
        long_probability=long_lag_probability(problem, fit),
    )


def _strip_scatter(problem: FractalProblem, fit: GlsFit) -> float:
    """Return the standard deviation of D estimated from strips of neighbouring rows.

    It needs no model of the correlation of rows; 0 without strips.
    """
    blocks = [sampling.blocks for sampling in problem.estimate.samplings]
    if len(blocks) != 1 or blocks[0].shape[0] < 2:
        return 0.0
    dimension = -0.5 * (blocks[0] / fit.predicted) @ fit.gain[0]
    return float(np.std(dimension, ddof=1) / np.sqrt(dimension.size))
