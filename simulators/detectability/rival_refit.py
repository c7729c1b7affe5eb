# SPDX-License-Identifier: MIT
"""Refit a rival of a hidden effect, and return the residual.

A grid of small rivals shows which can mimic an effect to first order. How well they do
depends on their own parameters and on the size of the effect.
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

_HALVINGS = 6  # of the size of a rival that starts too large


def at_other_site(effect: HiddenEffect) -> HiddenEffect | None:
    """Return the same effect at its other site; None if it has no other."""
    movable = effect.name in CATALOGUE and FAMILIES[effect.name].resizable
    if not movable or "dof" not in effect.parameters or effect.name == "hum":
        return None
    other = {**effect.parameters, "dof": 1 - effect.parameters["dof"]}
    return HiddenEffect(effect.name, other)


def best_shape(
    shapes: Sequence[HiddenEffect], directions: Sequence[FloatArray], left: FloatArray
) -> tuple[HiddenEffect, float] | None:
    """Return the shape most similar to the residual of an effect, at the fitted size.

    Args:
        shapes: small effects of one name and site.
        directions: residual of each after the base fit, (n_rows,) each.
        left: residual of the hidden effect after the base fit, shape (n_rows,).

    Returns:
        Shape and its correlation [-]; None if each would need an impossible sign.
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
        Norm of the residual [-], that of `alone` if the rival does not reduce it.
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


def sized_at_other_site(
    view: BaseView, effect: HiddenEffect, left: FloatArray
) -> HiddenEffect | None:
    """Return the effect at its other site, sized to fit the residual of the base."""
    other = at_other_site(effect)
    if other is None:
        return None
    change = sketch_responses(view.design, [other]) - view.responses
    best = best_shape([other], [project(view, change)], left)
    return None if best is None else best[0]
