# SPDX-License-Identifier: MIT
"""Refit the base model of a campaign to noise-free responses, priors included.

Only to estimate how much of a hidden effect the base, alone or with a rival, can
represent; it starts at the true values and uses the true noise, which no analyst has.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.simulators.detectability.rival_effects import move_rival
from jointbench.simulators.hidden.campaign_design import (
    BASE_NAMES,
    NOMINAL_SIGMA,
    CampaignDesign,
)
from jointbench.simulators.hidden.campaign_response import sketch_responses
from jointbench.simulators.hidden.campaign_sampling import (
    PRETRIGGER,
    SAMPLE_RATE,
    SAMPLES,
)
from jointbench.simulators.hidden.hidden_effects import HiddenEffect
from jointbench.simulators.hidden.sample_weights import (
    SampleWeights,
    sample_weights,
    weigh,
    windowed,
)

_BASE = len(BASE_NAMES)
_LOG_STEP = 1e-7  # of the base parameters: at 1e-4 a record's end misses its slope
_CURVE_STEP = 1e-4  # of the joint's stiffness, differenced to both sides
_RIVAL_STEP = 1e-3  # of the rival's, whose change is smaller
_MOST_STEPS = 6
_LONGEST_STEP = 0.4  # of a logarithm of the base
_LONGEST_MOVE = 1.0  # of a rival's parameter
_LARGE = 300.0  # weighted change beyond which a refit starts with short windows
_WINDOWS = (3e-3, 12e-3)  # [s]


@dataclass(frozen=True, slots=True, eq=False)
class BaseView:
    """The base of a design for weighted least squares.

    Attributes:
        design: the campaign without effects.
        responses: of the base at its true values [m/s^2], shape (n_records, 2, n).
        weights: of the samples.
        slopes: of the weighted responses against the logarithms of the parameters,
            then the priors, shape (n_rows, 6), at the truth.
        basis: orthonormal columns that span `slopes`.
    """

    design: CampaignDesign
    responses: FloatArray
    weights: SampleWeights
    slopes: FloatArray
    basis: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "responses", "slopes", "basis")


@dataclass(frozen=True, slots=True, eq=False)
class BaseFit:
    """A refitted base, perhaps with a rival.

    Attributes:
        moves: logarithmic offsets of the base parameters from the truth, then the
            moves of the rival's parameters [-], shape (6 + n_free,).
        left: weighted residual of the records, then of the priors [-], (n_rows,).
    """

    moves: FloatArray
    left: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "moves", "left")

    @property
    def cost(self) -> float:
        """Sum of squares of the residual [-]."""
        return float(self.left @ self.left)


def base_view(design: CampaignDesign, *, samples: int | None = None) -> BaseView:
    """Weigh the base responses of a design and differentiate them.

    Args:
        design: the campaign without effects.
        samples: of a record that count, from its start; None for all.
    """
    responses = sketch_responses(design)
    stiff, soft = _stiffer_and_softer(design)
    slope = (stiff - soft) / (2 * _CURVE_STEP)
    curve = (stiff - 2 * responses + soft) / _CURVE_STEP**2
    weights = sample_weights(design, responses, slope, curve, samples=samples)
    nothing = np.zeros((0, _BASE))
    bare = BaseView(design, responses, weights, nothing, nothing)
    return _with_slopes(bare)


def stiffness_slope(design: CampaignDesign) -> FloatArray:
    """Return the derivative of the responses to ln kj [m/s^2], (n_records, 2, n)."""
    stiff, soft = _stiffer_and_softer(design)
    return np.asarray((stiff - soft) / (2 * _CURVE_STEP))


def _stiffer_and_softer(design: CampaignDesign) -> list[FloatArray]:
    """Return the responses of a joint a little stiffer, and a little softer."""
    step = np.where(np.array(BASE_NAMES) == "kj", _CURVE_STEP, 0.0)
    return [
        sketch_responses(design, physical=_values(design.physical, sign * step))
        for sign in (1, -1)
    ]


def project(view: BaseView, change: FloatArray) -> FloatArray:
    """Return the residual of a small change after the base is refitted.

    Args:
        view: the base.
        change: of the responses [m/s^2], shape (n_records, 2, n).

    Returns:
        Weighted change of the records, then of the priors [-], shape (n_rows,).
    """
    row = _row(view, change, np.zeros(_BASE))
    return np.asarray(row - view.basis @ (view.basis.T @ row), dtype=float)


def follow(view: BaseView, change: FloatArray) -> FloatArray:
    """Return the base offsets fitted to a small change, shape (6,)."""
    return _solve(view.slopes, _row(view, change, np.zeros(_BASE)))


def refit_base(view: BaseView, responses: FloatArray) -> BaseFit:
    """Refit the base alone to responses with an effect.

    A large change is fitted from its beginning: the first milliseconds have few
        oscillations, and so no local minima.

    Args:
        view: the base, with its slopes at the truth.
        responses: noise-free, with the effect [m/s^2], shape (n_records, 2, n).

    Returns:
        The closest base.
    """
    start = np.zeros(_BASE)
    if np.linalg.norm(project(view, responses - view.responses)) > _LARGE:
        moves = start
        for duration in _WINDOWS:
            moves = refit_moves(_windowed(view, duration), responses, moves).moves
        starts = (try_moves(view, responses, each, None) for each in (start, moves))
        start = min(starts, key=lambda fit: fit.cost).moves
    return refit_moves(view, responses, start)


def refit_moves(
    view: BaseView,
    wanted: FloatArray,
    start: FloatArray,
    rival: HiddenEffect | None = None,
) -> BaseFit:
    """Refit the base, and the parameters of a rival, by damped Gauss-Newton.

    Args:
        view: the base, with its slopes at the truth.
        wanted: responses to fit [m/s^2], shape (n_records, 2, n).
        start: moves to start from, shape (6 + n_free,).
        rival: additional effects; none for the base alone.

    Returns:
        The best moves.

    Source:
        With a rival the derivatives are corrected by secants, Broyden, Math. Comp. 19
        (1965) 577: sliders are slow to differentiate.
    """
    fit = try_moves(view, wanted, start, rival)
    slopes = _all_slopes(view, start, rival)
    for _ in range(_MOST_STEPS):
        step = _solve(slopes, fit.left)
        step *= min(1.0, 1 / float(np.abs(step / _longest(step.size)).max() + 1e-300))
        hoped = _square(fit.left - slopes @ step)
        if fit.cost - hoped < 0.01 * fit.cost + 0.01:
            break
        better = _shorten(view, wanted, fit, step, rival)
        if better is None:
            break
        last, fit = fit, better
        if fit.cost < 1.02 * hoped + 0.01:
            break  # the model is nearly linear: no step would gain more
        if rival is None:
            slopes = _slopes(view, fit.moves)
        else:
            slopes = _secant(slopes, last, fit)
    return fit


def try_moves(
    view: BaseView, wanted: FloatArray, moves: FloatArray, rival: HiddenEffect | None
) -> BaseFit:
    """Return the residual of the wanted responses after moves, as in `refit_moves`."""
    change = wanted - _responses(view, moves, rival)
    return BaseFit(moves, _row(view, change, -_priors() * moves[:_BASE]))


def _with_slopes(view: BaseView) -> BaseView:
    slopes = _slopes(view, np.zeros(_BASE))
    return replace(view, slopes=slopes, basis=np.linalg.qr(slopes)[0])


def _windowed(view: BaseView, duration: float) -> BaseView:
    """Return a view whose weight decays within `duration` [s] of the hit."""
    time = np.maximum(np.arange(SAMPLES) - PRETRIGGER, 0) / SAMPLE_RATE
    window = np.exp(-time / duration)
    short = replace(view, weights=windowed(view.weights, window))
    return _with_slopes(short)


def _shorten(
    view: BaseView,
    wanted: FloatArray,
    fit: BaseFit,
    step: FloatArray,
    rival: HiddenEffect | None,
) -> BaseFit | None:
    """Halve a step until it lowers the cost; None if it never does."""
    for halving in range(6):
        trial = try_moves(view, wanted, fit.moves + step * 0.5**halving, rival)
        if trial.cost < fit.cost:
            return trial
    return None


def _solve(slopes: FloatArray, left: FloatArray) -> FloatArray:
    """Return the least-squares step; a move without effect stays 0."""
    size = np.linalg.norm(slopes, axis=0) + 1e-12
    scaled = slopes / size
    gram = scaled.T @ scaled + 1e-10 * np.eye(size.size)
    return np.asarray(np.linalg.solve(gram, scaled.T @ left) / size, dtype=float)


def _longest(size: int) -> FloatArray:
    return np.where(np.arange(size) < _BASE, _LONGEST_STEP, _LONGEST_MOVE)


def _square(values: FloatArray) -> float:
    return float(values @ values)


def _responses(
    view: BaseView, moves: FloatArray, rival: HiddenEffect | None
) -> FloatArray:
    physical = _values(view.design.physical, moves[:_BASE])
    effects = () if rival is None else (move_rival(rival, moves[_BASE:]),)
    # Too large a move may diverge; its cost is then refused.
    with np.errstate(all="ignore"):
        return sketch_responses(view.design, effects, physical=physical)


def _values(physical: Mapping[str, float], offset: FloatArray) -> dict[str, float]:
    return {
        name: physical[name] * float(np.exp(change))
        for name, change in zip(BASE_NAMES, offset, strict=True)
    }


def _priors() -> FloatArray:
    return np.array([1 / NOMINAL_SIGMA[name] for name in BASE_NAMES])


def _row(view: BaseView, change: FloatArray, priors: FloatArray) -> FloatArray:
    with np.errstate(all="ignore"):
        return np.append(weigh(view.weights, change), priors)


def _slopes(view: BaseView, moves: FloatArray) -> FloatArray:
    """Differentiate weighted responses and priors of the base alone."""
    at = _responses(view, moves, None)
    columns = []
    for i, prior in enumerate(_priors()):
        unit = np.eye(_BASE)[i]
        change = _responses(view, moves + _LOG_STEP * unit, None) - at
        columns.append(_row(view, change / _LOG_STEP, prior * unit))
    return np.stack(columns, axis=1)


def _all_slopes(
    view: BaseView, moves: FloatArray, rival: HiddenEffect | None
) -> FloatArray:
    """Differentiate against all moves; the base's slopes are those without rival."""
    offset = moves[:_BASE]
    slopes = _slopes(view, offset) if offset.any() else view.slopes
    if rival is None:
        return slopes
    at = _responses(view, moves, rival)
    columns = [slopes]
    for unit in np.eye(moves.size)[_BASE:]:
        change = _responses(view, moves + _RIVAL_STEP * unit, rival) - at
        columns.append(_row(view, change / _RIVAL_STEP, np.zeros(_BASE))[:, None])
    return np.hstack(columns)


def _secant(slopes: FloatArray, last: BaseFit, fit: BaseFit) -> FloatArray:
    """Correct derivatives by the change of the last step, Broyden's good update."""
    step = fit.moves - last.moves
    missed = last.left - fit.left - slopes @ step
    return slopes + np.outer(missed, step / _square(step))
