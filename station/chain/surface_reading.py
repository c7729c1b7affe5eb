# SPDX-License-Identifier: MIT
"""From measured heights to the contact law of a joint, with the test of the heights."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy import ndimage

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Surface
from jointbench.analysis.contact.contact_case import ContactConditions
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.gap.chain.chain_records import LinkTest, SurfaceReading
from jointbench.analysis.gap.chain.chain_settings import CHAIN
from jointbench.analysis.gap.chain.joint_over_preload import BoltedStates
from jointbench.analysis.gap.contact_bench.measured_preload_law import (
    MeasuredPreloadLaw,
    measured_preload_law,
)
from jointbench.analysis.gap.law_diagnosis.surface_diagnosis import (
    SurfaceDiagnosis,
    diagnose_surface,
)
from jointbench.analysis.gap.model.diagnosis_record import Finding, NamedEffect
from jointbench.signal.band_limited.band_limited_fit import fit_lines
from jointbench.station.contact.measured_prediction import (
    MeasuredJoint,
    measured_case,
)
from jointbench.station.schemas.bolted_joint_table import BoltedLinkTable

Progress = Callable[[str], None]
_MOST = 2
_FAULTS = ("instrument", "fault")
"""Families of the effects that are no property of the surface itself."""
_SPIKES = frozenset({"outliers", "missing_points"})


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
    surfaces: Sequence[Surface],
    table: BoltedLinkTable,
    states: BoltedStates,
    progress: Progress,
) -> SurfaceReading:
    """Return what the heights say, and the contact law that follows.

    Processes of the surface (roll-off, tool marks, a second process) are part of its
    spectrum, which the law takes as it is. Faults of the instrument are not: they are
    the disagreement at this link. Spikes are taken out of the heights; noise and blur
    the spectrum of the law leaves out itself.

    Args:
        surfaces: of both sides, or one that stands for both.
        table: area and materials.
        states: of the joint.
        progress: receives one line per step.
    """
    law = surface_law(surfaces, table, states)
    done = []
    for one in surfaces:
        progress(f"testing surface {one.name}")
        done.append(diagnose_surface(one))
    faults = [e for one in done for e in _faults(one)]
    cost = sum(one.base.cost for one in done)
    dof = sum(one.bench.blocks.dof for one in done)
    best = sum(one.best.cost for one in done)
    unknown = [one for one in done if one.found.verdict is Finding.UNKNOWN]
    if not faults:
        words = "shows no fault of the instrument"
        if unknown:
            words += (
                f"; the law takes its spectrum as measured ({unknown[0].found.reason})"
            )
        return SurfaceReading(law, LinkTest(best, dof, passed=True, reason=words))
    spiked = any(e.name in _SPIKES for e in faults)
    cleaned = [_without_spikes(one) for one in surfaces] if spiked else surfaces
    corrected = surface_law(cleaned, table, states) if spiked else law
    charge = CHAIN.surface_charge * sum(len(e.parameters) for e in faults)
    names = ", ".join(dict.fromkeys(e.name for e in faults))
    ambiguous = any(one.found.verdict is Finding.AMBIGUOUS for one in done)
    return SurfaceReading(
        law,
        LinkTest(cost, dof, passed=False, reason=f"its heights show {names}"),
        corrected,
        LinkTest(best, dof, passed=True, reason=f"with {names}", charge=charge),
        Finding.AMBIGUOUS if ambiguous else Finding.NAMED,
        tuple({e.name: e for e in faults}.values()),
        f"its heights show {names}",
        next((one.found.experiment for one in done if _faults(one)), ""),
    )


def _faults(done: SurfaceDiagnosis) -> list[NamedEffect]:
    """Return the effects of the instrument that a diagnosis names."""
    families = {c.effect.name: c.effect.family for c in done.bench.candidates}
    return [e for e in done.found.effects if families.get(e.name) in _FAULTS]


def _without_spikes(surface: Surface) -> Surface:
    """Return a surface whose spikes are replaced by the median of their neighbours."""
    heights = surface.heights
    median = ndimage.median_filter(heights, size=CHAIN.spike_window)
    off = heights - median
    scale = 1.4826 * float(np.median(np.abs(off - np.median(off)))) or 1e-300
    spikes = np.abs(off) > CHAIN.spike_limit * scale
    return replace(surface, heights=np.where(spikes, median, heights))
