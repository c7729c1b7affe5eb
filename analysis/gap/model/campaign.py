# SPDX-License-Identifier: MIT
"""A campaign: hits under known conditions, with the model that should explain them."""

from dataclasses import dataclass

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.gap.model.campaign_settings import CAMPAIGN
from jointbench.analysis.gap.model.stated_scatter import (
    NOTHING_STATED,
    StatedScatter,
)
from jointbench.analysis.lumped.lumped_model import LumpedModel

TAIL = CAMPAIGN.tail_samples


@dataclass(frozen=True, slots=True, eq=False)
class Campaign:
    """Hits under known conditions, and the model that should explain them.

    Attributes:
        name: of the campaign, chosen by the user.
        sample_rate: [Hz].
        force: hammer force [N], shape (n_records, n_samples).
        response: shape (n_records, n_channels, n_samples), in the model's output.
        hit: index of the body that was hit, shape (n_records,).
        level: nominal peak force [N], shape (n_records,).
        preload: [N], shape (n_records,).
        order: rank in time, shape (n_records,).
        preload_reference: preload that the nominal parameters belong to [N].
        model: bodies, links and their priors.
        lead: first samples without weight: the bench was not at rest before them.
        continuous: True where the excitation never ends (a shaker), so that no
            hit can be cut out of it and no level spans the campaign.
        repeatability: relative, as stated [-]; None to estimate it from repeats.
        scatter: expected scatter of the hits, as stated.
    """

    name: str
    sample_rate: float
    force: FloatArray
    response: FloatArray
    hit: IntArray
    level: FloatArray
    preload: FloatArray
    order: FloatArray
    preload_reference: float
    model: LumpedModel
    lead: int = 0
    continuous: bool = False
    repeatability: float | None = None
    scatter: StatedScatter = NOTHING_STATED

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "force", "response", "hit", "level", "preload", "order")
