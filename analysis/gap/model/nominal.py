# SPDX-License-Identifier: MIT
"""The sheet of a bench: model with priors, hit points, what repeats are worth."""

from collections.abc import Mapping
from dataclasses import dataclass

from jointbench.analysis.lumped.lumped_model import LumpedModel


@dataclass(frozen=True, slots=True)
class NominalParameters:
    """What is known of a bench before anything is measured.

    Attributes:
        model: bodies, links and channels with priors.
        points: body by hit point; a point that is not there belongs to the body whose
            channel sits at it, or that bears its name.
        preload_reference: preload the nominal values belong to [N]; None where all
            hits have one and the same.
        repeatability: relative to the peak response [-]; None to take it from repeats.
    """

    model: LumpedModel
    points: Mapping[str, int]
    preload_reference: float | None = None
    repeatability: float | None = None
