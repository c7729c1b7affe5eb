# SPDX-License-Identifier: MIT
"""Two blocks on a bolted joint whose stiffness is that of its own surfaces."""

from dataclasses import dataclass
from urllib.parse import urlencode

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.campaigns.joint_campaign import (
    JointCampaign,
    joint_campaign,
)
from jointbench.simulators.hidden.effect_draws import (
    draw_effect,
    resize_effect,
    specimen_scales,
)
from jointbench.simulators.hidden.hidden_effects import HiddenEffect


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltedBlocks:
    """Hits at six torques on a joint of ground, wavy surfaces.

    Attributes:
        seed: of surfaces, bodies and hits.
        hide: names of effects hidden in the structure, joined by commas.
        size: of each of them, as a share of its largest physical size [-].
    """

    seed: int = 1
    hide: str = ""
    size: float = 0.1

    def __post_init__(self) -> None:
        """Refuse values out of range, before anything is simulated."""
        if self.seed < 0:
            raise UsageError(f"seed is {self.seed}; give 0 or more")
        if not 0 < self.size <= 1:
            raise UsageError(f"size is {self.size!r}; give a share above 0, up to 1")
        for name in self._hidden:
            HiddenEffect(name, {})

    @property
    def name(self) -> str:
        """The URL of this bench."""
        hidden = {"hide": self.hide, "size": self.size} if self.hide else {}
        return f"sim:bolted-blocks?{urlencode({'seed': self.seed} | hidden)}"

    @property
    def simulated(self) -> bool:
        """True: no hardware is used."""
        return True

    @property
    def _hidden(self) -> tuple[str, ...]:
        return tuple(word.strip() for word in self.hide.split(",") if word.strip())

    def simulate(self) -> JointCampaign:
        """Simulate surfaces, joint and hits."""
        plain = joint_campaign(self.seed)
        if not self._hidden:
            return plain
        scales = specimen_scales(plain.campaign.design)
        rng = np.random.default_rng([self.seed, 12])
        effects = tuple(
            resize_effect(draw_effect(name, scales, rng), self.size)
            for name in self._hidden
        )
        return joint_campaign(self.seed, effects=effects)
