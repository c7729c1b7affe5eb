# SPDX-License-Identifier: MIT
"""Best possible detectability of a hidden effect, and its distinction from rivals.

By projection of numerically differenced responses of the simulators' plant. The
held-out records are all records, since every group is held out in turn.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.detectability.base_refit import (
    BaseFit,
    BaseView,
    base_view,
    project,
    refit_base,
)
from jointbench.simulators.detectability.rival_effects import rival_effects
from jointbench.simulators.detectability.rival_refit import (
    best_shape,
    refit_rival,
    sized_at_other_site,
)
from jointbench.simulators.detectability.settling_margin import settled_shares
from jointbench.simulators.hidden.campaign_design import CampaignDesign
from jointbench.simulators.hidden.campaign_response import sketch_responses
from jointbench.simulators.hidden.effect_draws import FAMILIES, Scales, specimen_scales
from jointbench.simulators.hidden.hidden_effects import HiddenEffect

_REFITTED = 4  # rivals, the most similar by the grid
_ALIKE = 0.7  # least correlation of a rival that is refitted


@dataclass(frozen=True, slots=True)
class Margin:
    """Best possible margin of one effect.

    Attributes:
        rho: norm of the weighted change that the base cannot follow, over the square
            root of the number of parameters [-]; below 1 it cannot be detected.
        correlation: of that change with the best rival's [-].
        rival: name and site of the best rival.
        margin: rho^2 (1 - correlation^2) [-].
    """

    rho: float
    correlation: float
    rival: str
    margin: float


@dataclass(frozen=True, slots=True, eq=False)
class Rival:
    """Small effects of one name and site, and their residuals after the base fit.

    Attributes:
        shapes: the effects.
        directions: residual of each after the base fit, (n_rows,) each.
        plane: orthonormal columns that span the directions.
    """

    shapes: tuple[HiddenEffect, ...]
    directions: tuple[FloatArray, ...]
    plane: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class MarginScale:
    """Everything about a design that margins need, computed once.

    Attributes:
        scales: of its specimen.
        view: its base for least squares.
        rivals: of any hidden effect, by name and site.
    """

    scales: Scales
    view: BaseView
    rivals: Mapping[str, Rival] = field(repr=False)


def margin_scale(
    design: CampaignDesign, *, samples: int | None = None, shared: bool = False
) -> MarginScale:
    """Prepare a design for `expected_margin`.

    Args:
        design: the campaign without effects.
        samples: of a record that count, from its start; None for all.
        shared: whether delay and low pass of all channels together are rivals as well,
            as for a hidden effect that acts on all channels.

    Returns:
        Base responses, weights, slopes and rivals.
    """
    view, scales = base_view(design, samples=samples), specimen_scales(design)
    families: dict[str, list[HiddenEffect]] = {}
    for rival in rival_effects(scales, shared=shared):
        families.setdefault(_site(rival), []).append(rival)
    rivals = {site: _rival(view, shapes) for site, shapes in families.items()}
    return MarginScale(scales, view, rivals)


def expected_margin(scale: MarginScale, effect: HiddenEffect) -> Margin:
    """Estimate the detectability of an effect, and its distinction from the best rival.

    Args:
        scale: the design, prepared.
        effect: the hidden effect, at its size.

    Returns:
        rho, the best rival and the margin. The rivals most similar by their grids, and
        the effect itself at its other site, are refitted with all their parameters and
        the base's; the correlation is that of the best fit.
    """
    responses = sketch_responses(scale.view.design, [effect])
    alone = refit_base(scale.view, responses)
    norm = max(float(np.sqrt(alone.cost)), 1e-300)
    alike = _correlations(scale, effect, alone.left)
    rival, remaining = max(alike, key=lambda site: alike[site]), norm
    for site, start in _starts(scale, effect, alone, alike):
        distance = refit_rival(scale.view, responses, alone, start)
        if distance < remaining:
            rival, remaining = site, distance
    found = _margin(effect, norm, rival, 1 - (remaining / norm) ** 2)
    return _over_scatter(scale, effect, found)


def first_order_margin(scale: MarginScale, effect: HiddenEffect) -> Margin:
    """Estimate the margin by the grid of small rivals alone, for a quick first size.

    Args:
        scale: the design, prepared.
        effect: the hidden effect, at its size.

    Returns:
        As `expected_margin`; a rival may mix all shapes of its grid, but no others.

    Source:
        Cook and Weisberg's added-variable projection, with the rival's plane instead of
        one regressor.
    """
    responses = sketch_responses(scale.view.design, [effect])
    alone = refit_base(scale.view, responses)
    alike = _correlations(scale, effect, alone.left)
    rival = max(alike, key=lambda site: alike[site])
    found = _margin(effect, float(np.sqrt(alone.cost)), rival, alike[rival] ** 2)
    return _over_scatter(scale, effect, found)


def _over_scatter(scale: MarginScale, effect: HiddenEffect, found: Margin) -> Margin:
    """Return a margin, reduced by the scatter of the joint if that is smaller."""
    settled = settled_shares(scale.view, effect)
    if settled is None:
        return found
    norm, alike, rival = settled
    own = _margin(effect, norm, rival, alike**2)
    return own if own.margin < found.margin else found


def _rival(view: BaseView, shapes: list[HiddenEffect]) -> Rival:
    changes = (sketch_responses(view.design, [s]) - view.responses for s in shapes)
    directions = tuple(project(view, change) for change in changes)
    plane = np.asarray(scipy.linalg.orth(np.stack(directions, axis=1), 1e-6))
    return Rival(tuple(shapes), directions, plane)


def _correlations(
    scale: MarginScale, effect: HiddenEffect, left: FloatArray
) -> dict[str, float]:
    """Return the correlation of the residual with the plane of each rival."""
    norm = max(float(np.linalg.norm(left)), 1e-300)
    return {
        site: min(float(np.linalg.norm(rival.plane.T @ left)) / norm, 1.0)
        for site, rival in scale.rivals.items()
        if not _same_thing(effect, site)
    }


def _starts(
    scale: MarginScale, effect: HiddenEffect, alone: BaseFit, alike: dict[str, float]
) -> list[tuple[str, HiddenEffect]]:
    """Return the start of each rival to refit."""
    starts: list[tuple[str, HiddenEffect]] = []
    for site in sorted(alike, key=lambda site: -alike[site]):
        if alike[site] < _ALIKE:
            break
        known = scale.rivals[site]
        best = best_shape(known.shapes, known.directions, alone.left)
        if best is not None and len(starts) < _REFITTED:
            starts.append((site, best[0]))
    other = sized_at_other_site(scale.view, effect, alone.left)
    return starts if other is None else [*starts, (_site(other), other)]


def _margin(effect: HiddenEffect, norm: float, rival: str, square: float) -> Margin:
    rho = norm / float(np.sqrt(max(FAMILIES[effect.name].free, 1)))
    return Margin(rho, float(np.sqrt(square)), rival, rho**2 * (1 - square))


def _site(effect: HiddenEffect) -> str:
    return f"{effect.name} {effect.site}"


def _same_thing(effect: HiddenEffect, site: str) -> bool:
    """Return whether a rival is the effect itself, perhaps under another name.

    A reversed sign is a gain of -2; a limit on all channels equals one on the clipping
    channel.
    """
    name = site.split()[0]
    return (
        site == _site(effect)
        or (effect.name == "polarity" and site == f"gain_error {effect.site}")
        or (effect.name == name == "saturation")
    )
