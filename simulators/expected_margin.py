# SPDX-License-Identifier: MIT
"""How well a hidden effect can be seen, and told from its rivals, at best.

Numerically differenced responses of the simulators' own plant, projected. The
held-out records are all records, since every group is held out in turn.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import scipy.linalg

from jointbench.acquisition.arrays import FloatArray
from jointbench.simulators.base_refit import (
    BaseView,
    base_view,
    project,
    refit_residual,
)
from jointbench.simulators.campaign_design import CampaignDesign
from jointbench.simulators.campaign_response import sketch_responses
from jointbench.simulators.effect_draws import FAMILIES, Scales, specimen_scales
from jointbench.simulators.hidden_effects import HiddenEffect
from jointbench.simulators.rival_effects import rival_effects


@dataclass(frozen=True, slots=True)
class Margin:
    """What an ideal analyst could make of one effect.

    Attributes:
        rho: norm of the weighted change that the base cannot follow, over the square
            root of the number of parameters [-]; below 1 nobody sees it.
        correlation: of that change with the best rival's [-].
        rival: name and site of the best rival.
        margin: rho^2 (1 - correlation^2) [-].
    """

    rho: float
    correlation: float
    rival: str
    margin: float


@dataclass(frozen=True, slots=True, eq=False)
class MarginScale:
    """Everything about a design that margins need, computed once.

    Attributes:
        scales: what its specimen does.
        view: its base as least squares sees it.
        rivals: orthonormal directions that the base cannot follow, by name and site
            of the rival, each (n_rows, n_directions).
    """

    scales: Scales
    view: BaseView
    rivals: Mapping[str, FloatArray] = field(repr=False)


def margin_scale(design: CampaignDesign) -> MarginScale:
    """Prepare a design for `expected_margin`.

    Args:
        design: the campaign without effects.

    Returns:
        Base responses, weights, slopes and rivals.
    """
    view, scales = base_view(design), specimen_scales(design)
    families: dict[str, list[FloatArray]] = {}
    for rival in rival_effects(scales):
        change = sketch_responses(design, [rival]) - view.responses
        families.setdefault(_site(rival), []).append(project(view, change))
    rivals = {
        site: np.asarray(scipy.linalg.orth(np.stack(directions, axis=1), 1e-6))
        for site, directions in families.items()
    }
    return MarginScale(scales, view, rivals)


def expected_margin(scale: MarginScale, effect: HiddenEffect) -> Margin:
    """Judge how visible an effect is, and how distinct from the best rival.

    Args:
        scale: the design, prepared.
        effect: the hidden effect, at its size.

    Returns:
        rho, the best rival and the margin; a rival may mix all shapes of its grid,
        so the margin errs on the low side.

    Source:
        Cook and Weisberg's added-variable projection, with the rival's plane in
        place of one regressor.
    """
    left = refit_residual(scale.view, sketch_responses(scale.view.design, [effect]))
    norm = float(np.linalg.norm(left))
    correlations = {
        site: float(np.linalg.norm(directions.T @ left)) / max(norm, 1e-300)
        for site, directions in scale.rivals.items()
        if site != _site(effect) and not _same_thing(effect, site)
    }
    rival = max(correlations, key=lambda site: correlations[site])
    correlation = min(correlations[rival], 1.0)
    rho = norm / float(np.sqrt(max(FAMILIES[effect.name].free, 1)))
    return Margin(rho, correlation, rival, rho**2 * (1 - correlation**2))


def _site(effect: HiddenEffect) -> str:
    return f"{effect.name} {effect.site}"


def _same_thing(effect: HiddenEffect, site: str) -> bool:
    """Say whether a rival is the effect itself: a turned sign is a gain of -2."""
    return effect.name == "polarity" and site == f"gain_error {effect.site}"
