# SPDX-License-Identifier: MIT
"""The base of bolted bodies, and the outcomes to which it leads."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.model.effect import words_of
from jointbench.analysis.gap.residuals.fit_records import Fit, without_slopes
from jointbench.analysis.gap.search.screening import Screening
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.fit_summary import FitSummary, fit_summary
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_outcome import (
    StructureOutcome,
    compared,
    without_effects,
)
from jointbench.analysis.gap.structure_search.weak_effects import WeakEffects
from jointbench.analysis.gap.structure_search.whole_records import (
    JudgedFit,
    first_with_slopes,
)


@dataclass(frozen=True, slots=True, eq=False)
class FoundBase:
    """The fit without effects.

    Attributes:
        whole: all records, on which it was found.
        base: fit, without its slopes, which take a gigabyte.
        first: its acceptance.
        before: its gap and parameters.
    """

    whole: StructureBench
    base: Fit
    first: Acceptance
    before: FitSummary

    def beside(self, weak: WeakEffects | None) -> "FoundBase":
        """Return the base, with a channel that errors of bodies explain.

        Errors of residues are taken as of one size in all channels, so a channel where
        they are larger stands out.

        Args:
            weak: tests of weak effects, where the base leaves little.
        """
        if weak is None or self.first.passed or not weak.explains:
            return self
        base = self.base
        first = accept_structure(self.whole, base, base, channels=False)
        return replace(self, first=first)

    def complete(self, screening: Screening) -> StructureOutcome:
        """Return the outcome that nothing is missing, or that nothing was found.

        Args:
            screening: directed tests.
        """
        return without_effects(
            self.whole, self.base, self.first, screening, self.before
        )

    def judged(
        self, done: Sequence[JudgedFit], screening: Screening
    ) -> StructureOutcome:
        """Return the outcome with fits of effects.

        Args:
            done: fits at rest, best first.
            screening: directed tests that led to them.
        """
        outcome = compared(self.complete(screening).outcome, done)
        return StructureOutcome(outcome, done[0].bench, self.whole, self.before)

    def nothing(
        self, screening: Screening, weak: WeakEffects | None
    ) -> StructureOutcome:
        """Return the outcome without an effect, refused where one is suspected.

        Args:
            screening: directed tests.
            weak: tests of weak effects, where the base leaves little.
        """
        if weak is None or weak.suspected is None:
            return self.complete(screening)
        words = words_of((weak.suspected,))
        return self._refused(
            screening,
            f"beside errors that a body's modal table has, {words} explains part of "
            "what is left, and nothing all of it",
        )

    def _refused(self, screening: Screening, reason: str) -> StructureOutcome:
        """Return the outcome that the base does not explain the hits after all."""
        none = self.complete(screening)
        refused = replace(self.first, passed=False, reason=reason, unexplained=True)
        return replace(none, outcome=replace(none.outcome, acceptance=refused))

    def doubtful(self, best: JudgedFit, screening: Screening) -> StructureOutcome:
        """Return the outcome that an effect fits the hits where it should not.

        Args:
            best: fit that tests of weak effects do not support.
            screening: directed tests that led to it.
        """
        words = words_of(best.fit.candidates)
        return self._refused(
            screening,
            f"{words} fits them only beside errors that no body's modal table has",
        )

    def weakly(self, weak: WeakEffects) -> StructureOutcome:
        """Return the outcome with weak effects, ranked by the costs of their tests.

        Args:
            weak: tests, with accepted fits.
        """
        best, *_ = first_with_slopes(weak.fits)
        fits = (best.fit, *(one.fit for one in weak.fits[1:]))
        none = self.complete(weak.tests).outcome
        outcome = replace(
            none,
            bench=best.bench,
            base=replace(self.base, cost=weak.cost),
            best=best.fit,
            acceptance=best.acceptance,
            ranked=fits,
            level=fits,
        )
        return StructureOutcome(outcome, best.bench, self.whole, self.before)


def judged_base(whole: StructureBench, base: Fit) -> FoundBase:
    """Return the base with its acceptance.

    Args:
        whole: all records, on which it was found.
        base: fit with its slopes.
    """
    first, before = accept_structure(whole, base, base), fit_summary(whole, base)
    return FoundBase(whole.at_rest(), without_slopes(base), first, before)
