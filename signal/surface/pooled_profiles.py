# SPDX-License-Identifier: MIT
"""Pool several profiles of one surface into one structure function."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import Profile
from jointbench.signal.surface.binned_spectrum import pooled_spectrum
from jointbench.signal.surface.structure_function import (
    StructureFunction,
    structure_function,
)

SAME_SPACING = 1e-6
"""Relative tolerance of equal spacings [-]."""
FEWEST_FOR_SCATTER = 8
"""Least profiles whose scatter checks the stated uncertainty [-]."""


def pool_profiles(profiles: Sequence[Profile]) -> StructureFunction:
    """Average the structure functions of independent profiles of one surface.

    Each profile is levelled separately. From eight profiles on, their scatter checks
    the stated uncertainty, as strips do on a map.

    Args:
        profiles: two or more, of one spacing; longer ones are cut to the shortest.

    Returns:
        The structure function of all pairs of points within profiles.

    Raises:
        UsageError: fewer than two profiles, or their spacings differ.
        SurfaceTooSmall: a profile has too few points.
    """
    if len(profiles) < 2:
        raise UsageError(f"{len(profiles)} profiles given, pooling takes two or more")
    spacing = profiles[0].spacing
    apart = [p.name for p in profiles if abs(p.spacing / spacing - 1) > SAME_SPACING]
    if apart:
        raise UsageError(
            f"profile {apart[0]!r} has another spacing than {profiles[0].name!r}; "
            "pool profiles of one instrument setting, or combine their fits"
        )
    points = min(p.heights.size for p in profiles)
    cut = [
        replace(p, heights=p.heights[:points], valid=p.valid[:points]) for p in profiles
    ]
    parts = _at_common_lags([structure_function(p) for p in cut])
    pairs = np.array([part.samplings[0].pairs for part in parts])
    values = np.array([part.value for part in parts])
    total = pairs.sum(axis=0)
    value = (values * pairs).sum(axis=0) / total
    fourths = np.array([part.kurtosis for part in parts]) * values**2
    safe = np.where(value > 0, value, 1.0)
    none = np.empty((0, value.size))
    return replace(
        parts[0],
        name=f"{len(profiles)} profiles",
        value=value,
        kurtosis=(fourths * pairs).sum(axis=0) / total / safe**2,
        samplings=(
            replace(
                parts[0].samplings[0],
                profiles=len(profiles),
                row_distance=np.inf,
                pairs=total,
                blocks=values if len(profiles) >= FEWEST_FOR_SCATTER else none,
            ),
        ),
        quantum=max(part.quantum for part in parts),
        provenance=(
            *parts[0].provenance,
            step("pool", profiles=", ".join(p.name for p in profiles), points=points),
        ),
        spectrum=pooled_spectrum([part.spectrum for part in parts]),
    )


def _at_common_lags(parts: list[StructureFunction]) -> list[StructureFunction]:
    """Keep the lags at which every profile has a pair."""
    common = parts[0].lag
    for part in parts[1:]:
        common = np.intersect1d(common, part.lag)
    if common.size == 0:
        raise UsageError("the profiles share no lag; they are too full of gaps")
    return [part.only(np.isin(part.lag, common)) for part in parts]
