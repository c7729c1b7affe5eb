# SPDX-License-Identifier: MIT
"""Approach to whole records on some of them, and how far it goes."""

from collections.abc import Sequence

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.structure_fits import in_full, in_windows


def approached(
    few: StructureBench, start: FloatArray, candidates: Sequence[Candidate]
) -> tuple[StructureBench, Fit]:
    """Fit some records window by window to whole ones.

    A fit that is far off goes to whole records at once.

    Args:
        few: records of the base or of effects.
        start: base coordinates, then those of the effects.
        candidates: effects.
    """
    few, fit = in_windows(few, start, candidates)
    rival = None if candidates else explaining_cost(few)
    return in_full(few, fit.x, candidates, rival=rival)


def explaining_cost(bench: StructureBench) -> float | None:
    """Return the cost per row that a base should reach; None for any.

    A base that lacks an effect creeps where its modal table is uncertain, far from
    explaining the hits, and the one beside the effect takes its place.

    Args:
        bench: its records.
    """
    if not bench.uncertain:
        return None
    return bench.policy.floor_chi2 / bench.coherence
