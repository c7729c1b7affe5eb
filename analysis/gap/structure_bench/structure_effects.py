# SPDX-License-Identifier: MIT
"""An effect with its physics on bolted bodies, its candidates and its states."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.model.effect import Candidate, Effect, Site, Term
from jointbench.analysis.gap.model.effect_parameter import Parameter
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE

Change = Callable[[JointState, HitCampaign, Site, FloatArray], JointState]
"""Adds an effect at a site with its values [SI] to a state."""
Sites = Callable[[HitCampaign], tuple[Site, ...]]


@dataclass(frozen=True, slots=True)
class StructureEffect:
    """An effect with its physics on bolted bodies.

    Attributes:
        effect: name, parameters and rivals.
        sites: where it can act on a structure.
        change: adds it to a state of the model.
        nonlinear: True if it is integrated in time.
        always: True if fits start from it whatever the directed tests find: effects of
            a body or a joint, which a base at its bounds follows, have few sites.
        aimed: True if it moves the mark of a point: fits also start at the mean place
            where the hits of the point landed.
        alone: True if it changes the modes, so that no other effect is fitted beside
            it.
        by_torque: True if it acts differently at each torque of the bolts.
        yielding: True if it distributes what the joint yields along its bolts: where
            the model holds them rigid, it is fitted beside their compliance alone.
        tolerance: size of its first coordinate within which a sensor is as sensors
            are, so that the effect is not named where the modal table is uncertain.
    """

    effect: Effect
    sites: Sites
    change: Change
    nonlinear: bool = False
    always: bool = False
    aimed: bool = False
    alone: bool = False
    by_torque: bool = False
    yielding: bool = False
    tolerance: float = 0.0


def far_starts(first: float, last: float) -> tuple[float, ...]:
    """Return starts of a strong effect, each larger than the one before by a factor.

    From a stiff spring or a soft joint of less than two thirds or more than twice its
    value, fits in the first milliseconds ended at a weak one.

    Args:
        first: smallest start.
        last: no start is larger.
    """
    ratio = STRUCTURE.far_ratio
    count = 1 + int(np.log(last / first) / np.log(ratio))
    return tuple(first * ratio**k for k in range(count))


def one_parameter(
    name: str,
    family: str,
    parameter: Parameter,
    source: str,
    sites: Sites,
    change: Change,
    *,
    always: bool = False,
    by_torque: bool = False,
) -> StructureEffect:
    """Return a linear effect of one parameter.

    Args:
        name: of the effect.
        family: of effects that hits confuse.
        parameter: its only one.
        source: of its physics.
        sites: where it can act.
        change: adds it to a state.
        always: True if fits start from it whatever the directed tests find.
        by_torque: True if it acts differently at each torque of the bolts.
    """
    effect = Effect(name, family, (parameter,), source)
    return StructureEffect(effect, sites, change, always=always, by_torque=by_torque)


def structure_candidates(
    entries: Sequence[StructureEffect], campaign: HitCampaign
) -> tuple[Candidate, ...]:
    """Return every effect of a catalogue at each of its sites."""
    return tuple(
        Candidate(entry.effect, site)
        for entry in entries
        for site in entry.sites(campaign)
    )


def structure_state(
    entries: Sequence[StructureEffect],
    campaign: HitCampaign,
    bare: JointState,
    terms: Sequence[Term],
    values: Sequence[FloatArray],
) -> JointState:
    """Return a state with effects added.

    Args:
        entries: the catalogue.
        campaign: model and nominal.
        bare: state without effects.
        terms: effects.
        values: of their parameters [SI].
    """
    known = {entry.effect.name: entry.change for entry in entries}
    state = bare
    for term, value in zip(terms, values, strict=True):
        change = known[term.candidate.effect.name]
        state = change(state, campaign, term.candidate.site, value)
    return state


def without_effects(
    entries: Sequence[StructureEffect], names: frozenset[str]
) -> tuple[StructureEffect, ...]:
    """Return a catalogue without some effects.

    Raises:
        UsageError: no entry has one of the names.
    """
    known = {entry.effect.name for entry in entries}
    for name in sorted(names - known):
        raise UsageError(
            f"there is no effect {name!r} on structures; known are "
            f"{', '.join(sorted(known))}"
        )
    return tuple(entry for entry in entries if entry.effect.name not in names)
