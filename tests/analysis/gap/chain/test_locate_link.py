"""The link at which a chain disagrees, from readings of its links."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jointbench.analysis.gap.chain.chain_diagnosis import diagnose_chain
from jointbench.analysis.gap.chain.chain_records import (
    ChainLink,
    JointReading,
    LinkTest,
    StructureReading,
    SurfaceReading,
)
from jointbench.analysis.gap.chain.joint_over_preload import BoltedStates
from jointbench.analysis.gap.chain.locate_link import Chain, locate, with_explained
from jointbench.analysis.gap.chain.moved_quantities import moved_stiffness
from jointbench.analysis.gap.contact_bench.joint_states import JointFacts
from jointbench.analysis.gap.contact_bench.preload_law import LawParameter
from jointbench.analysis.gap.contact_bench.preload_laws import (
    AsperityPreloadLaw,
    PowerPreloadLaw,
    asperity_parameters,
)
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.station.gap.contact_section import joint_figure

PRELOAD = np.array([2e3, 4e3, 8e3, 16e3, 32e3, 64e3])
FACTS = JointFacts(4, 0.008, 0.2, 0.15, 0.03, 0.2, 0.0064, 2.9e10, 0.25)
GOOD = LinkTest(100.0, 100, passed=True)
BAD = LinkTest(5000.0, 100, passed=False, reason="chi2/dof is 50")


def law(stiffness: float = 1e10) -> PowerPreloadLaw:
    """Return k = 1e10 N/m at 8 kN, linear in the preload."""
    rows = (
        LawParameter("stiffness", "N/m", stiffness, 0.1),
        LawParameter("exponent", "-", 1.0, 0.02),
    )
    return PowerPreloadLaw(rows, 8e3, 0.25)


def chain(
    stiffness: np.ndarray,
    *,
    test: LinkTest = GOOD,
    after: np.ndarray | None = None,
    surface: SurfaceReading | None = None,
) -> Chain:
    """Return a chain whose structure gives these stiffnesses."""
    scatter = np.array([0.02, -0.015, 0.01, -0.01, 0.015, -0.02])

    def reading(values: np.ndarray, own: LinkTest) -> JointReading:
        return JointReading(np.log(values) + scatter, np.eye(6) * 1e-4, own)

    structure = StructureReading(
        reading(stiffness, test), None if after is None else reading(after, GOOD)
    )
    states = BoltedStates("made", FACTS, PRELOAD, np.zeros(6, dtype=np.int64))
    return Chain(surface or SurfaceReading(law(), GOOD), structure, states)


RIGHT = 1e10 * PRELOAD / 8e3


def test_a_chain_that_agrees_needs_no_discrepancy() -> None:
    """All links pass without one."""
    found = diagnose_chain(chain(RIGHT))
    assert found.finding is Finding.NONE
    assert found.links == ()


def test_a_compliance_is_found_at_the_contact_law_and_named() -> None:
    """Bodies of 5e-11 m/N cap the stiffness; the factor is that of the series."""
    compliant = 1.0 / (1.0 / RIGHT + 5e-11)
    found = diagnose_chain(chain(compliant))
    assert found.links == (ChainLink.CONTACT,)
    assert found.finding is Finding.NAMED
    assert found.names == ("series_compliance@link:joint",)
    assert found.several is not None
    at = found.several.reference
    (cause,) = found.several.causes
    assert cause.low < compliant[at] / RIGHT[at] < cause.high
    off = found.several.product.factor / found.several.measured
    assert off == pytest.approx(1, abs=0.3)


def test_a_fault_of_the_structure_is_found_there() -> None:
    """Only the structure fails; with its effect the joint is that of the law."""
    location = locate(chain(0.5 * RIGHT**0.8, test=BAD, after=RIGHT))
    assert [p.links for p in location.places] == [(ChainLink.STRUCTURE,)]


def test_a_structure_that_no_effect_restores_is_the_place() -> None:
    """With the joint free in each state, what is left is of the structure.

    Its stiffness of the joint is not that of the law, and is no evidence on it.
    """
    failing = chain(0.01 * RIGHT**1.1, test=BAD)
    structure = replace(
        failing.structure, finding=Finding.MOSTLY, reason="friction", family="friction"
    )
    found = diagnose_chain(replace(failing, structure=structure))
    assert found.links == (ChainLink.STRUCTURE,)
    assert found.finding is Finding.MOSTLY
    assert found.several is None
    assert "cannot be judged" in found.reason


def test_a_fault_of_the_surfaces_is_found_there() -> None:
    """Surfaces fail on their own heights; without the fault the law is right."""
    surface = SurfaceReading(law(4e11), BAD, law(), GOOD)
    location = locate(chain(RIGHT, surface=surface))
    assert [p.links for p in location.places] == [(ChainLink.SURFACE,)]


def test_two_faults_are_found_at_two_links() -> None:
    """No single discrepancy restores structure and contact law."""
    compliant = 1.0 / (1.0 / RIGHT + 5e-11)
    location = locate(chain(0.5 * RIGHT, test=BAD, after=compliant))
    assert [p.links for p in location.places] == [
        (ChainLink.CONTACT, ChainLink.STRUCTURE)
    ]


def measured(
    preload: list[float], log_k: list[float], facts: JointFacts, moments: list[float]
) -> Chain:
    """Return a chain whose law is that of rms, slope, curvature and modulus."""
    sds = (0.05, 0.08, 0.1, 0.03)
    pairs = list(zip(moments, sds, strict=True))
    own = AsperityPreloadLaw(asperity_parameters(*pairs), facts.area, facts.poisson)
    count = len(preload)
    reading = JointReading(np.array(log_k), 9e-6 * np.eye(count), GOOD)
    states = BoltedStates(
        "made", facts, np.array(preload), np.zeros(count, dtype=np.int64)
    )
    return Chain(SurfaceReading(own, GOOD), StructureReading(reading, None), states)


def test_a_cut_off_and_a_compliance_are_compared_as_effects() -> None:
    """Five torques of a compliant joint; a free shape of ln k would cost four times."""
    made = measured(
        [18094.3, 30474.8, 49498.4, 78355.8, 132251.6],
        [24.46652, 24.88012, 25.24473, 25.52683, 25.84701],
        JointFacts(
            *(3, 0.01, 0.2, 0.15, 0.02236, 0.2, 0.0085088, 2.507561e10, 0.28),
            *(0.0266283, 0.0141846, 0.0077633),
        ),
        [1.155e-6, 0.0475776, 4121.18, 2.507561e10],
    )
    assert [p.links for p in locate(made).places] == [(ChainLink.SURFACE,)]
    found = diagnose_chain(made)
    assert found.finding is Finding.AMBIGUOUS
    assert "scale_cut@surface" in found.names
    assert "series_compliance@link:joint" in found.names


def test_causes_are_not_added_to_one_that_explains_the_joint_alone() -> None:
    """It is five sd from zero; three together would be no better founded."""
    made = measured(
        [5940.67, 8412.70, 9589.10, 13526.4, 18085.2, 22979.1, 35518.2, 38236.4],
        [
            24.45233,
            24.72383,
            24.84256,
            25.09302,
            25.27852,
            25.48351,
            25.76728,
            25.84935,
        ],
        JointFacts(
            *(2, 0.016, 0.2, 0.15, 0.0372182, 0.2, 0.0061967, 4.629376e10, 0.28),
            *(0.0227243, 0.0127544, 0.0086517),
        ),
        [4.05127e-7, 0.0158005, 1769.563, 4.629376e10],
    )
    found = diagnose_chain(made)
    assert found.links == (ChainLink.CONTACT,)
    assert found.finding is Finding.UNKNOWN
    assert found.several is None


def test_effects_that_explain_the_joint_restore_it_where_no_free_shape_does() -> None:
    """A step of ln k is no offset, slope or bend; an accepted effect may have one."""
    stepped = RIGHT * np.array([1.0, 1.0, 1.0, 0.1, 0.1, 1.0])
    location = locate(chain(stepped))
    assert location.places == ()
    found = with_explained(location, LinkTest(8.0, 6, passed=True, charge=10.0))
    assert [p.links for p in found.places] == [(ChainLink.CONTACT,)]


def compliant_and_wavy() -> Chain:
    """Return a joint with bodies in series, whose waves close below 6 kN."""
    waves = 1e-10 * np.maximum(np.log(6e3 / PRELOAD), 0.0)
    stiffness = 1.0 / (1.0 / RIGHT + 2e-11 + waves)
    reading = JointReading(np.log(stiffness), np.eye(6) * 1e-6, GOOD)
    facts = replace(FACTS, torque_scatter=0.005)
    states = BoltedStates("made", facts, PRELOAD, np.zeros(6, dtype=np.int64))
    return Chain(SurfaceReading(law(), GOOD), StructureReading(reading), states)


def test_causes_that_explain_the_joint_together_are_a_place() -> None:
    """Bodies and waves bend ln k as no free shape does: the pair restores the chain."""
    given = compliant_and_wavy()
    found = diagnose_chain(given)
    assert found.contact.found.verdict is Finding.UNKNOWN
    assert found.links == (ChainLink.CONTACT,)
    assert found.finding is Finding.NAMED
    assert set(found.names) == {"series_compliance@link:joint", "waviness@link:joint"}
    free = {one.words: one.tests[1] for one in locate(given).hypotheses}["contact"]
    assert not free.passed


def test_what_is_drawn_of_the_joint_is_what_is_named() -> None:
    """Figure and held-out torques are those of the causes together."""
    given = compliant_and_wavy()
    found = diagnose_chain(given)
    assert found.several is not None
    drawn = {c.effect.name for c in found.joint.best.candidates}
    assert drawn == {cause.name for cause in found.several.causes}
    np.testing.assert_array_equal(
        moved_stiffness(found).after, np.exp(found.several.held.predicted)
    )
    traces: Any = joint_figure(found.joint, 0)["data"]
    assert traces[-1]["name"].startswith("with series compliance")
    assert "waviness" in traces[-1]["name"]
    np.testing.assert_allclose(
        traces[-1]["y"], np.exp(given.reading.log_stiffness), rtol=0.02
    )
