# SPDX-License-Identifier: MIT
"""Frequencies that an uncertain table leaves open, of the structure with an effect.

Errors of a table belong to the free bodies. As coordinates they are frequencies of
closed modes, and a joint three times as soft closes the bodies to other modes: errors
in the modes of the nominal joint would couple these.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import split
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import cost_at
from jointbench.analysis.gap.structure_bench.structure_bench import (
    StructureBench,
    frames_of,
)
from jointbench.analysis.gap.structure_response.table_errors import tuned_again
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)

_WINDOW = Resolution(STRUCTURE_SEARCH.approach_windows[0])
"""In which a start with other modes is compared with what it was."""


def retuned(
    bench: StructureBench,
    x: FloatArray,
    candidates: Sequence[Candidate],
    *,
    every_pair: bool = False,
) -> tuple[StructureBench, FloatArray]:
    """Return the bench with the closed modes at a solution, and its coordinates there.

    The stiffness by which the modes were tuned goes over to the new ones, where it
    changes their frequencies.

    Args:
        bench: with the closed modes of another state.
        x: base coordinates, then those of the effects.
        candidates: effects.
        every_pair: see `tuned_again`; the coordinates are as many otherwise.
    """
    layout, count = bench.layout, bench.base_sd.size
    old = layout.tuned
    if old is None:
        return bench, x
    state = bench.state(x[:count], split(x, count, candidates))
    found = tuned_again(bench.campaign, state, old, every_pair=every_pair)
    if found is None:
        return bench, x
    new, tuning = found
    own = layout.tuned_at
    # Deviations of the base have scaled all of them, see `with_errors_found`.
    scale = np.median(layout.sd[own] / old.sd)
    moved = np.concatenate([x[: own.start], tuning, x[own.stop :]])
    layout = layout.tuned_in(new, scale * new.sd)
    return replace(bench, layout=layout, kept=frames_of(bench.kept)), moved


def retuned_as_near(
    bench: StructureBench, x: FloatArray, candidates: Sequence[Candidate]
) -> tuple[StructureBench, FloatArray]:
    """Return the bench with the closed modes at a fit, if it stays near the records.

    Couplings are those of the nearest modes, so that a structure far from that of the
    old ones may lose what it was fitted to: it keeps them, else.

    Args:
        bench: with the closed modes of another state.
        x: base coordinates, then those of the effects.
        candidates: effects.
    """
    own, moved = retuned(bench, x, candidates)
    if own is bench:
        return bench, x
    near = cost_here(bench, x, candidates)
    if cost_here(own, moved, candidates) > STRUCTURE_SEARCH.retuned_ratio * near:
        return bench, x
    return own, moved


def cost_here(
    bench: StructureBench, x: FloatArray, candidates: Sequence[Candidate]
) -> float:
    """Return the cost in the first window of the approach, expanded at x.

    Args:
        bench: its hits where they are known to have landed.
        x: base coordinates, then those of the effects.
        candidates: effects.
    """
    n = bench.base_sd.size
    terms = split(x, n, candidates)
    here = bench.at(x[:n], terms, bench.landing, bench.floor, _WINDOW.window)
    return cost_at(make_problem(here, candidates), x, _WINDOW)
