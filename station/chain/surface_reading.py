# SPDX-License-Identifier: MIT
"""From measured heights to the contact law of a joint, with the test of the heights."""

from collections.abc import Sequence

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Surface
from jointbench.analysis.contact.contact_case import ContactConditions
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.gap.chain.chain_records import LinkTest, SurfaceReading
from jointbench.analysis.gap.chain.joint_over_preload import BoltedStates
from jointbench.analysis.gap.contact_bench.measured_preload_law import (
    MeasuredPreloadLaw,
    measured_preload_law,
)
from jointbench.signal.band_limited.band_limited_fit import fit_lines
from jointbench.station.contact.measured_prediction import (
    MeasuredJoint,
    measured_case,
)
from jointbench.station.schemas.bolted_joint_table import BoltedLinkTable

_MOST = 2


def surface_law(
    surfaces: Sequence[Surface], table: BoltedLinkTable, states: BoltedStates
) -> MeasuredPreloadLaw:
    """Return the contact law of measured surfaces that applies at most states.

    Args:
        surfaces: of both sides, or one that stands for both.
        table: area and materials.
        states: of the joint.

    Raises:
        UsageError: there are more than two surfaces.
        BadData: a surface shows no wavelength, or has too few points.
    """
    if len(surfaces) > _MOST:
        raise UsageError(
            f"{len(surfaces)} surfaces are given; a joint has two: give --surface once "
            "for both alike, or twice"
        )
    facts = states.facts
    conditions = ContactConditions(
        ContactMaterial(facts.modulus, table.hardness, facts.poisson),
        modulus_sd=table.modulus_sd * facts.modulus,
        hardness_sd=table.hardness_sd * table.hardness,
    )
    fits = [fit_lines([one]) for one in surfaces]
    case = measured_case(surfaces, fits, MeasuredJoint(facts.area, conditions, ()))
    return measured_preload_law(case, states.log_range, facts.poisson)


def read_surfaces_of_chain(
    surfaces: Sequence[Surface], table: BoltedLinkTable, states: BoltedStates
) -> SurfaceReading:
    """Return what the heights say, and the contact law that follows.

    Args:
        surfaces: of both sides, or one that stands for both.
        table: area and materials.
        states: of the joint.
    """
    law = surface_law(surfaces, table, states)
    test = LinkTest(0.0, 0, True, "their own data are not tested")
    return SurfaceReading(law, test)
