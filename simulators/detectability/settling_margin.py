# SPDX-License-Identifier: MIT
"""Detectability of a law of preload or order over the scatter of the joint.

Such an effect is a separate stiffness for each record, and so is the scatter from hit
to hit: the two cannot be distinguished better than from one stiffness per record.
Weighted samples do not include this: they blur only two orders of the scatter, and a
precise record resolves the third.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.detectability.base_refit import BaseView, stiffness_slope
from jointbench.simulators.hidden.campaign_design import CampaignDesign
from jointbench.simulators.hidden.hidden_effects import HiddenEffect

_RIVALS = {"preload_stiffness": "loosening", "loosening": "preload_stiffness"}
_SMALL = 1e-3


def settled_shares(
    view: BaseView, effect: HiddenEffect
) -> tuple[float, float, str] | None:
    """Return the size of an effect over the scatter, and its rival's correlation.

    Args:
        view: the base of a design.
        effect: the hidden effect, at its size.

    Returns:
        Norm of the stiffnesses' shift over their sd, their mean free [-], its
        correlation with the rival's, and that rival's name and site; None without
        scatter, or if the effect is no stiffness of the records.

    Source:
        Weighted least squares of a mean and a pattern, one value per record.
    """
    scatter = view.design.hit_scatter
    if effect.name not in _RIVALS or scatter <= 0:
        return None
    slope = view.weights.inverse * stiffness_slope(view.design)
    weight = 1 / (scatter**2 + 1 / np.sum(slope**2, axis=(1, 2)))
    shift = _centred(_shift(view.design, effect), weight)
    name = _RIVALS[effect.name]
    small = {"n": _SMALL} if name == "preload_stiffness" else {"frac": _SMALL}
    rival = HiddenEffect(name, small)
    other = _centred(_shift(view.design, rival), weight)
    norm = float(np.linalg.norm(shift))
    size = max(norm * float(np.linalg.norm(other)), 1e-300)
    return norm, abs(float(shift @ other)) / size, f"{name} {rival.site}"


def _shift(design: CampaignDesign, effect: HiddenEffect) -> FloatArray:
    """Return the logarithm of each record's stiffness over the base's."""
    if effect.name == "preload_stiffness":
        ratio = np.array([c.preload_ratio for c in design.conditions])
        return np.asarray(effect.parameters["n"] * np.log(ratio))
    progress = np.array([c.progress for c in design.conditions])
    return np.asarray(np.log1p(-effect.parameters["frac"] * progress))


def _centred(values: FloatArray, weight: FloatArray) -> FloatArray:
    """Return values less their weighted mean, over their sd."""
    mean = float(weight @ values) / float(weight.sum())
    return np.asarray((values - mean) * np.sqrt(weight))
