# SPDX-License-Identifier: MIT
"""Selection of modes among candidate poles by the chi-squared of the FRF.

A pole that is stable over orders may still describe noise, or the residual of a
stronger mode. So a candidate is kept only if leaving it out raises chi-squared by more
than noise and the local residual can explain.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.signal.modal.computational_modes import find_beyond
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.line_noise import (
    line_noise,
    line_variance,
    local_level,
    local_size,
    model_error,
    residual_around,
)
from jointbench.signal.modal.lscf import Progress
from jointbench.signal.modal.lsfd import LinearFit
from jointbench.signal.modal.mode_significance import needed, significance
from jointbench.signal.modal.pole_limits import unresolved
from jointbench.signal.modal.refined_pole_covariance import RefinedPoles, refine_poles
from jointbench.signal.modal.residual_search.doubtful_neighbours import (
    DoubtfulNeighbours,
    doubtful_neighbours,
)
from jointbench.signal.modal.residual_search.local_fit import WholeFit
from jointbench.signal.modal.residual_search.missing_modes import Seen, find_missing
from jointbench.signal.modal.shared_errors import (
    ForceNoise,
    force_covariance,
    shared_covariance,
)

# Relative model error assumed before a fit has estimated it [-].
_FIRST_MODEL_ERROR = 0.02
# A mode whose damping has a relative sd above this is dropped.
_VAGUE = 1.0 / 3.0
# ... unless it explains this many times what is left around it, and is alone there.
_EXPLAINED = 1000.0
_STEPS = 30
_FEW_STEPS = 6
# Passes over the residual in search of modes that were missed.
_SEARCHES = 2


@dataclass(frozen=True, slots=True, eq=False)
class FittedModes:
    """Accepted modes with the results of their fit.

    Attributes:
        chosen: indices of the accepted candidates, shape (n_modes,).
        candidates: as given, then those that the residual showed [rad/s].
        poles: refined, with covariance and inflation.
        fit: residues on the same lines.
        variance: noise and model error of each line, shape (n_frf, n_lines).
        significance: increase of chi-squared without each mode, over the local
            residual, shape (n_modes,).
        model_error: of the fit, as a share of the local level [-].
        residual_ratio: around each mode, rms residual over noise [-], shape (n_modes,).
        shared: covariance of (Re p, Im p) from errors common to the FRFs of a
            reference, as the residual shows them [rad^2/s^2], shape (n_modes, 2, 2).
        forced: the same from the noise of the force before the hits.
        doubts: neighbours that may be missing.
    """

    chosen: IntArray
    candidates: ComplexArray
    poles: RefinedPoles
    fit: LinearFit
    variance: FloatArray
    significance: FloatArray
    model_error: float
    residual_ratio: FloatArray
    shared: FloatArray
    forced: FloatArray
    doubts: DoubtfulNeighbours


def fit_modes(
    lines: FrfLines,
    candidates: ComplexArray,
    scatter: FloatArray | None,
    *,
    held: BoolArray | None = None,
    seen: Seen | None = None,
    force: ForceNoise | None = None,
    refine: bool = True,
    progress: Progress | None = None,
) -> FittedModes:
    """Refine candidate poles and keep those that the FRF needs.

    The weights are calculated twice: the first fit assumes a model error of 2 % of the
        local level in addition to the noise, the second uses the error found by the
        first.

    Args:
        lines: lines of the fit.
        candidates: poles [rad/s], shape (n_candidates,).
        scatter: variance of the FRF from its hits, shape (n_frf, n_lines), or None.
        held: True for candidates that are always kept, shape (n_candidates,), or None.
        seen: whether a pole that the residual shows is one of the FRF; None adds no
            modes, as where some were dropped by hand and their residual is wanted.
        force: noise of the force at each reference; None for one reference whose
            noise is not known. Inputs vary fastest over the rows of the lines.
        refine: False keeps the poles of LSCF.
        progress: called with the current step and its share; None for no reports.

    Returns:
        The modes, possibly none.
    """
    noise, level = line_noise(lines.response, scatter), local_level(lines.response)
    variance = noise + _FIRST_MODEL_ERROR**2 * level
    steps = _STEPS if refine else 0
    held = np.zeros(candidates.size, bool) if held is None else held
    report = progress or _silent
    report("refining modes", 0.0)
    chosen, poles = _first_fit(lines, candidates, held, noise, variance, steps)
    report("refining modes", 0.4)
    # The response itself is rough at resonances; the residual of a fit is not.
    noise = line_noise(lines.response, scatter, poles.residual)
    error, variance = _weighed(lines, noise, poles)
    searched = -1
    for _ in range(_SEARCHES if refine else 0):
        whole = _whole(lines, poles, noise, variance)
        beyond = find_beyond(whole)
        if beyond.size == poles.beyond.size:
            searched = poles.pole.size
            break
        poles = _again(lines, poles.pole, beyond, variance)
        noise = line_noise(lines.response, scatter, poles.residual)
        error, variance = _weighed(lines, noise, poles)
    start = _Start(candidates, held, noise, variance, error, steps, chosen, searched)
    kept = needed(
        lines,
        poles.pole,
        held[chosen],
        noise,
        variance,
        poles.beyond,
        poles.residual,
    )
    report("refining modes", 0.7)
    done = _settled(lines, start, chosen, kept, poles)
    denied = np.empty(0, complex)
    for _ in range(_SEARCHES if refine and seen else 0):
        missing = find_missing(_final(lines, start, done), seen)
        denied = missing.denied
        more = _completed(lines, start, done, scatter, missing.pole)
        if more is None:
            break
        start, done = more
    report("refining modes", 1.0)
    return FittedModes(
        done.chosen,
        start.candidates,
        done.poles,
        done.fit.of_modes(done.chosen.size),
        start.variance,
        done.significance,
        start.error,
        residual_around(lines, done.poles.pole, done.poles.residual, start.noise),
        shared_covariance(
            lines,
            done.poles,
            done.fit,
            start.variance,
            1 if force is None else force.relative.shape[0],
        ),
        _forced(lines, start, done, force),
        _doubts(lines, start, done, denied, tried=refine and seen is not None),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Start:
    """What a fit begins with.

    Attributes:
        candidates: poles [rad/s].
        held: which of them are always kept.
        noise: noise variance of the lines.
        variance: noise and model error.
        error: the model error, as a share of the local level [-].
        steps: most evaluations of a refinement.
        before: candidates of the first fit, to be tried again; None once they were.
        searched: number of modes with which no further pole beyond the band was found;
            -1 where that is not known.
    """

    candidates: ComplexArray
    held: BoolArray
    noise: FloatArray
    variance: FloatArray
    error: float
    steps: int
    before: IntArray | None
    searched: int


@dataclass(frozen=True, slots=True, eq=False)
class _Settled:
    """A fit that holds no mode to drop."""

    chosen: IntArray
    poles: RefinedPoles
    fit: LinearFit
    significance: FloatArray


def _settled(
    lines: FrfLines,
    start: _Start,
    chosen: IntArray,
    kept: IntArray,
    poles: RefinedPoles,
) -> _Settled:
    """Refine, and drop vague modes and those beyond the band, until none is left."""
    held, beyond = start.held, poles.beyond
    while True:
        chosen = chosen[kept]
        poles = refine_poles(
            lines,
            start.candidates[chosen],
            start.variance,
            beyond=beyond,
            doubt=poles.inflation[kept],
            begin=poles.pole[kept],
            steps=start.steps,
        )
        beyond = poles.beyond
        found = significance(lines, poles.residual, poles.pole, start.noise, beyond)
        aside = unresolved(lines, poles.pole) & ~held[chosen]
        bad = (_vague(lines, poles, found) & ~held[chosen]) | aside
        if not bad.any():
            return _Settled(chosen, poles, poles.fit, found)
        beyond = np.append(beyond, poles.pole[aside])
        kept = np.flatnonzero(~bad)


def _weighed(
    lines: FrfLines, noise: FloatArray, poles: RefinedPoles
) -> tuple[float, FloatArray]:
    """Return the model error of a fit, and the variance of the lines with it."""
    error = model_error(poles.residual, noise, lines.response)
    return error, line_variance(noise, error, poles.residual, lines.response)


def _completed(
    lines: FrfLines,
    start: _Start,
    done: _Settled,
    scatter: FloatArray | None,
    added: ComplexArray,
) -> tuple[_Start, _Settled] | None:
    """Add poles that the residual shows; None where it shows nothing.

    Weights are taken again: what was missing counted as model error.
    """
    poles = done.poles
    beyond = poles.beyond
    if poles.pole.size != start.searched:
        beyond = find_beyond(_final(lines, start, done))
    if added.size == 0 and beyond.size == poles.beyond.size:
        return None
    everything = np.append(start.candidates, added)
    held = np.append(start.held, np.zeros(added.size, bool))
    place = np.arange(start.candidates.size, everything.size)
    if start.before is not None:
        # Dropped while more of the residual counted as model error.
        again = np.setdiff1d(start.before, done.chosen)
        place = np.append(again[~unresolved(lines, everything[again])], place)
    begun = _again(
        lines, np.append(poles.pole, everything[place]), beyond, start.variance
    )
    noise = line_noise(lines.response, scatter, begun.residual)
    error = min(start.error, model_error(begun.residual, noise, lines.response))
    variance = line_variance(noise, error, begun.residual, lines.response)
    wider = replace(
        start,
        candidates=everything,
        held=held,
        noise=noise,
        variance=variance,
        error=error,
        before=None,
        searched=-1,
    )
    chosen = np.append(done.chosen, place)
    left = needed(
        lines,
        begun.pole,
        held[chosen],
        noise,
        variance,
        begun.beyond,
        begun.residual,
    )
    return wider, _settled(lines, wider, chosen, left, begun)


def _final(lines: FrfLines, start: _Start, done: _Settled) -> WholeFit:
    return _whole(lines, done.poles, start.noise, start.variance)


def _forced(
    lines: FrfLines, start: _Start, done: _Settled, force: ForceNoise | None
) -> FloatArray:
    if force is None or force.width <= 0.0:
        return np.zeros((done.poles.pole.size, 2, 2))
    return force_covariance(lines, done.poles, done.fit, start.variance, force)


def _doubts(
    lines: FrfLines,
    start: _Start,
    done: _Settled,
    denied: ComplexArray,
    *,
    tried: bool,
) -> DoubtfulNeighbours:
    if not tried:
        nothing = np.zeros((done.poles.pole.size, 2, 2))
        return DoubtfulNeighbours(np.empty(0), nothing, np.empty(0))
    own = done.poles.covariance * done.poles.inflation[:, None, None]
    return doubtful_neighbours(_final(lines, start, done), own, denied)


def _again(
    lines: FrfLines,
    pole: ComplexArray,
    beyond: ComplexArray,
    variance: FloatArray,
) -> RefinedPoles:
    """Refine modes and poles beyond the band for a few steps."""
    return refine_poles(lines, pole, variance, beyond=beyond, steps=_FEW_STEPS)


def _whole(
    lines: FrfLines, poles: RefinedPoles, noise: FloatArray, variance: FloatArray
) -> WholeFit:
    everything = np.append(poles.pole, poles.beyond)
    return WholeFit(lines, everything, poles.pole.size, poles.fit, noise, variance)


def _silent(what: str, share: float) -> None:
    """Report nothing."""


def _first_fit(
    lines: FrfLines,
    candidates: ComplexArray,
    held: BoolArray,
    noise: FloatArray,
    variance: FloatArray,
    steps: int,
) -> tuple[IntArray, RefinedPoles]:
    """Refine what is needed; poles that end beyond the band become computational."""
    none = np.empty(0, complex)
    chosen = needed(lines, candidates, held, noise, variance, none)
    poles = refine_poles(lines, candidates[chosen], variance, steps=steps, rough=True)
    aside = unresolved(lines, poles.pole) & ~held[chosen]
    if not aside.any() or steps == 0:
        return chosen, poles
    left = refine_poles(
        lines,
        candidates[chosen[~aside]],
        variance,
        beyond=poles.pole[aside],
        begin=poles.pole[~aside],
        steps=steps,
    )
    return chosen[~aside], left


def _vague(lines: FrfLines, poles: RefinedPoles, significance: FloatArray) -> BoolArray:
    """Return which modes to drop because their damping is uncertain.

    The damping is taken without the window's: under a strong exponential window every
    noise peak has the window's width.

    Two poles on one peak are both vague, and the fit is as good with one: of
    overlapping vague poles only the least significant goes, then the rest are refitted.
    A peak that no linear mode fits, as that of a mode which softens by more than its
    width, is a mode all the same: it explains nearly all that is there.
    """
    width = measured_width(lines, poles.pole)
    sd = np.sqrt(poles.covariance[:, 0, 0] * poles.inflation)
    vague: BoolArray = sd > _VAGUE * np.abs(poles.pole.real)
    apart = np.abs(poles.pole.imag[:, None] - poles.pole.imag)
    overlap = apart < 2.0 * (width[:, None] + width)
    rival = overlap & vague & (significance < significance[:, None])
    alone = np.count_nonzero(overlap, axis=1) == 1
    peak = alone & (significance > _EXPLAINED * local_size(lines))
    return np.asarray(vague & ~rival.any(axis=1) & ~peak)
