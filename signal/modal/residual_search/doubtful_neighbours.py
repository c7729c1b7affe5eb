# SPDX-License-Identifier: MIT
"""Neighbours that may be missing, with their probability, in the intervals of modes.

Between "the residual is white" and "the FRF needs one more mode" lies the case in which
a neighbour may be missing: its own pole would be too uncertain to report, yet it moves
the modes around it. So one more mode is tried at places all around each mode. Every
place has a probability, from its Bayes factor, from how many modes a band of that width
holds and from how many of these are so small, and a shift. The interval of the mode is
that of the mixture: the value is kept, and 95 % of the probability lie within.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy.special

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.signal.modal.frf_lines import measured_width
from jointbench.signal.modal.residual_search.local_fit import (
    Group,
    TrialPoles,
    WholeFit,
    group_around,
    residue_scale,
    residue_shares,
    try_poles,
)
from jointbench.signal.modal.residual_search.missing_modes import refined_group

# Lines around a mode: half-power half-widths, and lines at least, each side.
_REACH_WIDTHS, _REACH_LINES = 8.0, 40
# Places: half-power half-widths from the mode, and decay rates over its own; with many
# FRFs fewer, as these leave less open.
_AWAY = (0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.5, 6.0)
_DECAYS = (0.5, 1.0, 2.0)
_FEW_AWAY, _FEW_DECAYS = (0.3, 0.75, 1.5, 3.0), (1.0,)
_FEW_FRFS = 16
# Sizes of their residues over the rms of those found; weak modes are those missed.
_SHARES = (1.0, 0.3, 0.1, 0.03)
# Density of modes that may be missing over that of the modes found.
_DENSITY = 2.0
# Modes of each size that are counted before any is found (Jeffreys' prior of shares).
_COUNTED = 0.5
# Residual power over noise up to which a model with one more mode is admissible: else
# leakage or a nonlinear structure is left, which no neighbour explains.
_ADMISSIBLE = 4.0
# Probability of a neighbour from which it is stated.
_STATED = 0.9
# Residual power over the variance from which it counts in place of it.
_CLEAN = 1.1
# Log Bayes factor of a neighbour whose evidence is beyond first order.
_CERTAIN = 700.0
# Share of the probability in an interval, and its half-width in sd of a normal law; an
# interval that holds this much without neighbours is left as it is.
_HELD, _NORMAL, _ENOUGH = 0.95, 1.959964, 0.945
_HALVINGS = 40


@dataclass(frozen=True, slots=True, eq=False)
class DoubtfulNeighbours:
    """Where a mode may be missing, and what it would change.

    Attributes:
        frequency: of the neighbours [Hz], shape (n,), ascending.
        shift: mean squared change of (Re p, Im p) of each mode [rad^2/s^2], shape
            (n_modes, 2, 2).
        denied: resonances that the lines need and the orders of the fit do not show
            [Hz], shape (n,), ascending.
    """

    frequency: FloatArray
    shift: FloatArray
    denied: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "shift", "denied")


def doubtful_neighbours(
    whole: WholeFit, covariance: FloatArray, denied: ComplexArray
) -> DoubtfulNeighbours:
    """Try one more mode around each mode.

    Args:
        whole: final fit of all lines.
        covariance: of (Re p, Im p) of each mode [rad^2/s^2], shape (n_modes, 2, 2).
        denied: poles that the orders of the fit do not show [rad/s].

    Returns:
        Places, and what they add to the covariance.

    Source:
        Hoeting et al., Bayesian model averaging, Statistical Science 14 (1999) 382.
    """
    shift = np.zeros((whole.n_modes, 2, 2))
    places: list[float] = []
    modes = whole.pole[: whole.n_modes]
    width = measured_width(whole.lines, modes)
    share = _share_prior(whole)
    for number in range(whole.n_modes):
        group = _group(whole, number, width)
        trials, cell = _places(whole, modes[number], float(width[number]))
        if trials.size == 0:
            continue
        index = np.append(group.modes, group.beyond)
        found = _tried(whole, group, index, trials)
        if found is None:
            continue
        density = _DENSITY * whole.n_modes / float(np.ptp(whole.lines.laplace.imag))
        prior = density * np.outer(share, cell).ravel()
        weight = _weights(found.log_factor, prior)
        own = int(np.flatnonzero(index == number)[0])
        _add(shift[number], covariance[number], found, weight, own)
        if 1.0 - weight[0] > _STATED:
            likeliest = int(np.argmax(weight[1:])) % trials.size
            places.append(float(trials[likeliest].imag))
    apart = np.abs(denied.imag[:, None] - modes.imag)
    broad = np.maximum(measured_width(whole.lines, denied)[:, None], width)
    left = denied[np.all(apart > broad, axis=1)]
    return DoubtfulNeighbours(
        _distinct(places, width), shift, _distinct(left.imag.tolist(), width)
    )


def _tried(
    whole: WholeFit, group: Group, index: IntArray, trials: ComplexArray
) -> TrialPoles | None:
    """Return what one more mode changes; None where none is admissible.

    What the likeliest leaves counts as noise: leakage, a nonlinear structure.
    """
    scale, pole = residue_scale(whole), whole.pole[index]
    found = try_poles(group.lines, group.variance, pole, trials, scale, _SHARES)
    power = 2.0 * np.abs(group.residual) ** 2
    best, count = float(found.gain.max()), 2.0 * power.size
    noise = float(np.sum(power / group.noise))
    left = float(np.sum(power / group.variance)) - best
    if noise * left / (left + best) > _ADMISSIBLE * count:
        likeliest = int(np.argmax(found.log_factor)) % trials.size
        return _refined(whole, group, found, complex(trials[likeliest]))
    if left < _CLEAN * count:
        return found
    variance = group.variance * left / count
    return try_poles(group.lines, variance, pole, trials, scale, _SHARES)


def _refined(
    whole: WholeFit, group: Group, found: TrialPoles, start: complex
) -> TrialPoles | None:
    """Return the likeliest neighbour beyond first order; None if it is not admissible.

    Nothing else is left to weigh where its evidence is so strong.
    """
    without = refined_group(whole, group)
    fitted = refined_group(whole, group, start)
    ratio = float(np.mean(np.abs(fitted.residual) ** 2 / group.noise))
    if ratio > _ADMISSIBLE or fitted.pole[-1].real >= 0.0:
        return None
    before = np.append(without.pole, without.beyond)
    after = np.append(fitted.pole[:-1], fitted.beyond)
    spread = np.zeros((before.size, 2))
    own = fitted.covariance[:-1] * np.maximum(fitted.inflation[:-1, None, None], 1.0)
    spread[: group.modes.size] = np.diagonal(own, axis1=1, axis2=2)
    change = (after - before).view(np.float64).reshape(-1, 2)
    certain = np.full(found.log_factor.size, -np.inf)
    certain[int(np.argmax(found.log_factor))] = _CERTAIN
    return replace(
        found,
        log_factor=certain,
        shift=np.broadcast_to(change, found.shift.shape),
        variance=np.broadcast_to(spread, found.variance.shape),
    )


def _group(whole: WholeFit, number: int, width: FloatArray) -> Group:
    pitch = float(np.median(np.diff(whole.lines.laplace.imag)))
    reach = max(_REACH_WIDTHS * float(width[number]), _REACH_LINES * pitch)
    place = float(whole.pole[number].imag)
    low, high = whole.lines.laplace.imag[[0, -1]]
    edge = place - reach < low or place + reach > high
    return group_around(whole, place, reach, with_beyond=bool(edge))


def _places(
    whole: WholeFit, pole: complex, width: float
) -> tuple[ComplexArray, FloatArray]:
    """Return trial poles around a mode, and the band that each stands for [rad/s]."""
    many = whole.noise.shape[0] > _FEW_FRFS
    away = width * np.array(_FEW_AWAY if many else _AWAY)
    decays = np.array(_FEW_DECAYS if many else _DECAYS)
    edges = np.concatenate(([0.0], 0.5 * (away[1:] + away[:-1]), away[-1:]))
    place = pole.imag + np.concatenate((-away, away))
    cell = np.tile(np.diff(edges), 2) / decays.size
    low, high = whole.lines.laplace.imag[[0, -1]]
    inside = (place > low) & (place < high)
    added = float(whole.lines.laplace.real[0])
    trials = (added + 1j * place[inside, None] - width * decays).ravel()
    damped = trials.real < 0.0
    cells = np.repeat(cell[inside], decays.size)[damped]
    return np.asarray(trials[damped]), np.asarray(cells)


def _share_prior(whole: WholeFit) -> FloatArray:
    """Return the probability of each size of a missing mode, from those of the found.

    What is far below the noise cannot be excluded, but where all modes that are found
    stand far above it, few are to be expected there.
    """
    count = np.full(len(_SHARES), _COUNTED)
    if whole.n_modes:
        away = np.log(residue_shares(whole))[:, None] - np.log(_SHARES)
        np.add.at(count, np.argmin(np.abs(away), axis=1), 1.0)
    return np.asarray(count / count.sum())


def _weights(log_factor: FloatArray, prior: FloatArray) -> FloatArray:
    """Return probabilities: of no further mode, then of one at each place."""
    log_odds = np.append(0.0, log_factor + np.log(prior))
    return np.asarray(scipy.special.softmax(log_odds))


def _add(
    shift: FloatArray,
    covariance: FloatArray,
    found: TrialPoles,
    weight: FloatArray,
    own: int,
) -> None:
    """Widen the variances of a mode to those of the mixture."""
    base = np.diag(covariance)
    moved = np.vstack((np.zeros(2), found.shift[:, own]))
    grown = np.maximum(found.variance[:, own] - found.before[own], 0.0)
    sd = np.sqrt(base + np.vstack((np.zeros(2), grown)))
    held = _held(_NORMAL * sd[0], weight, moved, sd)
    low, high = np.zeros(2), np.max(np.abs(moved) + 6.0 * sd, axis=0)
    for _ in range(_HALVINGS):
        half = 0.5 * (low + high)
        more = _held(half, weight, moved, sd) < _HELD
        low, high = np.where(more, half, low), np.where(more, high, half)
    both = np.arange(2)
    wider = np.maximum((high / _NORMAL) ** 2 - base, 0.0)
    shift[both, both] = np.where(held < _ENOUGH, wider, 0.0)


def _held(
    half: FloatArray, weight: FloatArray, moved: FloatArray, sd: FloatArray
) -> FloatArray:
    """Return the probability within intervals of a half-width, of Re p and of Im p."""
    upper, lower = (half - moved) / sd, (-half - moved) / sd
    within = scipy.special.ndtr(upper) - scipy.special.ndtr(lower)
    return np.asarray(weight @ within)


def _distinct(places: list[float], width: FloatArray) -> FloatArray:
    """Return frequencies [Hz], ascending, each once."""
    kept: list[float] = []
    for place in sorted(places):
        if not kept or place - kept[-1] > float(np.median(width)):
            kept.append(place)
    return np.array(kept) / (2.0 * np.pi)


def neighbour_words(doubts: DoubtfulNeighbours) -> tuple[str, ...]:
    """State where modes may be missing, and what would show them.

    Args:
        doubts: of the final fit.

    Returns:
        A sentence on neighbours and one on resonances apart from modes, where any are.
    """
    words = []
    if doubts.frequency.size:
        one = doubts.frequency.size == 1
        words.append(
            f"{'a mode' if one else 'modes'} may be missing near "
            f"{_listed(doubts.frequency)}: the residual is that of a resonance there, "
            "too weak or too close to another to be reported; the intervals of the "
            "modes around include it; another accelerometer or hammer point, or more "
            "hits, would show it"
        )
    if doubts.denied.size:
        words.append(
            f"the lines near {_listed(doubts.denied)} need a resonance that too few "
            "orders of the fit show, so it is not reported: a mode with little "
            "damping, leakage or a nonlinear structure; record longer after each hit, "
            "or compare hits of two levels"
        )
    return tuple(words)


def _listed(frequency: FloatArray) -> str:
    """Return the frequencies as words; all, as each stands for a mode to look for."""
    return ", ".join(f"{f:.6g}" for f in frequency) + " Hz"
