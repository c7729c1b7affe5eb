# SPDX-License-Identifier: MIT
"""Effects that differ between hits of a point, beside a base that explains the hits.

Errors of a modal table are the same in all hits of a point: they imitate no law that
bends with amplitude and no joint that follows its torque. So such an effect is sought
in what is left when errors of any size are allowed, far below what a table may leave.
"""

from dataclasses import replace

import numpy as np

from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import Progress
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.fits_from_base import (
    fits_from_base,
    tested_beside,
)
from jointbench.analysis.gap.structure_search.records_of_search import one_of_each
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)
from jointbench.analysis.gap.structure_search.whole_records import JudgedFit


def differences_from_base(
    whole: StructureBench, base: Fit, progress: Progress
) -> list[JudgedFit]:
    """Return fits of effects that differ between hits, best first; none without a sign.

    They are at rest, so that a search may follow.

    Args:
        whole: all records, on which the base was found and explains them.
        base: fit without effects.
        progress: receives one line for each step.
    """
    progress("directed tests of what differs between hits")
    own = with_any_errors(whole.chosen(one_of_each(whole.campaign.hits)))
    differing = [c for c in own.candidates if differs(own, c)]
    _, found = tested_beside(own, base, differing)
    least = STRUCTURE_SEARCH.difference_drop
    return fits_from_base(whole, own, base, found, progress, least=least)


def takes_differences(bench: StructureBench, fit: Fit, base: Fit) -> bool:
    """Return whether effects take what differs between hits of a point.

    Args:
        bench: all records, on which the fit was found.
        fit: with effects.
        base: fit without effects.
    """
    if not all(differs(bench, c) for c in fit.candidates):
        return False
    own = with_any_errors(bench)
    left = own.residual(base.base, (), FULL), own.residual(fit.base, fit.terms, FULL)
    drop = float(left[0] @ left[0] - left[1] @ left[1])
    return drop > STRUCTURE_SEARCH.difference_drop


def differs(bench: StructureBench, candidate: Candidate) -> bool:
    """Return whether an effect acts differently in hits of one point.

    Args:
        bench: with its catalogue.
        candidate: effect at a site.
    """
    names = {e.effect.name for e in bench.entries if e.nonlinear or e.by_torque}
    return candidate.effect.name in names


def with_any_errors(bench: StructureBench) -> StructureBench:
    """Return a bench on which errors of its modal table may have any size.

    Raises:
        ValueError: its errors are not known yet, or its table is exact.
    """
    if bench.errors is None:
        raise ValueError("errors of the table are not known yet")
    sd = np.maximum(bench.errors.sd, bench.errors.sd.mean(axis=(0, 1)))
    errors = replace(bench.errors, sd=STRUCTURE_SEARCH.any_error * sd)
    return replace(bench, errors=errors, kept={})
