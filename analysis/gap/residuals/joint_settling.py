# SPDX-License-Identifier: MIT
"""Stiffness of the joint in each hit: changes by laws, and settling."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.fit_records import Settled
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.lumped.lumped_model import LumpedModel


def joint_at(model: LumpedModel) -> int:
    """Return the index of the first joint's stiffness in the base coordinates."""
    return len(model.bodies) + model.first_joint


def changes_joint(model: LumpedModel, action: Action) -> bool:
    """Return whether an action only changes the first joint's stiffness."""
    return action.entry.rise is not None and action.index == model.first_joint


def stiffness_rise(
    model: LumpedModel, conditions: HitConditions, actions: Sequence[Action]
) -> FloatArray:
    """Return the relative change of the joint's stiffness by effects [-].

    Args:
        model: bodies and links.
        conditions: of each record.
        actions: all effects; those with any other action are ignored.

    Returns:
        Shape (n_records,), relative to the stiffness without them, above -1.
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
    """Return the log of the joint's mean stiffness, about which the hits settle.

    It follows the common scale of all other masses and stiffnesses, since a common
    scale changes no frequency. The scale is their median; a mean would change if a
    single mass passed a share to an added mass.
    """
    at = joint_at(model)
    count = len(model.bodies) + len(model.links)
    others = np.arange(count) != at
    scale = np.median((base - settled.anchor)[:count][others])
    return float(settled.anchor[at] + scale)
