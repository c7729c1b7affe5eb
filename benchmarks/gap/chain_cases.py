# SPDX-License-Identifier: MIT
"""Chains of a joint with one effect hidden at one link, for `chain_score`.

The joint is that of `contact_campaigns` (summits one by one, boundary elements), its
first assembly; two blocks are struck in every state with its stiffness, scaled into the
band of a hammer; effects of the structure are those of the simulated campaigns. The
contact law is that of the moments of the surface as measured, with their errors.
"""

from dataclasses import dataclass, replace

import numpy as np
from contact_campaigns import make_joint

from jointbench.analysis.gap.chain.chain_records import LinkTest, SurfaceReading
from jointbench.analysis.gap.chain.joint_over_preload import BoltedStates
from jointbench.analysis.gap.contact_bench.preload_law import PreloadLaw
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.two_body_model import two_body_model
from jointbench.simulators.campaigns.campaign_records import noisy
from jointbench.simulators.hidden.campaign_design import (
    NOMINAL_SIGMA,
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

    def log_stiffness(
        self, log_preload: np.ndarray, coordinates: np.ndarray
    ) -> np.ndarray:
        """Return ln k of the law plus the factor, shape (2, n)."""
        return self.law.log_stiffness(log_preload, coordinates) + self.log_factor


def make_case(seed: int, link: str, effect: str) -> ChainCase:
    """Return a chain with an effect hidden at a link, or with none."""
    joint = make_joint(seed, effect if link == "contact" else "")
    data = joint.data
    own = (data.rows.quantity == 0) & (data.states.assembly[data.rows.state] == 0)
    rows = data.rows.chosen(own & ~data.states.falling[data.rows.state])
    stiffness = np.exp(rows.value)
    scale = _MIDDLE / float(np.median(stiffness))
    log_p = data.nominal_log_preload[rows.state]
    facts = replace(
        data.facts,
        area=data.facts.area,
        modulus=data.facts.modulus * scale,
    )
    campaigns = _struck(seed, np.exp(log_p), stiffness * scale, link, effect)
    states = BoltedStates(
        f"chain-{seed}", facts, np.exp(log_p), np.zeros(log_p.size, dtype=np.int64)
    )
    law = ScaledLaw(joint.law, float(np.log(scale)))
    reading = SurfaceReading(law, LinkTest(0.0, 0, passed=True))
    return ChainCase(link, effect, reading, campaigns, states, scale)


def _struck(
    seed: int, preload: np.ndarray, stiffness: np.ndarray, link: str, effect: str
) -> tuple[Campaign, ...]:
    """Strike two blocks in every state of their joint."""
    design = draw_design(seed, grid="small", noise=0.05, hit_scatter=0.001)
    rng, first, found = np.random.default_rng([seed, 79]), design.conditions[0], []
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
    hidden = ()
    if link == "structure":
        drawn = draw_effect(
            effect, specimen_scales(design), np.random.default_rng([seed, 12])
        )
        hidden = (resize_effect(drawn, _SIZE),)
    force, response = noisy(design, *simulate_records(design, hidden))
    model = two_body_model(dict(design.nominal), dict(NOMINAL_SIGMA))
    campaigns = []
    for p in preload:
        own = np.array([c.preload == float(p) for c in found])
        kept = [c for c in found if c.preload == float(p)]
        campaigns.append(
            Campaign(
                f"chain-{seed}",
                SAMPLE_RATE,
                force[own],
                response[own],
                np.array([c.hit_dof for c in kept]),
                np.array([c.level for c in kept]),
                np.full(len(kept), float(p)),
                np.arange(len(kept), dtype=float),
                float(p),
                model,
            )
        )
    return tuple(campaigns)
