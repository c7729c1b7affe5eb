# SPDX-License-Identifier: MIT
"""A planned campaign on the two-body bench: points x levels x preloads, repeated.

Its session serves to find the effects that a model lacks; one or more may be hidden.
Every run is one hit, recorded with a pre-trigger.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from urllib.parse import urlencode

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.recordings import Channel, Quantity
from jointbench.simulators.campaigns.campaign_records import (
    SimulatedCampaign,
    quick_campaign,
)
from jointbench.simulators.hidden.campaign_design import GRIDS
from jointbench.simulators.hidden.campaign_sampling import SAMPLE_RATE
from jointbench.simulators.hidden.hidden_effects import HiddenEffect
from jointbench.simulators.hidden.hit_deviations import ScatterWays

_BETWEEN_RUNS = 20.0  # [s] from hit to hit of an operator


@dataclass(frozen=True, slots=True, eq=False)
class CampaignRun:
    """One hit of the campaign: a `Source` of one block, with its preload.

    Attributes:
        name: of the run.
        samples: force and the accelerations of base and top, shape (3, n).
        point: struck body, ``"1"`` the base or ``"2"`` the top.
        preload: on the joint [N].
        start_time: since the start of the campaign [s].
    """

    name: str
    samples: FloatArray
    point: str
    preload: float
    start_time: float

    @property
    def simulated(self) -> bool:
        """True: no hardware is used."""
        return True

    @property
    def sample_rate(self) -> float:
        """Samples per second and channel [Hz]."""
        return SAMPLE_RATE

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Hammer force, acceleration a0 of the base and a1 of the top."""
        responses = (
            Channel(name, Quantity.ACCELERATION, point, "+z", "m/s^2", 10.2e-3)
            for name, point in (("a0", "1"), ("a1", "2"))
        )
        force = Channel("force", Quantity.FORCE, self.point, "+z", "N", 2.25e-3)
        return (force, *responses)

    def blocks(self) -> Iterator[FloatArray]:
        """Yield the run in SI units, shape (3, n)."""
        yield self.samples


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignBench:
    """A planned campaign of `simulators.campaigns`.

    Attributes:
        seed: of specimen, nominal parameters, hits, noise and hidden effects.
        hide: names of hidden effects, joined by commas; empty for none.
        grid: of hits, one of `GRIDS`; ``"crossed"`` has every condition twice.
        noise: of each accelerometer, standard deviation [m/s^2].
        hit_scatter: relative standard deviation from hit to hit [-].
        size: of each hidden effect, as a share of its largest physical size [-].
        channel_scatter: sd of the gain of each channel in each hit [-].
        delay_scatter: sd of the delay of the force in each hit [us].
        scatter_tail: degrees of freedom of Student's t of these two; 0 for normal.
        scatter_memory: correlation of these two between successive hits [-].
        bad_hit: deviation of the gain of one hit, drawn among all [-].
    """

    seed: int = 1
    hide: str = ""
    grid: str = "crossed"
    noise: float = 0.05
    hit_scatter: float = 0.001
    size: float = 0.02
    channel_scatter: float = 0.0
    delay_scatter: float = 0.0
    scatter_tail: float = 0.0
    scatter_memory: float = 0.0
    bad_hit: float = 0.0

    def __post_init__(self) -> None:
        """Refuse values out of range, before anything is simulated."""
        if not (np.isfinite(self.noise) and self.noise > 0):
            raise UsageError(f"noise is {self.noise!r}, it must be finite and positive")
        if not 0 < self.size <= 1:
            raise UsageError(f"size is {self.size!r}; give a share above 0, up to 1")
        if not 0 <= self.hit_scatter <= 0.1:
            raise UsageError(
                f"hit_scatter is {self.hit_scatter!r}; give 0 to 0.1, a good operator "
                "has 0.001"
            )
        if self.seed < 0:
            raise UsageError(f"seed is {self.seed}; give 0 or more")
        if self.grid not in GRIDS:
            raise UsageError(
                f"unknown grid {self.grid!r}; there are {', '.join(GRIDS)}"
            )
        for effect in self.hidden:
            HiddenEffect(effect, {})
        _ = self.ways

    @property
    def name(self) -> str:
        """The URL of this campaign, with all non-default values."""
        changed = {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if field.name == "seed" or getattr(self, field.name) != field.default
        }
        return f"sim:two-body-campaign?{urlencode(changed)}"

    @property
    def simulated(self) -> bool:
        """True: no hardware is used."""
        return True

    @property
    def hidden(self) -> tuple[str, ...]:
        """Names of the hidden effects."""
        return tuple(word.strip() for word in self.hide.split(",") if word.strip())

    @property
    def ways(self) -> ScatterWays:
        """Scatter of the hits beyond strength and joint stiffness."""
        return ScatterWays(
            self.channel_scatter,
            1e-6 * self.delay_scatter,
            self.scatter_tail,
            self.scatter_memory,
            self.bad_hit,
        )

    def simulate(self) -> SimulatedCampaign:
        """Simulate the campaign: its records, nominal parameters and truth."""
        return quick_campaign(
            self.seed,
            effects=self.hidden,
            size=self.size,
            grid=self.grid,
            noise=self.noise,
            hit_scatter=self.hit_scatter,
            ways=self.ways,
        )


def campaign_runs(campaign: SimulatedCampaign) -> tuple[CampaignRun, ...]:
    """Return the hits of a campaign as a bench delivers them, in order."""
    pairs = zip(
        campaign.design.conditions, campaign.force, campaign.acceleration, strict=True
    )
    return tuple(
        CampaignRun(
            name=f"run-{condition.order + 1:02d}",
            samples=np.vstack((force, acceleration)),
            point=("1", "2")[condition.hit_dof],
            preload=condition.preload,
            start_time=_BETWEEN_RUNS * condition.order,
        )
        for condition, force, acceleration in pairs
    )
