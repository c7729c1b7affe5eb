# SPDX-License-Identifier: MIT
"""Judge whether an accepted fit shows a fractal surface, and over which lags."""

from dataclasses import dataclass

import numpy as np

from jointbench.signal.fractal.least_squares import widest_psf
from jointbench.signal.fractal.model_choice import Choice, spans_decade
from jointbench.signal.fractal.self_affine import InstrumentModel
from jointbench.signal.fractal.verdict_records import SurfaceVerdict

FLAT_RATIO = 1.5
"""Largest over smallest S below which S is flat: noise without a surface [-]."""
DIMENSION_MARGIN = 0.02
"""D closer to 1 is a smooth form, closer to 2 unrelated heights [-]."""
UNKNOWN_DIMENSION_SD = 0.1
"""Standard deviation of D above which the fit does not determine D [-]."""
SPIKY_KURTOSIS = 15.0
"""Kurtosis of height differences above which a few jumps dominate S [-]: Gaussian
surfaces have 3, worn and scratched ones up to about 10."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """A verdict on one accepted fit.

    Attributes:
        verdict: `SurfaceVerdict.FRACTAL` where no rule excludes it.
        reason: one line with the numbers.
    """

    verdict: SurfaceVerdict
    reason: str

    @property
    def scales(self) -> bool:
        """Whether the surface has a power law over some lags of the fit."""
        return self.verdict in {SurfaceVerdict.FRACTAL, SurfaceVerdict.BAND}


def judge(choice: Choice) -> Judgement:
    """Return the verdict on an accepted fit.

    Args:
        choice: the accepted fit.

    Returns:
        The first rule that excludes a fractal surface, or the power law; with a corner
        it holds within a band only.
    """
    for rule in (_flat, _spiky, _hidden, _not_between_limits):
        judgement = rule(choice)
        if judgement is not None:
            return judgement
    word = SurfaceVerdict.BAND if choice.fit.model.rolls_off else SurfaceVerdict.FRACTAL
    return Judgement(word, _power_law(choice))


def _flat(choice: Choice) -> Judgement | None:
    """Find white noise: S is the same at every lag."""
    value = choice.fit.predicted
    if value.max() >= FLAT_RATIO * value.min():
        return None
    noise = np.sqrt(np.mean(value) / 2) * 1e9
    return Judgement(
        SurfaceVerdict.INSTRUMENT,
        f"S changes by less than a factor {FLAT_RATIO:g} over {_range(choice)}: "
        f"white noise of {noise:.3g} nm, the surface is not resolved",
    )


def _spiky(choice: Choice) -> Judgement | None:
    """Find steps and spikes: a few large differences dominate the mean."""
    tails = choice.problem.estimate.kurtosis
    worst = max(float(np.median(tails)), float(np.median(tails[: 1 + tails.size // 4])))
    if worst <= SPIKY_KURTOSIS:
        return None
    return Judgement(
        SurfaceVerdict.NONE,
        f"height differences have kurtosis {worst:.3g} (Gaussian 3, limit "
        f"{SPIKY_KURTOSIS:g}): a few steps or spikes dominate S, not roughness",
    )


def _hidden(choice: Choice) -> Judgement | None:
    """Find surfaces with less than a decade between instrument and corner."""
    band, seen = choice.band, choice.fit.seen
    if spans_decade(band):
        return None
    left = "no lag" if band is None else f"only {_lags(choice, band)}"
    ending = f"{left} to a power law, less than a decade"
    if seen.psf_width >= 0.95 * widest_psf(choice.problem):
        return Judgement(
            SurfaceVerdict.NONE, f"the heights are smooth at short lags: {ending}"
        )
    if choice.fit.model.rolls_off:
        corner = 1e6 * choice.problem.estimate.spacing * seen.corner
        return Judgement(
            SurfaceVerdict.NONE,
            f"S stops growing at a lag of {corner:.3g} um, which leaves {ending}",
        )
    return Judgement(
        SurfaceVerdict.INSTRUMENT, f"{choice.instrument_words()} leaves {ending}"
    )


def _not_between_limits(choice: Choice) -> Judgement | None:
    """Find forms (D near 1), unrelated heights (D near 2) and an unknown D."""
    dimension, sd = choice.dimension, choice.dimension_sd
    said = f"D = {dimension:.3f} +- {sd:.2g} over {_range(choice)}"
    if dimension - 2 * sd < 1 + DIMENSION_MARGIN:
        ending = "not distinguished from a smooth form (D = 1)"
    elif dimension + 2 * sd > 2 - DIMENSION_MARGIN:
        ending = "not distinguished from unrelated heights (D = 2)"
    elif sd > UNKNOWN_DIMENSION_SD:
        ending = "the data do not determine D"
    else:
        return None
    return Judgement(SurfaceVerdict.NONE, f"{said}: {ending}")


def _power_law(choice: Choice) -> str:
    """Return the reason for a power law."""
    fit, tolerance = choice.fit, choice.problem.tolerance
    words = (
        f"S follows lag^{choice.law[0]:.3f} over {_range(choice)}, "
        f"chi2 {fit.chi2:.1f} for {fit.dof} degrees of freedom"
    )
    if tolerance > 0:
        words += f" with a tolerance of {100 * tolerance:g} %"
    if fit.model.instrument is not InstrumentModel.NONE:
        words += f", with {choice.instrument_words()}"
    if fit.model.rolls_off:
        corner = 1e6 * choice.problem.estimate.spacing * fit.seen.corner
        words += f", and stops growing at {corner:.3g} um"
    return words


def _range(choice: Choice) -> str:
    """Return the stated range of the power law as text."""
    lag = choice.fit.lag
    return _lags(choice, choice.band or (float(lag[0]), float(lag[-1])))


def _lags(choice: Choice, band: tuple[float, float]) -> str:
    """Return a band of lags as text; `band` in samples."""
    low, high = (1e6 * choice.problem.estimate.spacing * end for end in band)
    return f"lags {low:.3g} to {high:.3g} um"
