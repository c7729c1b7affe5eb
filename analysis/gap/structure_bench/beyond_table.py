# SPDX-License-Identifier: MIT
"""What no error of an uncertain modal table explains.

Whatever the table, a linear structure answers all hits of a point with the same modes.
With residues that may have any error, a residual keeps what differs between such hits
and what is no sum of modes: a law that bends with amplitude, for one.
"""

from collections import defaultdict

import numpy as np

from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_bench.table_whitening import free_whitening
from jointbench.analysis.gap.structure_response.modal_table_settings import MODAL_TABLE
from jointbench.analysis.gap.structure_response.residue_errors import (
    separable,
    typical_peaks,
)


def beyond_table(bench: StructureBench, fit: Fit) -> tuple[str, float]:
    """Return what no error of the table explains, at the level where it is most.

    Channels whose noise is above the floor of exact tables are not counted.

    Args:
        bench: with an uncertain table, on which the fit was found.
        fit: to whole records.

    Returns:
        The level in words, and there chi2 over its degrees of freedom, with that
        floor; 0 where all noise is above it.
    """
    hits = bench.campaign.hits
    if bench.errors is None or bench.directions is None:
        raise ValueError("errors of the table are not known yet")
    peak = typical_peaks(bench.campaign, np.abs(hits.response).max(axis=2))
    floor = MODAL_TABLE.table_floor * peak
    sigma = separable(bench.campaign, np.hypot(hits.noise, floor))
    off = bench.off(bench.response(fit.base, fit.terms, None))
    squares = np.empty(sigma.shape)
    for own in hits.of_points:
        scaled = bench.directions[own] / sigma[own, None, :, None]
        unit = bench.errors.rows(own) / sigma[own].mean(axis=1)[:, None, None]
        rows = off[own, None] / sigma[own, None, :, None]
        free_whitening(scaled, unit).whiten(rows)
        squares[own] = np.mean(rows[:, 0] ** 2, axis=2)
    loud = hits.noise < floor
    by_level: dict[str, list[float]] = defaultdict(list)
    for record, label in enumerate(bench.blocks.labels):
        by_level[label["level"]] += list(squares[record, loud[record]])
    found = {word: float(np.mean(each)) for word, each in by_level.items() if each}
    return max(found.items(), key=lambda one: one[1], default=("", 0.0))
