# SPDX-License-Identifier: MIT
"""Chains of a joint with one effect hidden at one link, for `chain_score`.

The joint is that of `contact_campaigns` (summits one by one, boundary elements), its
first assembly; two blocks are struck in every state with its stiffness, scaled into the
band of a hammer; effects of the structure are those of the simulated campaigns. The
contact law is that of the moments of the surface as measured, with their errors; an
instrument with a coarse cut-off (`scale_cut`) is the effect of the surface.
"""

from dataclasses import dataclass, replace

import numpy as np
from contact_campaigns import JointCampaign, make_joint
from contact_score import margins as contact_margins

from jointbench.analysis.gap.chain.chain_records import LinkTest, SurfaceReading
from jointbench.analysis.gap.chain.chain_settings import CHAIN
from jointbench.analysis.gap.chain.joint_over_preload import BoltedStates
from jointbench.analysis.gap.contact_bench.joint_states import JointData, JointRows
from jointbench.analysis.gap.contact_bench.preload_law import PreloadLaw
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.two_body_model import two_body_model
from jointbench.simulators.campaigns.campaign_records import noisy
from jointbench.simulators.detectability.expected_margin import (
    expected_margin,
    margin_scale,
)
from jointbench.simulators.hidden.campaign_design import (
    NOMINAL_SIGMA,
    CampaignCondition,
    CampaignDesign,
    draw_design,
    pulse_of,
)
from jointbench.simulators.hidden.campaign_response import simulate_records
from jointbench.simulators.hidden.campaign_sampling import SAMPLE_RATE
from jointbench.simulators.hidden.effect_draws import (
    draw_effect,
    resize_effect,
    specimen_scales,
)
from jointbench.simulators.hidden.hidden_effects import HiddenEffect

CONTACT = ("series_compliance", "contact_patch", "law_exponent", "film", "waviness")
LUMPED = ("cubic_stiffness", "added_mass", "delay", "jenkins", "gain_error")
_HITS = ((1, 30.0), (1, 200.0), (1, 1000.0), (1, 200.0), (0, 200.0), (0, 1000.0))
_MIDDLE = 5e7
"""Stiffness that the middle state has in the hits [N/m]."""
_SIZE = 0.3


@dataclass(frozen=True, eq=False)
class ChainCase:
    """One chain.

    Attributes:
        link: that hides the effect, or empty.
        effect: its name, or empty.
        surface: law and test of the surfaces.
        campaigns: the hits of each state.
        states: of the joint.
        scale: stiffness of the hits over that of the joint [-].
    """

    link: str
    effect: str
    surface: SurfaceReading
    campaigns: tuple[Campaign, ...]
    states: BoltedStates
    scale: float


@dataclass(frozen=True)
class ScaledLaw:
    """A law whose stiffness is multiplied by a factor, as that of the hits is."""

    law: PreloadLaw
    log_factor: float

    @property
    def name(self) -> str:
        """Of the law."""
        return self.law.name

    @property
    def parameters(self) -> tuple:
        """Of the law."""
        return self.law.parameters

    @property
    def factor_sd(self) -> float:
        """Of the law [-]."""
        return self.law.factor_sd

    @property
    def roughness_alone(self) -> float | None:
        """Of the law [m]."""
        return self.law.roughness_alone

    def log_stiffness(
        self, log_preload: np.ndarray, coordinates: np.ndarray
    ) -> np.ndarray:
        """Return ln k of the law plus the factor, shape (2, n)."""
        return self.law.log_stiffness(log_preload, coordinates) + self.log_factor


@dataclass(frozen=True, eq=False)
class ScaledJoint:
    """A joint in the band of a structure.

    Attributes:
        states: of the joint.
        stiffness: normal, in each state [N/m], shape (n_states,).
        surface: law and test of the surfaces.
        scale: stiffness over that of the joint as drawn [-].
    """

    states: BoltedStates
    stiffness: np.ndarray
    surface: SurfaceReading
    scale: float


def scaled_joint(
    seed: int, effect: str, middle: float, most: int | None = None
) -> ScaledJoint:
    """Return a joint with an effect of the contact, or with none.

    Args:
        seed: of the joint.
        effect: its name, or empty.
        middle: stiffness of the middle state [N/m].
        most: states that are kept, evenly over the torques; None for all.
    """
    joint = make_joint(seed, effect)
    rows = _evenly(_rows(joint.assembled), most)
    stiffness = np.exp(rows.value)
    scale = middle / float(np.median(stiffness))
    facts = replace(joint.data.facts, modulus=joint.data.facts.modulus * scale)
    preload = np.exp(joint.data.nominal_log_preload[rows.state])
    states = BoltedStates(
        f"chain-{seed}", facts, preload, np.zeros(preload.size, dtype=np.int64)
    )
    law = ScaledLaw(joint.law, float(np.log(scale)))
    reading = SurfaceReading(law, LinkTest(0.0, 0, passed=True))
    return ScaledJoint(states, stiffness * scale, reading, scale)


def make_case(seed: int, link: str, effect: str) -> ChainCase:
    """Return a chain with an effect hidden at a link, or with none."""
    joint = scaled_joint(seed, "" if link == "structure" else effect, _MIDDLE)
    preload = joint.states.preload
    design, hidden = _struck(seed, preload, joint.stiffness, link, effect)
    campaigns = _measured(seed, design, hidden)
    return ChainCase(link, effect, joint.surface, campaigns, joint.states, joint.scale)


def expected(seed: int, link: str, effect: str, most: int | None = None) -> float:
    """Return the expected margin of a hidden effect at its own link [-].

    At the contact over the stiffness in each state, known to the least sd of a reading;
    at the structure over the hits of one state, the joint free.
    """
    if link != "structure":
        return contact_margins(as_read(make_joint(seed, effect), most))[0]
    joint = scaled_joint(seed, "", _MIDDLE)
    preload = joint.states.preload
    design, hidden = _struck(seed, preload, joint.stiffness, link, effect)
    first = tuple(c for c in design.conditions if c.preload == float(preload[0]))
    one = replace(design, conditions=first)
    return expected_margin(margin_scale(one), hidden[0]).margin


def _rows(data: JointData) -> JointRows:
    """Return the normal stiffness of the rising states of the first assembly."""
    own = (data.rows.quantity == 0) & (data.states.assembly[data.rows.state] == 0)
    return data.rows.chosen(own & ~data.states.falling[data.rows.state])


def _evenly(rows: JointRows, most: int | None) -> JointRows:
    """Return so many states at most, evenly over the torques."""
    count = rows.value.size
    kept = np.unique(np.linspace(0, count - 1, min(most or count, count)).round())
    return rows.chosen(np.isin(np.arange(count), kept))


def as_read(joint: JointCampaign, most: int | None = None) -> JointCampaign:
    """Return a joint with the values that a chain reads, without scatter and noise."""
    rows = _evenly(_rows(joint.clean), most)
    known = replace(rows, covariance=CHAIN.reading_sd**2 * np.eye(rows.value.size))
    return replace(joint, clean=replace(joint.clean, rows=known))


def _struck(
    seed: int, preload: np.ndarray, stiffness: np.ndarray, link: str, effect: str
) -> tuple[CampaignDesign, tuple[HiddenEffect, ...]]:
    """Plan hits on two blocks in every state of their joint, and draw the effect."""
    design = draw_design(seed, grid="small", noise=0.05, hit_scatter=0.001)
    rng, first = np.random.default_rng([seed, 79]), design.conditions[0]
    found: list[CampaignCondition] = []
    for p, k in zip(preload, stiffness, strict=True):
        for body, level in _HITS:
            found.append(
                replace(
                    first,
                    level=level,
                    hit_dof=body,
                    preload=float(p),
                    # No law of the preload of its own here: the joint has it.
                    preload_ratio=1.0,
                    order=len(found),
                    progress=0.0,
                    pulse=pulse_of(level, rng),
                    force_factor=1 + 0.001 * float(rng.standard_normal()),
                    joint_factor=float(k / design.physical["kj"])
                    * (1 + 0.001 * float(rng.standard_normal())),
                )
            )
    design = replace(design, conditions=tuple(found))
    if link != "structure":
        return design, ()
    rng = np.random.default_rng([seed, 12])
    drawn = draw_effect(effect, specimen_scales(design), rng)
    return design, (resize_effect(drawn, _SIZE),)


def _measured(
    seed: int, design: CampaignDesign, hidden: tuple[HiddenEffect, ...]
) -> tuple[Campaign, ...]:
    """Strike; return the hits of each state."""
    force, response = noisy(design, *simulate_records(design, hidden))
    model = two_body_model(dict(design.nominal), dict(NOMINAL_SIGMA))
    campaigns = []
    for p in dict.fromkeys(c.preload for c in design.conditions):
        own = np.array([c.preload == p for c in design.conditions])
        kept = [c for c in design.conditions if c.preload == p]
        campaigns.append(
            Campaign(
                f"chain-{seed}",
                SAMPLE_RATE,
                force[own],
                response[own],
                np.array([c.hit_dof for c in kept]),
                np.array([c.level for c in kept]),
                np.full(len(kept), p),
                np.arange(len(kept), dtype=float),
                p,
                model,
            )
        )
    return tuple(campaigns)
