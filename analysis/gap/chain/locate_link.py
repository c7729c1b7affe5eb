# SPDX-License-Identifier: MIT
"""At which link of the chain the disagreement enters.

One free discrepancy is put at one interface at a time, with all else held at the
posterior of its own data. The place whose discrepancy alone restores every link is
where the disagreement enters; places that restore them equally well are ambiguous.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

from jointbench.analysis.gap.chain.chain_records import (
    ChainLink,
    Hypothesis,
    JointReading,
    LinkTest,
    StructureReading,
    SurfaceReading,
)
from jointbench.analysis.gap.chain.chain_settings import CHAIN
from jointbench.analysis.gap.chain.contact_link import (
    ContactLink,
    base_test,
    cut_test,
    fit_contact_link,
    free_test,
)
from jointbench.analysis.gap.chain.joint_over_preload import (
    BoltedStates,
    joint_data,
    with_common_error,
)
from jointbench.analysis.gap.contact_bench.preload_law import PreloadLaw
from jointbench.analysis.gap.model.policy import STANDARD

_SINGLE = (
    (),
    (ChainLink.SURFACE,),
    (ChainLink.CONTACT,),
    (ChainLink.STRUCTURE,),
)
_SEVERAL = (
    (ChainLink.SURFACE, ChainLink.CONTACT),
    (ChainLink.CONTACT, ChainLink.STRUCTURE),
    (ChainLink.SURFACE, ChainLink.STRUCTURE),
    tuple(ChainLink),
)


@dataclass(frozen=True, slots=True, eq=False)
class Location:
    """Where the disagreement enters.

    Attributes:
        hypotheses: all that were tested.
        places: those that restore every link and cannot be distinguished by score,
            best first; empty where none restores them.
    """

    hypotheses: tuple[Hypothesis, ...]
    places: tuple[Hypothesis, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Surfaces, joint and structure as measured, ready to be tested.

    Attributes:
        surface: what the heights say.
        structure: what the hits say.
        states: of the joint.
    """

    surface: SurfaceReading
    structure: StructureReading
    states: BoltedStates
    _fits: dict[tuple[int, int], ContactLink] = field(default_factory=dict)

    def contact(self, law: PreloadLaw, reading: JointReading) -> ContactLink:
        """Return the contact law fitted to a reading of the joint."""
        key = (id(law), id(reading))
        if key not in self._fits:
            data = joint_data(self.states, reading)
            self._fits[key] = fit_contact_link(data, law)
        return self._fits[key]

    @property
    def law(self) -> PreloadLaw:
        """Law of the surfaces, without the effects that their own data show."""
        return self.surface.corrected or self.surface.law

    @property
    def reading(self) -> JointReading:
        """Joint by the structure with the effects that its own hits show."""
        return self.structure.after or self.structure.before


def locate(chain: Chain) -> Location:
    """Find the links at which the disagreement enters, as few as possible.

    Args:
        chain: of one joint.
    """
    single = tuple(_tested(chain, links) for links in _SINGLE)
    places = _best([one for one in single if one.restored])
    if places:
        return Location(single, places)
    several = tuple(_tested(chain, links) for links in _SEVERAL)
    fewest: list[Hypothesis] = []
    for count in (2, 3):
        restored = [h for h in several if h.restored and len(h.links) == count]
        fewest = fewest or restored
    return Location((*single, *several), _best(fewest))


def with_explained(location: Location, test: LinkTest) -> Location:
    """Return the places where effects that explain the joint are a discrepancy, too.

    A free shape of ln k does not bend as every effect does, and pays for more
    parameters than most have.

    Args:
        location: by free shapes.
        test: of the best effects of the contact, accepted.
    """
    hypotheses = tuple(
        replace(one, tests=(one.tests[0], _better(one.tests[1], test), one.tests[2]))
        if ChainLink.CONTACT in one.links
        else one
        for one in location.hypotheses
    )
    restored = [one for one in hypotheses if one.restored]
    fewest = min((len(one.links) for one in restored), default=0)
    places = _best([one for one in restored if len(one.links) == fewest])
    return Location(hypotheses, places)


def _better(free: LinkTest, effects: LinkTest) -> LinkTest:
    charged = free.cost + free.charge
    return free if free.passed and charged <= effects.cost + effects.charge else effects


def _best(restored: list[Hypothesis]) -> tuple[Hypothesis, ...]:
    """Return the hypotheses that cannot be distinguished from the best."""
    if not restored:
        return ()
    if not restored[0].links:
        return (restored[0],)
    ordered = sorted(restored, key=lambda one: one.score)
    limit = ordered[0].score + STANDARD.rival_score
    return tuple(one for one in ordered if one.score < limit)


def _tested(chain: Chain, links: tuple[ChainLink, ...]) -> Hypothesis:
    """Test every link with a free discrepancy at some of them."""
    surface, law, cut = _surface(chain, ChainLink.SURFACE in links)
    structure, reading = _structure(chain, ChainLink.STRUCTURE in links)
    contact = chain.contact(law, reading)
    test: Callable[[], LinkTest] = partial(base_test, contact)
    if ChainLink.CONTACT in links:
        test = partial(free_test, contact)
    elif cut:
        found = cut_test(contact)
        test = test if found is None else lambda: found
    return Hypothesis(links, (surface, test(), structure))


def _surface(chain: Chain, free: bool) -> tuple[LinkTest, PreloadLaw, bool]:
    """Return test and law of the surfaces, and whether their cut-off is free."""
    own = chain.surface
    if free and own.corrected is not None and own.corrected_test is not None:
        return own.corrected_test, own.corrected, False
    return own.test, own.law, free and own.test.passed


def _structure(chain: Chain, free: bool) -> tuple[LinkTest, JointReading]:
    """Return test of the structure, and its reading of the joint."""
    own = chain.structure
    if not free:
        return own.before.test, own.before
    if own.after is not None:
        return own.after.test, own.after
    # A natural frequency off by s changes ln k by 2 s.
    return own.before.test, with_common_error(own.before, 2.0 * CHAIN.mode_discrepancy)
