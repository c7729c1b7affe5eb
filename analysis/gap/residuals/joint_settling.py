# SPDX-License-Identifier: MIT
"""Stiffness of the joint from hit to hit: what laws add to it, how it has settled."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.fit_records import Settled
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.lumped.lumped_model import LumpedModel


def joint_at(model: LumpedModel) -> int:
    """Return the place of the first joint's stiffness among the base coordinates."""
    return len(model.bodies) + model.first_joint


def changes_joint(model: LumpedModel, action: Action) -> bool:
    """Tell whether an action is a mere change of the first joint's stiffness."""
    return action.entry.rise is not None and action.index == model.first_joint


def stiffness_rise(
    model: LumpedModel, conditions: HitConditions, actions: Sequence[Action]
) -> FloatArray:
    """Return what effects add to the joint's stiffness in each record [-].

    Args:
        model: bodies and links.
        conditions: of each record.
        actions: all effects; those that do more than change the joint are passed over.

    Returns:
        Shape (n_records,); as a share of the stiffness without them, above -1.
    """
    total = np.zeros(conditions.preload.size)
    for action in actions:
        if changes_joint(model, action) and action.entry.rise is not None:
            total += action.entry.rise(conditions, action.values)
    return np.maximum(total, RESIDUALS.least_rise)


def hit_stiffness(conditions: HitConditions, settled: Settled) -> FloatArray:
    """Return the log of each hit's stiffness over the mean, shape (n_records,)."""
    settling = conditions.settling
    left = 1.0 if settling is None else np.exp(settling)
    return np.asarray(np.log(left + settled.rise))


def mean_stiffness(model: LumpedModel, base: FloatArray, settled: Settled) -> float:
    """Return the log of the joint's stiffness that the settling was added to.

    It goes with the scale of all other masses and stiffnesses: one scale for all
    changes no frequency, and so must not bend either. Their median is that scale;
    a mean would move when a single mass hands its share to an added one.
    """
    at = joint_at(model)
    count = len(model.bodies) + len(model.links)
    others = np.arange(count) != at
    scale = np.median((base - settled.anchor)[:count][others])
    return float(settled.anchor[at] + scale)
