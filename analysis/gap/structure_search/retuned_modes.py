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
from jointbench.analysis.gap.residuals.fit_records import split
from jointbench.analysis.gap.structure_bench.structure_bench import (
    StructureBench,
    frames_of,
)
from jointbench.analysis.gap.structure_response.table_errors import tuned_again


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
