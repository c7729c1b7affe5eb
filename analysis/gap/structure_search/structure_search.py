# SPDX-License-Identifier: MIT
"""Search for the effect that a model of bolted bodies lacks.

The base is fitted in short windows from its nominal values, then to whole records.
Missing effects are sought in the first milliseconds, where model and measurement are in
phase and a base bounded to its priors cannot take them over. The best few are carried
to longer windows; the winner is fitted to whole records with every hit met where it
landed. Where no single effect explains the hits, a second one is sought beside it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.basics.steady_memory import (
    freed_memory_kept,
    return_freed_memory,
)
from jointbench.analysis.gap.judgement.amplitudes import (
    base_without,
    weakest_amplitude,
)
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit, without_slopes
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import cost_at, minimise
from jointbench.analysis.gap.search.screening import Screening, screen
from jointbench.analysis.gap.search.selection_round import Progress
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.base_fits import (
    base_in_whole_records,
    base_in_windows,
)
from jointbench.analysis.gap.structure_search.differences_from_base import (
    differences_from_base,
    differs,
    takes_differences,
)
from jointbench.analysis.gap.structure_search.fit_summary import fit_summary
from jointbench.analysis.gap.structure_search.found_base import FoundBase, judged_base
from jointbench.analysis.gap.structure_search.records_of_search import (
    records_of_base,
    torques_in_turn,
)
from jointbench.analysis.gap.structure_search.retuned_modes import retuned
from jointbench.analysis.gap.structure_search.second_effects import (
    explains_plainly,
    leaves_much,
    second_effects,
)
from jointbench.analysis.gap.structure_search.sensors_from_base import (
    of_table,
    sensors_from_base,
    within_tolerance,
)
from jointbench.analysis.gap.structure_search.short_windows import (
    LONGER,
    SHORT,
    carried,
    tested,
)
from jointbench.analysis.gap.structure_search.slopes_again import (
    with_covariance,
    with_slopes,
)
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_fits import (
    chi2_per_dof,
    settled,
)
from jointbench.analysis.gap.structure_search.structure_outcome import (
    StructureOutcome,
    without_effects,
)
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)
from jointbench.analysis.gap.structure_search.weak_effects import (
    WeakEffects,
    supported_fits,
    weak_effects,
)
from jointbench.analysis.gap.structure_search.whole_records import (
    JudgedFit,
    best_first,
    in_whole_records,
)

UNTESTED = Screening((), 0.0, 0.0)
"""No directed tests: a base that explains the hits needs none."""


@one_thread()
def search_structure(bench: StructureBench, progress: Progress) -> StructureOutcome:
    """Fit the base, and search for a missing effect if it does not explain the hits.

    Args:
        bench: as made, at the coarse floor.
        progress: receives one line for each step.
    """
    slopes = bench.campaign.hits.response.size * bench.base_sd.size
    if slopes > STRUCTURE_SEARCH.kept_slopes:
        return _search(bench, _tidied(progress))
    with freed_memory_kept():
        return _search(bench, progress)


def _search(bench: StructureBench, progress: Progress) -> StructureOutcome:
    """Fit the base, and search for a missing effect; see `search_structure`."""
    progress("base in short windows")
    few = bench.chosen(records_of_base(bench))
    few, start = retuned(few, base_in_windows(few), ())
    progress("base in whole records")
    bench = replace(bench, reach=STRUCTURE_SEARCH.final_reach, layout=few.layout)
    found = judged_base(*base_in_whole_records(bench, few, start))
    few = few.at(start, (), few.landing, few.table_floor)
    bench, few = (replace(one, layout=found.whole.layout) for one in (bench, few))
    weak = _weak(found, progress)
    if weak is not None and weak.fits:
        return found.weakly(weak)
    found = found.beside(weak)
    if weak is not None and weak.complete and found.first.passed:
        differing = differences_from_base(found.whole, found.base, progress)
        return _needed_from_base(found, differing, weak)
    from_base = _from_base(found, progress)
    if found.first.passed and not one_effect_takes_much(found.whole, found.base):
        return _needed_from_base(found, from_base, weak)
    return _searched(found, bench, few, start, from_base, weak, progress)


def _tidied(progress: Progress) -> Progress:
    """Return a receiver before whose lines memory of the last step is given back."""

    def receive(line: str) -> None:
        return_freed_memory()
        progress(line)

    return receive


def _weak(found: FoundBase, progress: Progress) -> WeakEffects | None:
    """Test effects that a table wrong as bodies are does not hide, where it is one."""
    if not found.whole.uncertain or found.first.excess > found.first.allowed:
        return None
    return weak_effects(found.whole, found.base, progress)


def _from_base(found: FoundBase, progress: Progress) -> list[JudgedFit]:
    """Return fits of what no modal table imitates, from a base that explains."""
    whole, base, first = found.whole, found.base, found.first
    if not whole.uncertain or first.excess > first.allowed:
        return []
    sensors = sensors_from_base(whole, base, progress)
    return [*sensors, *differences_from_base(whole, base, progress)]


def _needed_from_base(
    found: FoundBase, from_base: Sequence[JudgedFit], weak: WeakEffects | None
) -> StructureOutcome:
    """Return the outcome beside an accepted base, with what it needs."""
    tests = UNTESTED if weak is None else weak.tests
    needed = best_first([one for one in from_base if _needed(one, found.base)])
    if not needed:
        return found.nothing(tests, weak)
    if not (supported := supported_fits(needed, weak)):
        return found.doubtful(needed[0], tests)
    return found.judged(supported, tests)


def _searched(
    found: FoundBase,
    bench: StructureBench,
    few: StructureBench,
    start: FloatArray,
    from_base: Sequence[JudgedFit],
    weak: WeakEffects | None,
    progress: Progress,
) -> StructureOutcome:
    """Search for missing effects in short windows, and fit the best to all records.

    Args:
        found: base.
        bench: all records, not expanded.
        few: one record of each condition.
        start: base coordinates as fitted in short windows.
        from_base: fits of effects from the base.
        weak: tests of weak effects beside the base, where it leaves little.
        progress: receives one line for each step.
    """
    base = found.base
    progress("directed tests")
    few = few.chosen(torques_in_turn(few.campaign.hits))
    near = minimise(make_problem(few, ()), start, SHORT, iterations=8)
    screening = tested(few, near)
    singles = carried(few, near, screening, progress)
    done = in_whole_records(bench, few, base, singles, progress, from_base)
    if found.first.passed:
        done = [one for one in done if _needed(one, base)]
    if not done:
        return found.nothing(screening, weak)
    if not (supported := supported_fits(done, weak)):
        return found.doubtful(done[0], screening)
    done = supported
    # A fit from the base would lead back to it.
    if all(one.fit.candidates != done[0].fit.candidates for one in from_base):
        far_off = chi2_per_dof(found.whole, base) > STRUCTURE_SEARCH.explaining_chi2
        if complete := needless(done[0], screening, base.cost, far_off=far_off):
            return complete
    # Errors of a modal table are as large as a second effect and as manifold.
    if not bench.uncertain and leaves_much(done[0]):
        two = second_effects(bench, few, base, singles, done[0], progress)
        if two and (explains_plainly(two[0]) or not done[0].acceptance.passed):
            return found.judged(two, screening)
    return found.judged(done, screening)


def one_effect_takes_much(whole: StructureBench, base: Fit) -> bool:
    """Return whether one effect would take much of what an accepted base leaves.

    The limit of chi2 is wide, since it must hold for errors of the model. They resemble
    no effect, so one that takes a good share of them is worth a search. Marks are left
    to the mean of where hits landed. Errors of an uncertain modal table are weighed as
    what they are, so what takes more than chance would is worth a search there; what
    no table imitates has tests of its own.

    Args:
        whole: all records.
        base: fit without effects that is accepted.
    """
    own = whole.chosen(torques_in_turn(whole.campaign.hits))
    near = minimise(make_problem(own, ()), base.x, LONGER, iterations=4)
    own = own.for_tests(near, LONGER)
    single = own.addable(())
    if whole.uncertain:
        others = [c for c in single if not _tested_from_base(own, c)]
        found = screen(own, near, others, resolution=LONGER)
        return found.largest > found.threshold
    aimed = {e.effect.name for e in own.entries if e.aimed}
    linear = [
        c for c in single if c.effect.name not in aimed and not own.nonlinear((c,))
    ]
    found = screen(own, near, linear, resolution=LONGER)
    return found.largest > STRUCTURE_SEARCH.taken_share * near.chi2


def _tested_from_base(bench: StructureBench, candidate: Candidate) -> bool:
    """Return whether `_from_base` tests an effect."""
    return candidate.site.kind == "channel" or differs(bench, candidate)


def takes(bench: StructureBench, fit: Fit, base: Fit) -> bool:
    """Return whether a fit takes a good part of what the base leaves.

    Args:
        bench: of the fits.
        fit: with effects.
        base: fit without effects.
    """
    if bench.uncertain:
        if within_tolerance(bench, fit):
            return False
        least = STRUCTURE_SEARCH.uncertain_drop * of_table(bench, fit)
        return base.cost - fit.cost > least or takes_differences(bench, fit, base)
    return fit.chi2 < (1.0 - STRUCTURE_SEARCH.taken_share) * base.chi2


def _needed(one: JudgedFit, base: Fit) -> bool:
    """Return whether a fit is accepted, and takes enough beside an accepted base."""
    return one.acceptance.passed and takes(one.bench, one.fit, base)


def needless(
    best: JudgedFit,
    screening: Screening,
    ended: float = np.inf,
    *,
    far_off: bool = False,
) -> StructureOutcome | None:
    """Return the outcome without an effect where the base needs none from there.

    A fit has found the records by its base, which is a further start for the base
    alone: from its nominal values, it may have ended beside its minimum. What the base
    does not explain either is no reason to name an effect that is nearly off. With an
    uncertain table, the base may explain the hits from the fit of any effect, unless it
    was far off; but not where it leaves far more there than where it had ended.

    Args:
        best: fit with effects, the best one.
        screening: directed tests that led to it.
        ended: cost of the base where it had ended.
        far_off: whether the base was.
    """
    fit, uncertain = with_covariance(best.bench, best.fit), best.bench.uncertain
    amplitude = weakest_amplitude(fit)
    if amplitude >= STRUCTURE_SEARCH.plain_amplitude and (far_off or not uncertain):
        return None
    cost, start = _cheaper_start(best.bench, fit)
    if uncertain and cost > STRUCTURE_SEARCH.again_ratio * ended:
        return None
    del fit
    rival = None
    if uncertain and not within_tolerance(best.bench, best.fit):
        rival = best.fit.cost + STRUCTURE_SEARCH.uncertain_drop
    bench, base = settled(best.bench, start, (), near=True, rival=rival)
    if bench.uncertain and takes(bench, best.fit, base):
        return None
    if rival is not None:  # slopes of one that does not reach it are not needed
        base = without_slopes(base)  # or they are kept beside those that follow
        base = with_slopes(bench, base)
    judged = accept_structure(bench, base, base)
    nothing = amplitude < bench.policy.amplitude_limit and best.acceptance.passed
    if not (judged.passed or nothing):
        return None
    return without_effects(bench, base, judged, screening, fit_summary(bench, base))


def _cheaper_start(bench: StructureBench, fit: Fit) -> tuple[float, FloatArray]:
    """Return the cost of the base from a fit with effects, and its start there.

    The effects are left out, or taken over by the base as far as it can.
    """
    bare = make_problem(bench.at_rest(), ())
    starts = [(cost_at(bare, x, FULL), x) for x in (fit.base, base_without(fit))]
    return min(starts, key=lambda one: one[0])
