# SPDX-License-Identifier: MIT
"""Faults of sensors beside a base that explains the hits.

A sensor at fault changes its own channel, in all modes alike, and leaves the structure
as it is. Errors of a table are those of the structure and change all channels, mode by
mode. So a fault is seen in 60 ms beside an accepted base, in which it leaves chi2
inconspicuous, and what is left of the records shows how large errors of the table are.
"""

from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import Progress
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.fits_from_base import (
    fits_from_base,
    tested_beside,
)
from jointbench.analysis.gap.structure_search.records_of_search import (
    torques_in_turn,
)
from jointbench.analysis.gap.structure_search.structure_fits import chi2_per_dof
from jointbench.analysis.gap.structure_search.whole_records import JudgedFit


def sensors_from_base(
    whole: StructureBench, base: Fit, progress: Progress
) -> list[JudgedFit]:
    """Return fits of sensors at fault from the base, best first; none without a sign.

    They are at rest, so that a search may follow.

    Args:
        whole: all records, on which the base was found and explains them.
        base: fit without effects.
        progress: receives one line for each step.
    """
    progress("directed tests of sensors")
    own = whole.chosen(torques_in_turn(whole.campaign.hits))
    sensors = [c for c in own.candidates if c.site.kind == "channel"]
    near, found = tested_beside(own, base, sensors)
    if found.largest < found.threshold * min(chi2_per_dof(own, near), 1.0):
        return []
    return fits_from_base(whole, own, base, found, progress)


def of_table(bench: StructureBench, fit: Fit) -> float:
    """Return the size of errors of the table in a fit of sensors, 1 in any other.

    Args:
        bench: with an uncertain table.
        fit: with effects.
    """
    if not bench.uncertain or any(c.site.kind != "channel" for c in fit.candidates):
        return 1.0
    return min(chi2_per_dof(bench, fit), 1.0)


def within_tolerance(bench: StructureBench, fit: Fit) -> bool:
    """Return whether a fit has a sensor as sensors are: placed, turned and calibrated.

    Args:
        bench: with its catalogue.
        fit: with effects.
    """
    tolerance = {e.effect.name: e.tolerance for e in bench.entries}
    return any(
        abs(float(term.coordinates[0])) < tolerance.get(term.candidate.effect.name, 0.0)
        for term in fit.terms
    )
