# SPDX-License-Identifier: MIT
"""Records of the chain: surface, contact law, structure, and what each one's data say.

::

    surface -> spectrum -> contact law -> k(preload) -> structure -> hits
"""

from dataclasses import dataclass
from enum import StrEnum

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.contact_bench.preload_law import PreloadLaw
from jointbench.analysis.gap.model.diagnosis_record import Finding, NamedEffect


class ChainLink(StrEnum):
    """A link of the chain."""

    SURFACE = "surface"
    CONTACT = "contact"
    STRUCTURE = "structure"


@dataclass(frozen=True, slots=True)
class LinkTest:
    """Test of one link against its own data.

    Attributes:
        cost: chi2 of its data and priors [-].
        dof: degrees of freedom [-].
        passed: whether the link explains its data.
        reason: why not, or what was tested.
        charge: of parameters that were added, in units of the cost [-].
    """

    cost: float
    dof: int
    passed: bool
    reason: str = ""
    charge: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class JointReading:
    """Stiffness of a joint in each state, as a structure gives it.

    Attributes:
        log_stiffness: ln k [ln N/m], shape (n_states,).
        covariance: of it, shape (n_states, n_states).
        test: of the structure with a joint stiffness that is free in each state.
    """

    log_stiffness: FloatArray
    covariance: FloatArray
    test: LinkTest

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "log_stiffness", "covariance")


@dataclass(frozen=True, slots=True, eq=False)
class StructureReading:
    """What the hits say of structure and joint.

    Attributes:
        before: by the model as it is.
        after: by the model with the effects named; None where none is.
        finding: verdict on the structure.
        effects: of the structure that were found.
        reason: basis of the verdict.
        experiment: what to measure next.
        family: of the force law that explains most of the gap, and where; empty unless
            the finding is mostly.
    """

    before: JointReading
    after: JointReading | None = None
    finding: Finding = Finding.NONE
    effects: tuple[NamedEffect, ...] = ()
    reason: str = ""
    experiment: str = ""
    family: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceReading:
    """What the heights say of the surfaces, and the contact law that follows.

    Attributes:
        law: of the surfaces as measured.
        test: of the surfaces against their own data.
        corrected: law of the surfaces without the effects named; None where none is.
        corrected_test: of the surfaces with these effects.
        finding: verdict on the surfaces.
        effects: that were found.
        reason: basis of the verdict.
        experiment: what to measure next.
    """

    law: PreloadLaw
    test: LinkTest
    corrected: PreloadLaw | None = None
    corrected_test: LinkTest | None = None
    finding: Finding = Finding.NONE
    effects: tuple[NamedEffect, ...] = ()
    reason: str = ""
    experiment: str = ""


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A place where the disagreement may enter, with what it leaves at every link.

    Attributes:
        links: with a free discrepancy; empty for none.
        tests: of surface, contact law and structure under it.
    """

    links: tuple[ChainLink, ...]
    tests: tuple[LinkTest, LinkTest, LinkTest]

    @property
    def restored(self) -> bool:
        """Whether every link explains its data."""
        return all(test.passed for test in self.tests)

    @property
    def score(self) -> float:
        """Cost of all links with the charges of what was added [-]."""
        return sum(test.cost + test.charge for test in self.tests)

    @property
    def words(self) -> str:
        """The links in words."""
        return " and ".join(link.value for link in self.links) or "no link"
