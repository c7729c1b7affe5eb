# SPDX-License-Identifier: MIT
"""All profiles of a surface as one, and how the single ones scatter about it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.signal.surface.pooled_profiles import pool_profiles
from jointbench.signal.surface.quantisation_step import height_step
from jointbench.signal.surface.structure_function import (
    StructureFunction,
)
from jointbench.station.pipeline.surface_options import Beside


def pooled_structure(
    given: Sequence[Surface], flat: Sequence[Surface]
) -> StructureFunction:
    """Return the structure function of all profiles as one.

    Args:
        given: profiles as they were read.
        flat: the same, treated.

    Raises:
        UsageError: fewer than two profiles, or their spacings differ.
    """
    found = pool_profiles([one for one in flat if isinstance(one, Profile)])
    steps = [height_step(one.heights[one.valid]) for one in given]
    return replace(found, quantum=max(steps))


def pooled_beside(
    estimate: StructureFunction, dimensions: Sequence[float | None]
) -> Beside:
    """Describe the scatter of D and S over the single profiles.

    Args:
        estimate: of all profiles.
        dimensions: D of each profile, None where it has none [-].
    """
    known = [one for one in dimensions if one is not None]
    spread = float(np.std(known, ddof=1)) if len(known) > 1 else None
    line = (
        f"{len(known)} of {len(dimensions)} profiles have a D of their own"
        f"{'' if spread is None else f', which scatters by {spread:.2g}'}"
    )
    strips = estimate.samplings[0].blocks
    error = None
    if len(strips):
        error = (np.std(strips, axis=0, ddof=1) / np.sqrt(len(strips))).tolist()
    keys = {
        "dimension_scatter": spread,
        "lag_m": estimate.lag.tolist(),
        "value_m2": estimate.value.tolist(),
        "value_sd_m2": error,
    }
    return Beside((line,), tuple(keys.items()))
