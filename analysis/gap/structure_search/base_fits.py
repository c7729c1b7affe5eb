# SPDX-License-Identifier: MIT
"""Fits of the base: in short windows from its nominal values, then to whole records."""

from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL, Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit, without_late_slopes
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.base_layout import BaseLayout
from jointbench.analysis.gap.structure_response.modal_table_settings import MODAL_TABLE
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_search.approach import (
    approached,
    explaining_cost,
)
from jointbench.analysis.gap.structure_search.slopes_again import with_slopes
from jointbench.analysis.gap.structure_search.sought_frequencies import (
    from_other_frequencies,
)
from jointbench.analysis.gap.structure_search.structure_fits import (
    chi2_per_dof,
    settled,
)
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)


def base_in_windows(few: StructureBench) -> FloatArray:
    """Return the base fitted from its nominal values, coarse to fine, shape (n_base,).

    Args:
        few: records of the base, see `records_of_base`.
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

    A base far off is fitted to some of them, and its chi2 is that of all records.

    Args:
        bench: all records.
        few: records of the base, see `records_of_base`.
        start: base coordinates as fitted in short windows, shape (n_base,).
    """
    few = replace(few, reach=bench.reach, floor=few.table_floor)
    few, fit = approached(few, start, ())
    few, fit = from_other_frequencies(few, fit) or (few, fit)
    chi2 = chi2_per_dof(few, fit)
    explains, x = chi2 < few.policy.floor_chi2, fit.x
    layout = with_errors_found(bench.layout, fit, explains=explains)
    # What these records take is needed for all of them.
    del few, fit
    bench = replace(bench, layout=layout)
    if chi2 < STRUCTURE_SEARCH.explaining_chi2:
        limit = explaining_cost(bench)
        rival = None if limit is None else limit * bench.blocks.dof
        bench, fit = settled(bench, x, (), near=True, rival=rival)
        fit = without_late_slopes(fit)  # or they are kept beside those at the end
        return bench, with_slopes(bench, fit)
    whole = bench.at(x, (), bench.landing, bench.table_floor)
    return whole, minimise(make_problem(whole, ()), x, FULL, iterations=0)


def with_errors_found(layout: BaseLayout, base: Fit, *, explains: bool) -> BaseLayout:
    """Return the base coordinates with frequencies as uncertain as the base shows.

    The stated sd of the frequencies of a table is a guess of one size for all of them.
    Where their median deviation is larger, an effect that shifts many modes would be
    named for it. The deviations of a base that explains the records are all due to the
    table, so their rms counts: of twenty modes, one is often off by three sd.

    Args:
        layout: as stated.
        base: fit without effects.
        explains: whether it explains the records.
    """
    if layout.tuned is None:
        return layout
    own = np.array([layout.at(name) for name in layout.tuned.names], dtype=np.int64)
    alone = own[: layout.tuned.omega.size]
    free = alone[layout.sd[alone] > MODAL_TABLE.open_frequency]
    if not free.size:
        return layout
    deviations = np.abs(base.prior_deviations[free])
    # The median of the absolute value of a normal variable is its upper quartile.
    found = float(np.median(deviations) / ndtri(0.75))
    if explains:
        found = max(found, float(np.sqrt(np.mean(deviations**2))))
    sd = layout.sd.copy()
    sd[own] *= float(np.clip(found, 1.0, MODAL_TABLE.largest_size))
    return replace(layout, sd=sd)
