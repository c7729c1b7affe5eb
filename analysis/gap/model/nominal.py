# SPDX-License-Identifier: MIT
"""Nominal parameters of a bench: model with priors, hit points, repeatability."""

from collections.abc import Mapping
from dataclasses import dataclass

from jointbench.analysis.gap.model.stated_scatter import (
    NOTHING_STATED,
    StatedScatter,
)
from jointbench.analysis.lumped.lumped_model import LumpedModel


@dataclass(frozen=True, slots=True)
class NominalParameters:
    """Prior knowledge of a bench.

    Attributes:
        model: bodies, links and channels with priors.
        points: body by hit point; any other point belongs to the body of the channel
            at that point, or to the body of that name.
        preload_reference: preload that the nominal values belong to [N]; None if all
            hits have the same preload.
        repeatability: relative to the peak response [-]; None to estimate it from
            repeats.
        scatter: expected scatter of the hits by direction, as stated.
    """

    model: LumpedModel
    points: Mapping[str, int]
    preload_reference: float | None = None
    repeatability: float | None = None
    scatter: StatedScatter = NOTHING_STATED
