# SPDX-License-Identifier: MIT
"""The hits of a session with their verdicts, and what the operator says of them.

Every verdict, first or later, goes into the file as an entry of its own; the latest
one counts, and none is ever taken out.
"""

from dataclasses import dataclass, replace

from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.acquisition.records.recordings import Hit, Verdict
from jointbench.station.measure.running_average import Accepted, Spoiler
from jointbench.station.measure.session_desk import SessionDesk
from jointbench.station.measure.session_log import hit_judged
from jointbench.station.measure.session_record import Record
from jointbench.station.measure.stored_cut import StoredCut

_ACCEPTED = "accepted by the operator"
_REJECTED = "rejected by the operator"
_TAKEN_BACK = "taken back by the operator"
_SET_ASIDE = "set aside, the operator repeats the point"


@dataclass(frozen=True, slots=True, eq=False)
class Entered:
    """One hit in the book.

    Attributes:
        index: among all hits of the session, from 0.
        condition: number of the condition that it was struck for.
        cut: its samples, in the file.
        hit: with its latest verdict.
    """

    index: int
    condition: int
    cut: StoredCut
    hit: Hit


class HitLedger:
    """Hits of the present condition and the one before, as they are judged.

    Their samples are in the file alone: they would fill the memory.
    """

    def __init__(
        self, desk: SessionDesk, recorder: RecorderProcess, record: Record
    ) -> None:
        self._desk, self._recorder, self._record = desk, recorder, record
        self._entered: list[Entered] = []
        self._said: list[Entered] = []
        self._conditions: list[int | None] = []

    @property
    def last(self) -> Entered | None:
        """The hit struck last, trial hits apart; None if its condition is older."""
        return self._in_memory(self.struck_last)

    @property
    def struck_last(self) -> int:
        """Index of the hit struck last, trial hits apart; -1 before the first one."""
        struck = (n for n, c in enumerate(self._conditions) if c is not None)
        return max(struck, default=-1)

    def enter(self, hit: Hit, condition: int | None) -> None:
        """Log a new hit; None stands for a trial hit, which belongs to no condition."""
        index = len(self._record.hits)
        self._desk.write(hit_judged(hit, number=index, new=True))
        self._record.hits.append(hit)
        self._conditions.append(condition)
        if condition is not None:
            self._entered.append(Entered(index, condition, self._stored(hit), hit))
            self._said = []

    def keep(self, conditions: tuple[int, int]) -> None:
        """Keep the hits of two conditions in memory, without their samples.

        Args:
            conditions: the present one and the one before.
        """
        self._entered = [e for e in self._entered if e.condition in conditions]
        present = conditions[0]
        if not self.any(present):
            self._entered[:0] = [
                Entered(index, present, self._stored(hit), hit)
                for index, hit in enumerate(self._record.hits)
                if self._conditions[index] == present and hit.verdict is Verdict.OK
            ]

    def condition_of(self, index: int) -> int | None:
        """Return the condition that a hit was struck for, None for a trial hit."""
        return self._conditions[index]

    def good(self, condition: int) -> list[Accepted]:
        """Return the hits of a condition that enter its average."""
        return [Accepted(e.cut, e.hit) for e in self._good(condition)]

    def count_good(self, condition: int) -> int:
        """Return how many hits of any condition are good, in memory or not."""
        return sum(
            own == condition and hit.verdict is Verdict.OK
            for own, hit in zip(self._conditions, self._record.hits, strict=True)
        )

    def bad(self, condition: int) -> int:
        """Return how many hits of a condition do not."""
        own = [e for e in self._entered if e.condition == condition]
        return len(own) - len(self.good(condition))

    def any(self, condition: int) -> bool:
        """Return whether a condition has hits in memory, accepted or rejected."""
        return any(e.condition == condition for e in self._entered)

    def judge(self, index: int, *, accept: bool) -> None:
        """Accept or reject a hit, whenever it was struck."""
        words = _ACCEPTED if accept else _REJECTED
        hit = _judged(self._record.hits[index], words, accept=accept)
        entered = self._in_memory(index)
        if entered is None:
            self._log(index, hit)
            return
        if entered is self.last:
            self._said.append(entered)
        self._replace(entered, hit)

    def undo(self, last: Entered) -> None:
        """Undo the last decision on the last hit; without one, take the hit out."""
        if self._said:
            hit = self._said.pop().hit
        else:
            self._said.append(last)
            hit = _judged(last.hit, _TAKEN_BACK)
        self._replace(last, hit)

    def take_out(self, condition: int, spoiler: Spoiler) -> int:
        """Judge a good hit of a condition again: it spoils the average of the others.

        Args:
            condition: number of the condition.
            spoiler: counts its position among the good hits.

        Returns:
            Its index among all hits of the session.
        """
        entered = self._good(condition)[spoiler.position]
        hit = replace(
            entered.hit,
            verdict=Verdict.POOR_COHERENCE,
            measure=spoiler.together,
            reason=spoiler.reason,
        )
        self._replace(entered, hit)
        return entered.index

    def set_aside(self, condition: int) -> int:
        """Take the good hits of a condition out of its average; return how many."""
        good = self._good(condition)
        for entered in good:
            self._replace(entered, _judged(entered.hit, _SET_ASIDE))
        self._entered = [e for e in self._entered if e.condition != condition]
        self._said = []
        return len(good)

    def _good(self, condition: int) -> list[Entered]:
        own = [e for e in self._entered if e.condition == condition]
        return [e for e in own if e.hit.verdict is Verdict.OK]

    def _in_memory(self, index: int) -> Entered | None:
        return next((e for e in self._entered if e.index == index), None)

    def _stored(self, hit: Hit) -> StoredCut:
        count, trigger = hit.stop - hit.start, hit.trigger - hit.start
        return StoredCut(self._recorder, hit.start, count, trigger)

    def _replace(self, entered: Entered, hit: Hit) -> None:
        self._log(entered.index, hit)
        at = self._entered.index(entered)
        self._entered[at] = replace(entered, hit=hit)

    def _log(self, index: int, hit: Hit) -> None:
        self._desk.write(hit_judged(hit, number=index, new=False))
        self._record.hits[index] = hit


def _judged(hit: Hit, words: str, *, accept: bool = False) -> Hit:
    verdict = Verdict.OK if accept else Verdict.OPERATOR
    return replace(
        hit,
        verdict=verdict,
        reason=f"{words}; was {hit.verdict.value}: {hit.reason}",
    )
