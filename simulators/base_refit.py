# SPDX-License-Identifier: MIT
"""Refit the base model of a campaign to noise-free responses, priors included.

Only for judging how much of a hidden effect the base can follow; it starts at the
truth and knows the noise, which no analyst does.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.arrays import FloatArray, freeze
from jointbench.simulators.campaign_design import (
    BASE_NAMES,
    FORCE_NOISE,
    NOMINAL_SIGMA,
    PRETRIGGER,
    SAMPLE_RATE,
    SAMPLES,
    CampaignDesign,
)
from jointbench.simulators.campaign_response import sketch_responses

_LOG_STEP = 1e-4  # of the base parameters
_MOST_STEPS = 6
_LONGEST_STEP = 0.4  # of a logarithm
_LARGE = 300.0  # weighted change beyond which a refit starts with short windows
_WINDOWS = (3e-3, 12e-3)  # [s]


@dataclass(frozen=True, slots=True, eq=False)
class BaseView:
    """The base of a design as weighted least squares sees it.

    Attributes:
        design: the campaign without effects.
        responses: of the base at its true values [m/s^2], shape (n_records, 2, n).
        weight: 1/sigma of every sample, same shape.
        slopes: of the weighted responses against the logarithms of the parameters,
            then the priors, shape (n_rows, 6).
        basis: orthonormal columns that span `slopes`.
    """

    design: CampaignDesign
    responses: FloatArray
    weight: FloatArray
    slopes: FloatArray
    basis: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "responses", "weight", "slopes", "basis")


def base_view(design: CampaignDesign) -> BaseView:
    """Weigh the base responses of a design and differentiate them."""
    responses = sketch_responses(design)
    nothing = np.zeros((0, len(BASE_NAMES)))
    bare = BaseView(design, responses, 1 / _sigma(design, responses), nothing, nothing)
    slopes = _slopes(bare, np.zeros(len(BASE_NAMES)), responses)
    return replace(bare, slopes=slopes, basis=np.linalg.qr(slopes)[0])


def project(view: BaseView, change: FloatArray) -> FloatArray:
    """Return what is left of a small change once the base has followed it.

    Args:
        view: the base.
        change: of the responses [m/s^2], shape (n_records, 2, n).

    Returns:
        Weighted change of the records, then of the priors [-], shape (n_rows,).
    """
    row = np.append((view.weight * change).ravel(), np.zeros(len(BASE_NAMES)))
    return np.asarray(row - view.basis @ (view.basis.T @ row), dtype=float)


def refit_residual(view: BaseView, responses: FloatArray) -> FloatArray:
    """Return what the refitted base leaves of responses with an effect.

    A large change is followed from its beginning: the first milliseconds have few
    oscillations in which a fit could lose its place.

    Args:
        view: the base.
        responses: noise-free, with the effect [m/s^2], shape (n_records, 2, n).

    Returns:
        Weighted residual of the records, then of the priors [-], shape (n_rows,).
    """
    offset = np.zeros(len(BASE_NAMES))
    if np.linalg.norm(project(view, responses - view.responses)) > _LARGE:
        for duration in _WINDOWS:
            offset = _refit(_windowed(view, duration), responses, offset)
    offset = _refit(view, responses, offset)
    return _residual(view, offset, responses, _responses(view, offset))


def _windowed(view: BaseView, duration: float) -> BaseView:
    """Return a view whose weight decays within `duration` [s] of the hit."""
    time = np.maximum(np.arange(SAMPLES) - PRETRIGGER, 0) / SAMPLE_RATE
    window = np.exp(-time / duration) * np.ones_like(view.weight)
    rows = np.append(window.ravel(), np.ones(len(BASE_NAMES)))
    return replace(
        view, weight=view.weight * window, slopes=view.slopes * rows[:, None]
    )


def _refit(view: BaseView, wanted: FloatArray, offset: FloatArray) -> FloatArray:
    """Return the best logarithmic offsets of the base by damped Gauss-Newton."""
    current = _responses(view, offset)
    left = _residual(view, offset, wanted, current)
    for _ in range(_MOST_STEPS):
        slopes = _slopes(view, offset, current) if offset.any() else view.slopes
        step = np.asarray(np.linalg.solve(slopes.T @ slopes, slopes.T @ left), float)
        step *= min(1.0, _LONGEST_STEP / float(np.abs(step).max() + 1e-300))
        cost, hoped = _square(left), _square(left - slopes @ step)
        if cost - hoped < 0.01 * cost + 0.01:
            break
        moved = _shorten(view, offset, step, wanted, cost)
        if moved is None:
            break
        offset, current, left = moved
        if _square(left) < 1.02 * hoped + 0.01:
            break  # the model was straight enough: no step would gain more
    return offset


def _shorten(
    view: BaseView,
    offset: FloatArray,
    step: FloatArray,
    wanted: FloatArray,
    cost: float,
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Halve a step until it lowers the cost; None if it never does."""
    for halving in range(6):
        trial = offset + step * 0.5**halving
        current = _responses(view, trial)
        left = _residual(view, trial, wanted, current)
        if _square(left) < cost:
            return trial, current, left
    return None


def _square(values: FloatArray) -> float:
    return float(values @ values)


def _responses(view: BaseView, offset: FloatArray) -> FloatArray:
    physical = _values(view.design.physical, offset)
    return sketch_responses(view.design, physical=physical)


def _values(physical: Mapping[str, float], offset: FloatArray) -> dict[str, float]:
    return {
        name: physical[name] * float(np.exp(change))
        for name, change in zip(BASE_NAMES, offset, strict=True)
    }


def _priors() -> FloatArray:
    return np.array([1 / NOMINAL_SIGMA[name] for name in BASE_NAMES])


def _residual(
    view: BaseView, offset: FloatArray, wanted: FloatArray, current: FloatArray
) -> FloatArray:
    records = (view.weight * (wanted - current)).ravel()
    return np.append(records, -_priors() * offset)


def _slopes(view: BaseView, offset: FloatArray, at: FloatArray) -> FloatArray:
    """Differentiate weighted responses and priors; `at` holds those at the offset."""
    columns = []
    for i in range(len(BASE_NAMES)):
        trial = offset.copy()
        trial[i] += _LOG_STEP
        records = (view.weight * (_responses(view, trial) - at)).ravel() / _LOG_STEP
        columns.append(np.append(records, np.eye(len(BASE_NAMES))[i] * _priors()))
    return np.stack(columns, axis=1)


def _sigma(design: CampaignDesign, base: FloatArray) -> FloatArray:
    """Return noise, noise of the force carried through the model, and scatter."""
    noise = design.noise**2 * (1 + FORCE_NOISE**2 * _force_gain(design, base))
    peak = np.abs(base).max(axis=2, keepdims=True)
    return np.asarray(np.sqrt(noise + (design.hit_scatter * peak) ** 2))


def _force_gain(design: CampaignDesign, base: FloatArray) -> FloatArray:
    """Return the summed squares of the responses to unit samples of the force.

    Noise counts while the hit lasts, outside the force is known to be zero. A hit is
    short: its response over the sum of its samples stands for that to one sample.
    """
    gain = np.empty_like(base)
    for i, condition in enumerate(design.conditions):
        pulse = condition.pulse
        samples = SAMPLE_RATE * pulse.width
        # The mean of a half sine raised to 1.6 is 0.55 of its peak.
        gain[i] = samples * (base[i] / (0.55 * samples * pulse.peak)) ** 2
    return gain
