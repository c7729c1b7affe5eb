# SPDX-License-Identifier: MIT
"""Diagnosis of a chain: the link at which the disagreement enters, and its name."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.chain.chain_records import ChainLink, Hypothesis, LinkTest
from jointbench.analysis.gap.chain.contact_link import CUT
from jointbench.analysis.gap.chain.joint_over_preload import joint_data
from jointbench.analysis.gap.chain.locate_link import (
    Chain,
    Location,
    locate,
    with_explained,
)
from jointbench.analysis.gap.chain.several_causes import (
    SeveralCauses,
    add_causes,
    causes_of,
    explains_plainly,
)
from jointbench.analysis.gap.contact_bench.contact_bench import (
    ContactBench,
    make_contact_bench,
)
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.law_diagnosis.contact_diagnosis import (
    MORE_STATES,
    ContactDiagnosis,
    conclude_contact,
    too_few,
)
from jointbench.analysis.gap.law_diagnosis.contact_search import search_contact
from jointbench.analysis.gap.model.diagnosis_record import Finding

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, eq=False)
class ChainDiagnosis:
    """Result on a chain.

    Attributes:
        chain: surfaces, states and structure.
        location: links at which the disagreement may enter.
        contact: diagnosis of the joint, by the law of the corrected surfaces and the
            corrected structure.
        several: causes at the joint with their factors; None where none is named, or
            where the structure does not hold.
        finding: verdict on the whole chain.
        names: effects that were found, as ``name@site``, along the chain.
        reason: basis of the verdict.
        experiment: what to measure next.
    """

    chain: Chain
    location: Location
    contact: ContactDiagnosis
    several: SeveralCauses | None
    finding: Finding
    names: tuple[str, ...]
    reason: str
    experiment: str

    @property
    def links(self) -> tuple[ChainLink, ...]:
        """Links of the best place; empty where no link disagrees or none is found."""
        places = self.location.places
        return places[0].links if places else ()

    @property
    def joint(self) -> ContactDiagnosis:
        """Diagnosis of the joint with the fit whose causes are named."""
        if self.several is None or len(self.several.causes) < 2:
            return self.contact
        own = self.several
        return replace(self.contact, best=own.fit, after=own.held)


@one_thread()
def diagnose_chain(
    chain: Chain,
    *,
    without: frozenset[str] = frozenset(),
    progress: Progress = lambda line: None,
) -> ChainDiagnosis:
    """Find the link at which a chain disagrees, and name what it lacks.

    Args:
        chain: surfaces, states and structure as measured.
        without: names of effects of the contact to leave out of its catalogue.
        progress: receives one line per step.
    """
    progress("locating the link at which the disagreement enters")
    location = locate(chain)
    data = joint_data(chain.states, chain.reading)
    bench = make_contact_bench(data, chain.law, without=without)
    outcome = search_contact(bench, progress)
    final = outcome.bench
    if not isinstance(final, ContactBench):
        raise TypeError("the search must return a bench of the type it was given")
    contact = conclude_contact(outcome, final)
    several = None
    judged = structure_holds(chain) and not too_few(data)
    if judged and not outcome.base_acceptance.passed:
        several = _causes(outcome, final, contact, progress)
    if (test := _explained(outcome, final, several)) is not None:
        location = with_explained(location, test)
    location = _at_structure(_decided(location, chain, contact), chain)
    found = ChainDiagnosis(chain, location, contact, several, Finding.NONE, (), "", "")
    return _concluded(found)


def _explained(
    outcome: SearchOutcome, bench: ContactBench, several: SeveralCauses | None
) -> LinkTest | None:
    """Return the test of the best effects of the contact that are accepted, if any.

    Several together count where no single one is accepted.
    """
    level = outcome.level if outcome.acceptance.passed else ()
    if not level and several is not None:
        level = (several.fit,)
    own = [f for f in level if CUT not in {c.effect.name for c in f.candidates}]
    if not (own and own[0].candidates):
        return None
    best = own[0]
    charge = bench.policy.parameter_charge * (best.x.size - best.n_base)
    words = "with " + " + ".join(c.effect.name for c in best.candidates)
    return LinkTest(
        best.cost, bench.blocks.dof, passed=True, reason=words, charge=charge
    )


def _decided(location: Location, chain: Chain, contact: ContactDiagnosis) -> Location:
    """Let the contact bench decide between a cut-off and another effect.

    A cut-off has one parameter, a free shape of ln k has several: their scores do not
    compare as those of two effects do.
    """
    cut = (ChainLink.SURFACE,)
    both = (cut, (ChainLink.CONTACT,))
    if not any(one.links in both for one in location.places):
        return location
    restored = {h.links: h for h in location.hypotheses if h.restored}
    if not chain.surface.test.passed or not all(links in restored for links in both):
        return location
    shown = _links_of(contact)
    if not shown:
        return location
    others = tuple(one for one in location.places if one.links not in both)
    kept = tuple(restored[links] for links in both if links in shown)
    return replace(location, places=(*kept, *others))


def _at_structure(location: Location, chain: Chain) -> Location:
    """Place the disagreement at a structure that does not explain its own hits.

    The joint is free in each state, which takes up whatever contact law and surfaces
    do: what it leaves is of the structure, also where no effect restores it.
    """
    if location.places or structure_holds(chain) or not chain.surface.test.passed:
        return location
    alone = tuple(h for h in location.hypotheses if h.links == (ChainLink.STRUCTURE,))
    return replace(location, places=alone)


def structure_holds(chain: Chain) -> bool:
    """Return whether the structure explains its hits, with its effects if any.

    Where it does not, its reading of the joint is no evidence on contact and surfaces.
    """
    own = chain.structure
    return own.before.test.passed or (own.after is not None and own.after.test.passed)


def _links_of(contact: ContactDiagnosis) -> set[tuple[ChainLink, ...]]:
    """Return the links of the effects that the contact bench names or cannot separate.

    None where it names no effect.
    """
    if contact.found.verdict not in (Finding.NAMED, Finding.AMBIGUOUS):
        return set()
    return {
        (ChainLink.SURFACE if e.name == CUT else ChainLink.CONTACT,)
        for e in contact.found.effects
    }


def _causes(
    outcome: SearchOutcome,
    bench: ContactBench,
    contact: ContactDiagnosis,
    progress: Progress,
) -> SeveralCauses | None:
    """Return the causes at the joint; more than one where one leaves too much."""
    named = contact.found.verdict in (Finding.NAMED, Finding.AMBIGUOUS)
    if not (named and explains_plainly(bench, outcome.best)):
        found = add_causes(outcome, progress)
        if found is not None:
            return found
    if not named:
        return None
    near = [f for f in outcome.level if f is not outcome.best]
    return causes_of(bench, outcome.best, outcome.acceptance, near)


def _concluded(found: ChainDiagnosis) -> ChainDiagnosis:
    """Return the diagnosis with verdict, names, reason and experiment."""
    places = found.location.places
    if short := too_few(found.contact.bench.data):
        return replace(
            found,
            finding=Finding.UNKNOWN,
            reason=f"cannot be determined: {short}",
            experiment=found.contact.found.experiment,
        )
    if not places:
        return replace(
            found,
            finding=Finding.UNKNOWN,
            reason="no free discrepancy at any link restores the chain: "
            + "; ".join(_failures(found)),
            experiment=found.contact.found.experiment,
        )
    if not places[0].links:
        return replace(
            found,
            reason="surfaces, contact law and structure explain their data, and agree",
            experiment="none required",
        )
    if len(places) > 1:
        words = " or ".join(place.words for place in places)
        return replace(
            found,
            finding=Finding.AMBIGUOUS,
            names=tuple(n for place in places for n in _rival_names(found, place)),
            reason=f"the disagreement enters at {words}: their scores are too close",
            experiment=_experiment(found, places[0].links),
        )
    links = places[0].links
    verdicts = [_verdict(found, link) for link in links]
    worst = max(verdicts, key=_SEVERITY.index)
    words = places[0].words
    basis = _basis(found, links)
    if not structure_holds(found.chain):
        basis += "; until it is mended, contact law and surfaces cannot be judged"
    return replace(
        found,
        finding=worst,
        names=_names(found, links),
        reason=f"the disagreement enters at {words}; {basis}",
        experiment=_experiment(found, links),
    )


_SEVERITY = (
    Finding.NONE,
    Finding.NAMED,
    Finding.MOSTLY,
    Finding.AMBIGUOUS,
    Finding.UNKNOWN,
)


def _failures(found: ChainDiagnosis) -> list[str]:
    """Return which links fail without any discrepancy, and why."""
    first = found.location.hypotheses[0]
    return [
        f"{link.value}: {test.reason}"
        for link, test in zip(ChainLink, first.tests, strict=True)
        if not test.passed
    ]


def _verdict(found: ChainDiagnosis, link: ChainLink) -> Finding:
    """Return the verdict of the bench of a link."""
    if link is ChainLink.SURFACE:
        # A free cut-off at surfaces that explain their own data is a name.
        own = found.chain.surface
        return Finding.NAMED if own.test.passed else own.finding
    if link is ChainLink.STRUCTURE:
        own_structure = found.chain.structure
        passed = own_structure.before.test.passed
        return Finding.UNKNOWN if passed else own_structure.finding
    if found.several is None:
        return found.contact.found.verdict
    return Finding.AMBIGUOUS if found.several.rivals else Finding.NAMED


def _names(found: ChainDiagnosis, links: tuple[ChainLink, ...]) -> tuple[str, ...]:
    names: list[str] = []
    for link in links:
        if link is ChainLink.SURFACE:
            own = found.chain.surface
            names += (
                ["scale_cut@surface"]
                if own.test.passed
                else [f"{e.name}@{e.site}" for e in own.effects]
            )
        elif link is ChainLink.STRUCTURE:
            names += [f"{e.name}@{e.site}" for e in found.chain.structure.effects]
        elif found.several is not None:
            names += [f"{cause.name}@link:joint" for cause in found.several.causes]
        else:
            names += [f"{e.name}@{e.site}" for e in found.contact.found.effects]
    return tuple(names)


def _rival_names(found: ChainDiagnosis, place: Hypothesis) -> tuple[str, ...]:
    """Return the names at a place beside others: a cut-off is one of the surface."""
    if place.links != (ChainLink.CONTACT,):
        return _names(found, place.links)
    effects = [e for e in found.contact.found.effects if e.name != CUT]
    own = tuple(f"{e.name}@{e.site}" for e in effects)
    return own or _names(found, place.links)


def _basis(found: ChainDiagnosis, links: tuple[ChainLink, ...]) -> str:
    words = []
    for link in links:
        if link is ChainLink.SURFACE:
            words.append(found.chain.surface.reason or "another cut-off restores it")
        elif link is ChainLink.STRUCTURE:
            words.append(found.chain.structure.reason)
        elif found.several is not None and len(found.several.causes) > 1:
            words.append(_together(found.several))
        else:
            words.append(found.contact.found.reason)
    return "; ".join(words)


def _together(several: SeveralCauses) -> str:
    """Return the causes that explain the joint together, and their rivals."""
    sets = [tuple(cause.name for cause in several.causes), *several.rivals]
    words = " or ".join(" + ".join(one) for one in sets).replace("_", " ")
    dof = several.bench.blocks.dof
    return f"{words}: chi2 {several.fit.cost:.1f} for {dof} values"


def _separating(several: SeveralCauses) -> str:
    """Return the experiments that separate sets of causes that fit equally well."""
    effects = {c.effect.name: c.effect for c in several.bench.candidates}
    own = {cause.name for cause in several.causes}
    steps: list[str] = []
    for rival in several.rivals:
        for name in own - set(rival):
            for other in set(rival) - own:
                step = effects[name].separates.get(other)
                step = step or effects[other].separates.get(name)
                if step is not None and step not in steps:
                    steps.append(step)
    return "; or ".join(steps)


def _experiment(found: ChainDiagnosis, links: tuple[ChainLink, ...]) -> str:
    contact = found.contact.found.experiment
    if found.several is not None and found.several.rivals:
        # What was ranked separates single effects, which do not explain the joint.
        contact = _separating(found.several) or MORE_STATES
    steps = {
        ChainLink.SURFACE: found.chain.surface.experiment,
        ChainLink.STRUCTURE: found.chain.structure.experiment,
        ChainLink.CONTACT: contact,
    }
    return "; ".join(dict.fromkeys(steps[one] for one in links if steps[one]))
