# SPDX-License-Identifier: MIT
"""Chooses the instrument model and says what the choice itself leaves uncertain."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.signal.fractal_gls import (
    GlsFit,
    Model,
    Weights,
    fit_model,
    settle,
    weigh,
)
from jointbench.signal.fractal_problem import FractalProblem
from jointbench.signal.self_affine import InstrumentModel, rolled_off

ACCEPT_PROBABILITY = 0.01
"""A model is accepted if a true one would fit worse at least this often [-]."""
HOPELESS_PROBABILITY = 1e-6
"""Where the richest model fits with a smaller chance, simpler ones need no trial."""
CLEAR_GAIN = 2.0
"""Gain of Akaike's criterion that makes one more parameter worth it [-]: with it
the likelihood ratio of one parameter is significant at about 5 %."""
DECADE = 10.0
"""A power law over less than this ratio of lags is no power law [-]."""
NO_WEIGHT = 10.0
"""Loss of the criterion that leaves a model without weight in an average [-]."""
CLEAR_CORNER = 5.0
"""Gain of the likelihood criterion that makes a corner of the surface clear [-]."""
RULE_FACTOR = 2.0
"""The surface rules S where the instrument changes it by less than this factor [-]."""
CORNER_SEEN = 0.5
"""A corner is seen where it leaves less of S than this at the longest lag [-]."""
CORNER_FACTOR = 0.8
"""Its power law ends where a corner leaves less of S than this share [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """The model chosen for one range of lags, and the power law found there.

    The power law is averaged over the instrument models that the data do not tell
    apart, by their Akaike weights: a noise too small to be proven still moves D.

    Attributes:
        fit: of the smallest model that the data support, by its own covariance.
        law: averaged s = 4 - 2D [-] and ln S of the surface at the pivot of `fit`,
            shape (2,).
        covariance: of `law`, with the spread between models and, on a map, no less
            than the scatter of its strips, shape (2, 2).
        problem: what was fitted.
    """

    fit: GlsFit
    law: FloatArray
    covariance: FloatArray
    problem: FractalProblem

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
        return self.fit.probability >= ACCEPT_PROBABILITY

    @property
    def ends_early(self) -> bool:
        """Whether a corner takes most of S at the longest lag of the fit.

        Less of a bend is not told from what levelling does to a smooth map.
        """
        seen, longest = self.fit.seen, self.fit.lag[-1:]
        ceiling = seen.amplitude * seen.corner**seen.exponent
        power = seen.surface(longest)
        return bool(rolled_off(power, ceiling)[0] < CORNER_SEEN * power[0])

    @property
    def band(self) -> tuple[float, float] | None:
        """Longest run of lags at which the surface's power law rules S [samples]."""
        seen, lag = self.fit.seen, self.fit.lag
        power = seen.surface(lag)
        ratio = replace(seen, corner=np.inf).seen(lag) / power
        rules = (ratio > 1 / RULE_FACTOR) & (ratio < RULE_FACTOR)
        if self.fit.model.rolls_off:
            ceiling = seen.amplitude * seen.corner**seen.exponent
            rules &= rolled_off(power, ceiling) > CORNER_FACTOR * power
        return _longest_run(lag, [bool(rule) for rule in rules])

    def instrument_words(self) -> str:
        """Return the instrument's numbers in words, for a reason."""
        seen, words = self.fit.seen, []
        if seen.noise > 0:
            words.append(f"noise of {np.sqrt(seen.noise) * 1e9:.3g} nm")
        if seen.psf_width > 0:
            width = seen.psf_width * self.problem.estimate.spacing * 1e6
            words.append(f"a point spread of {width:.3g} um")
        if seen.band_limited:
            words.append("wavelengths under two samples cut off")
        return " and ".join(words) or "the instrument"


def spans_decade(band: tuple[float, float] | None) -> bool:
    """Return whether a band of lags spans a decade."""
    return band is not None and band[1] >= DECADE * band[0] * (1 - 1e-9)


def _longest_run(lag: FloatArray, rules: list[bool]) -> tuple[float, float] | None:
    """Return the ends of the run of true entries that spans most octaves."""
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
    """Fit all models and take the smallest that the data support.

    Args:
        problem: the structure function at the lags of the fit.

    Returns:
        The choice; it may still be unacceptable. A surface with a corner is taken
        only where that is clearly likelier.

    Source:
        Spread between models: Burnham and Anderson, Model Selection and Multimodel
        Inference (2002), eq. (4.9).
    """
    endless = _choose_instrument(problem, rolls_off=False)
    # The whole family with a corner is fitted only where its nearest member gains.
    nearest = Model(endless.fit.model.instrument, rolls_off=True)
    glance = settle(problem, nearest, endless.fit.seen)
    if endless.fit.likelihood_criterion <= glance.likelihood_criterion:
        return endless
    cornered = _choose_instrument(problem, rolls_off=True)
    gain = endless.fit.likelihood_criterion - cornered.fit.likelihood_criterion
    return cornered if gain > CLEAR_CORNER and cornered.ends_early else endless


def choose_straight(problem: FractalProblem, weights: Weights) -> Choice:
    """Fit a straight line, without instrument or corner; it may be unacceptable."""
    fit = fit_model(problem, Model(), weights)
    return _averaged(problem, fit, [fit], np.ones(1))


def _choose_instrument(problem: FractalProblem, *, rolls_off: bool) -> Choice:
    """Take the smallest instrument model that the data support."""
    models = [Model(instrument, rolls_off) for instrument in InstrumentModel]
    # All models are weighed by the covariance of the richest, so that their chi2
    # are comparable.
    richest = settle(problem, models[-1], problem.straight())
    if richest.probability < HOPELESS_PROBABILITY:
        return _averaged(problem, richest, [richest], np.ones(1))
    common = weigh(problem, richest.seen)
    fits = [fit_model(problem, model, common) for model in models[:-1]]
    fits.append(fit_model(problem, models[-1], common, start=richest.parameters))
    least = min(fit.criterion for fit in fits)
    close = [fit for fit in fits if fit.criterion <= least + CLEAR_GAIN]
    simplest = min(close, key=lambda fit: (fit.parameters.size, fit.criterion))
    own = weigh(problem, simplest.seen)
    chosen = fit_model(problem, simplest.model, own, start=simplest.parameters)
    likely = [fit for fit in fits if fit.criterion <= least + NO_WEIGHT]
    weights = np.exp([(least - fit.criterion) / 2 for fit in likely])
    return _averaged(problem, chosen, likely, weights)


def _averaged(
    problem: FractalProblem, chosen: GlsFit, fits: list[GlsFit], weights: FloatArray
) -> Choice:
    """Return the choice with the power law averaged over models of some weight."""
    laws = np.array([fit.parameters[:2] for fit in fits])
    mean = np.average(laws, axis=0, weights=weights)
    apart = laws - mean
    spreads = np.array([fit.covariance[:2, :2] for fit in fits])
    spreads += apart[:, :, None] * apart[:, None, :]
    covariance = np.average(spreads, axis=0, weights=weights)
    strips = _strip_scatter(problem, chosen) / chosen.dimension_sd
    return Choice(
        fit=chosen,
        law=mean,
        covariance=covariance * max(1.0, strips**2),
        problem=problem,
    )


def _strip_scatter(problem: FractalProblem, fit: GlsFit) -> float:
    """Return the standard deviation of D judged by strips of neighbouring rows.

    It needs no model of how rows hang together; 0 where there are no strips.
    """
    blocks = [face.blocks for face in problem.estimate.faces]
    if len(blocks) != 1 or blocks[0].shape[0] < 2:
        return 0.0
    dimension = -0.5 * (blocks[0] / fit.predicted) @ fit.gain[0]
    return float(np.std(dimension, ddof=1) / np.sqrt(dimension.size))
