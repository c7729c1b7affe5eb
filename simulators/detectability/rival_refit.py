# SPDX-License-Identifier: MIT
"""Refit a rival of a hidden effect: what is left of the effect at its best.

A grid of small rivals says who could mimic an effect to first order. How well they do
is decided by their own parameters, and at the size of the effect.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.detectability.base_refit import (
    BaseFit,
    BaseView,
    follow,
    project,
    refit_moves,
    try_moves,
)
from jointbench.simulators.detectability.rival_effects import free_count, may_turn
from jointbench.simulators.hidden.campaign_response import sketch_responses
from jointbench.simulators.hidden.effect_draws import CATALOGUE, FAMILIES, resize_effect
from jointbench.simulators.hidden.hidden_effects import HiddenEffect

_HALVINGS = 6  # of the size of a rival that starts out too large


def twin_effect(effect: HiddenEffect) -> HiddenEffect | None:
    """Return the same effect at its other site; None where it has no other."""
    movable = effect.name in CATALOGUE and FAMILIES[effect.name].resizable
    if not movable or "dof" not in effect.parameters or effect.name == "hum":
        return None
    other = {**effect.parameters, "dof": 1 - effect.parameters["dof"]}
    return HiddenEffect(effect.name, other)


def best_shape(
    shapes: Sequence[HiddenEffect], directions: Sequence[FloatArray], left: FloatArray
) -> tuple[HiddenEffect, float] | None:
    """Return the shape most like what an effect leaves, at the size that fits.

    Args:
        shapes: small effects of one name and site.
        directions: what the base leaves of each, (n_rows,) each.
        left: what the base leaves of the hidden effect, shape (n_rows,).

    Returns:
        Shape and its correlation [-]; None where each would need a sign it cannot
        have.
    """
    best: tuple[HiddenEffect, float] | None = None
    norm = float(np.linalg.norm(left)) + 1e-300
    for shape, direction in zip(shapes, directions, strict=True):
        size = float(np.linalg.norm(direction)) + 1e-300
        along = float(direction @ left) / (size * norm)
        if along < 0 and not may_turn(shape.name):
            continue
        if best is None or abs(along) > best[1]:
            sized = resize_effect(shape, along * norm / size)
            best = sized, abs(along)
    return best


def refit_rival(
    view: BaseView, responses: FloatArray, alone: BaseFit, rival: HiddenEffect
) -> float:
    """Refit base and rival to the responses of a hidden effect.

    Args:
        view: the base, with its slopes at the truth.
        responses: noise-free, with the hidden effect [m/s^2], (n_records, 2, n).
        alone: the base refitted to them without the rival.
        rival: to start from.

    Returns:
        Norm of what is left [-], that of `alone` where the rival is of no use.
    """
    for halving in range(_HALVINGS):
        trial = resize_effect(rival, 0.5**halving)
        followed = follow(view, sketch_responses(view.design, [trial]) - view.responses)
        still = np.zeros(free_count(trial))
        starts = (
            try_moves(view, responses, np.append(offset, still), trial)
            for offset in (alone.moves - followed, np.zeros_like(followed))
        )
        start = min(starts, key=lambda fit: fit.cost)
        if start.cost < alone.cost:
            fit = refit_moves(view, responses, start.moves, trial)
            return float(np.sqrt(fit.cost))
    return float(np.sqrt(alone.cost))


def sized_twin(
    view: BaseView, effect: HiddenEffect, left: FloatArray
) -> HiddenEffect | None:
    """Return the twin of an effect at the size that fits what the base leaves."""
    twin = twin_effect(effect)
    if twin is None:
        return None
    change = sketch_responses(view.design, [twin]) - view.responses
    best = best_shape([twin], [project(view, change)], left)
    return None if best is None else best[0]
