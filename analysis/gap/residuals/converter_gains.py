# SPDX-License-Identifier: MIT
"""Gains of single hits ahead of a converter that clips.

Scatter of the gains moves samples across the limit of a clipped channel, which no slope
shows: at 3 % samples near the limit are wrong by hundreds of times the noise. The
samples below the limit determine the gain of each hit far better than that, so the
model is expanded about it: the channel is multiplied by its gain before it is clipped,
and the gain enters the residual by the slope, as scatter does elsewhere.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.lumped_residual import SomeBench
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.residuals.scatter_record import (
    CHANNEL_GAIN,
    FORCE_GAIN,
    HitScatter,
)


def clips(bench: SomeBench, terms: Sequence[Term]) -> bool:
    """Return whether one of the terms clips channels of single hits."""
    converters = any(a.entry.effect.family == "converter" for a in bench.actions(terms))
    return converters and not bench.campaign.continuous


def gains_of(
    bench: SomeBench, terms: Sequence[Term], scatter: HitScatter
) -> FloatArray:
    """Return the gain of each channel in each hit, shape (n_records, n_channels).

    A harder hit is a gain of all channels if nothing else is nonlinear.
    """
    columns = gain_columns(scatter)
    found = -scatter.values[:, list(columns)]
    if not any(a.entry.law is not None for a in bench.actions(terms)):
        (force,) = (d.columns[0] for d in scatter.directions if d.name == FORCE_GAIN)
        found = found - scatter.values[:, force, None]
    reach = RESIDUALS.gain_reach
    return np.asarray(1.0 + np.clip(found, -reach, reach))


def gain_columns(scatter: HitScatter) -> tuple[int, ...]:
    """Return the columns of the gains of channels."""
    (columns,) = (d.columns for d in scatter.directions if d.name == CHANNEL_GAIN)
    return columns
