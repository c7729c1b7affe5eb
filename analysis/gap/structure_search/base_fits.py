# SPDX-License-Identifier: MIT
"""Fits of the base: in short windows from its nominal values, then to whole records."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL, Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_search.sought_frequencies import (
    from_other_frequencies,
)
from jointbench.analysis.gap.structure_search.structure_fits import (
    approached,
    chi2_per_dof,
    settled,
    with_errors_found,
)
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)


def base_in_windows(few: StructureBench) -> FloatArray:
    """Return the base fitted from its nominal values, coarse to fine, shape (n_base,).

    Args:
        few: one record of each condition.
    """
    x = np.zeros(few.base_sd.size)
    for window in STRUCTURE_SEARCH.base_windows:
        floor = max(STRUCTURE.coarse_floor, few.table_floor)
        few = few.at(x, (), few.landing, floor)
        problem = make_problem(few, ())
        x = minimise(problem, x, Resolution(window), iterations=8, exact_slopes=False).x
    return x


def base_in_whole_records(
    bench: StructureBench, few: StructureBench, start: FloatArray
) -> tuple[StructureBench, Fit]:
    """Fit the base to whole records: to all of them, unless it is far off.

    A base far off is fitted to one record of each condition, and its chi2 is that of
    all records.

    Args:
        bench: all records.
        few: one record of each condition.
        start: base coordinates as fitted in short windows, shape (n_base,).
    """
    few = replace(few, reach=bench.reach, floor=few.table_floor)
    few, fit = approached(few, start, ())
    few, fit = from_other_frequencies(few, fit) or (few, fit)
    chi2 = chi2_per_dof(few, fit)
    explains, x = chi2 < few.policy.floor_chi2, fit.x
    layout = with_errors_found(bench.layout, fit, explains=explains)
    # What one record of each condition takes is needed for all of them.
    del few, fit
    bench = replace(bench, layout=layout)
    if chi2 < STRUCTURE_SEARCH.explaining_chi2:
        return settled(bench, x, (), near=True)
    whole = bench.at(x, (), bench.landing, bench.table_floor)
    return whole, minimise(make_problem(whole, ()), x, FULL, iterations=0)
