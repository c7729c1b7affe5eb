# SPDX-License-Identifier: MIT
"""Make campaigns with a nonlinear law at each of two joints.

The specimen is that of the two-body campaigns, with its foot a joint as well: ground,
foot, base, joint, top. The simulators' Runge-Kutta stepper makes the records; it shares
nothing with the integration of the engine.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.two_body_model import two_body_model
from jointbench.simulators.hidden.campaign_design import (
    NOMINAL_SIGMA,
    CampaignCondition,
    CampaignDesign,
    draw_design,
)
from jointbench.simulators.hidden.campaign_response import CONVERTER
from jointbench.simulators.hidden.campaign_sampling import FORCE_NOISE, SAMPLE_RATE
from jointbench.simulators.hidden.effect_draws import (
    Scales,
    draw_effect,
    resize_effect,
    specimen_scales,
)
from jointbench.simulators.hidden.hidden_effects import HiddenEffect, change_plant
from jointbench.simulators.measuring.converter import decimate
from jointbench.simulators.measuring.hammer import pulse_force
from jointbench.simulators.mechanics.plant import GROUND, Plant, plant_modes, two_bodies
from jointbench.simulators.mechanics.plant_integration import step_plant

LAWS = (
    *("cubic_stiffness", "quadratic_stiffness", "gap", "jenkins", "iwan"),
    *("bouc_wen", "coulomb", "quadratic_damping"),
)
SAMPLES = 768
SIZES = (0.1, 1.0)
"""Share of the largest physical size of an effect, log-uniform."""
LEAST_RHO = 30.0
"""Projected signal-to-noise ratio of each effect beside the other."""
NOISE = (0.02, 0.2)
"""Of the accelerations [m/s^2], log-uniform."""
_SLOPE = 1e-3
_DRAWS = 8


@dataclass(frozen=True, slots=True, eq=False)
class TwoJoints:
    """A campaign with a law at each joint, and its truth.

    Attributes:
        campaign: as the engine reads it.
        effects: at the foot and at the joint.
        rho: projected signal-to-noise ratio of each.
    """

    campaign: Campaign
    effects: tuple[HiddenEffect, HiddenEffect]
    rho: tuple[float, float]

    @property
    def truth(self) -> list[str]:
        """Labels to find."""
        foot, joint = self.effects
        return [f"{foot.name}@link:foot", f"{joint.name}@link:joint"]


def plant_of(
    physical: dict[str, float],
    effects: Sequence[HiddenEffect | None],
    condition: CampaignCondition,
) -> Plant:
    """Return the specimen with an effect at the foot and one at the joint.

    The simulators put every law at the joint; that of the foot is moved, with the
    stiffness that its sliders take from their link.
    """
    plant = two_bodies(**physical)
    foot, joint = effects
    changed = plant if joint is None else change_plant(plant, joint, condition)
    if foot is None:
        return changed
    other = change_plant(plant, foot, condition)
    taken = plant.links[1].stiffness - other.links[1].stiffness
    own = changed.links[0]
    links = (replace(own, stiffness=own.stiffness - taken), *changed.links[1:])
    law = replace(other.laws[-1], first=GROUND, second=0)
    return replace(changed, links=links, laws=(*changed.laws, law))


def records_of(
    design: CampaignDesign,
    physical: dict[str, float],
    effects: Sequence[HiddenEffect | None],
    *,
    fast: bool = False,
) -> tuple[FloatArray, FloatArray]:
    """Return forces (n_records, n) and accelerations (n_records, 2, n), noise-free.

    Args:
        design: specimen and hits.
        physical: true values of the specimen.
        effects: at the foot and at the joint.
        fast: four steps a sample without a filter, to measure sizes.
    """
    every = 4 if fast else CONVERTER.oversampling
    beyond = 0 if fast else CONVERTER.half_length // every + 1
    rate = SAMPLE_RATE * every
    time = np.arange(2 * (SAMPLES + beyond) * every + 1, dtype=float) / (2 * rate)
    forces, responses = [], []
    for condition in design.conditions:
        force = pulse_force([condition.pulse], time)
        acceleration, _ = step_plant(
            plant_of(physical, effects, condition),
            force,
            body=condition.hit_dof,
            time_step=1 / rate,
        )
        both = np.vstack((force[:-1:2], acceleration))
        seen = both[:, ::every] if fast else next(iter(decimate([both], CONVERTER)))
        forces.append(seen[0, :SAMPLES])
        responses.append(seen[1:, :SAMPLES])
    return np.stack(forces), np.stack(responses)


def scales_of(design: CampaignDesign) -> tuple[Scales, Scales]:
    """Return the response of the foot and of the joint of a design."""
    joint = specimen_scales(design)
    _, acceleration = records_of(design, dict(design.physical), (None, None), fast=True)
    speed = np.cumsum(acceleration[:, 0], axis=-1) / SAMPLE_RATE
    travel = np.cumsum(speed, axis=-1) / SAMPLE_RATE
    early = slice(0, 128 + 256)
    foot = replace(
        joint,
        elongation=float(np.abs(travel[:, early]).max()),
        rate=float(np.abs(speed[:, early]).max()),
        kj=design.physical["k0"],
        cj=design.physical["c0"],
        frequency=tuple(
            plant_modes(two_bodies(**design.physical)).natural_frequency[:2]
        ),
    )
    return foot, joint


def rhos(
    design: CampaignDesign, effects: tuple[HiddenEffect, HiddenEffect]
) -> tuple[float, float]:
    """Return how far each effect stands out beside the other, the base projected out.

    Of each effect the change of the records is taken, in units of their noise, and what
    six slopes of the base can imitate is removed by least squares.
    """
    physical = dict(design.physical)

    def seen(values: dict[str, float], *hidden: HiddenEffect | None) -> FloatArray:
        rows = records_of(design, values, hidden, fast=True)[1]
        return np.asarray(rows.ravel() / design.noise)

    both = seen(physical, *effects)
    slopes = [
        (seen(physical | {key: value * (1 + _SLOPE)}, *effects) - both) / _SLOPE
        for key, value in physical.items()
    ]
    basis, _ = np.linalg.qr(np.array(slopes).T)
    found = []
    for k in (0, 1):
        kept = [None if i == k else effect for i, effect in enumerate(effects)]
        change = both - seen(physical, *kept)
        found.append(float(np.linalg.norm(change - basis @ (basis.T @ change))))
    return found[0], found[1]


def make_two_joints(seed: int) -> TwoJoints:
    """Draw a campaign: two laws, each well above the noise beside the other."""
    rng = np.random.default_rng([seed, 17])
    noise = float(np.exp(rng.uniform(*np.log(NOISE))))
    design = draw_design(seed, grid="small", noise=noise)
    names = rng.choice(LAWS, size=2)
    scales = scales_of(design)
    for draw in range(_DRAWS):
        share = np.exp(rng.uniform(np.log(SIZES[0]), np.log(SIZES[1]), 2))
        share = np.minimum(1.0, share * 1.5**draw)
        foot, joint = (
            resize_effect(draw_effect(str(name), scale, rng), float(s))
            for name, scale, s in zip(names, scales, share, strict=True)
        )
        rho = rhos(design, (foot, joint))
        if min(rho) > LEAST_RHO:
            break
    campaign = _campaign(
        design, records_of(design, dict(design.physical), (foot, joint))
    )
    return TwoJoints(campaign, (foot, joint), rho)


def _campaign(
    design: CampaignDesign, records: tuple[FloatArray, FloatArray]
) -> Campaign:
    """Return a campaign with the noise of its sensors, on a model with two joints."""
    rng = np.random.default_rng([design.seed, 13])
    force, acceleration = (x.copy() for x in records)
    force += FORCE_NOISE * design.noise * rng.standard_normal(force.shape)
    acceleration += design.noise * rng.standard_normal(acceleration.shape)
    model = two_body_model(design.nominal, NOMINAL_SIGMA)
    foot, joint = model.links
    links = (replace(foot, name="foot", joint=True), joint)
    rows = design.conditions
    return Campaign(
        name=f"two joints {design.seed}",
        sample_rate=SAMPLE_RATE,
        force=force,
        response=acceleration,
        hit=np.array([c.hit_dof for c in rows]),
        level=np.array([c.level for c in rows]),
        preload=np.array([c.preload for c in rows]),
        order=np.array([float(c.order) for c in rows]),
        preload_reference=design.preload_reference,
        model=replace(model, links=links),
    )
