# SPDX-License-Identifier: MIT
"""The hits of a session with their verdicts, and what the operator says of them.

Every verdict, first or later, goes into the file as an entry of its own; the latest
one counts, and none is ever taken out.
"""

from dataclasses import dataclass, replace

from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.acquisition.records.recordings import Hit, Verdict
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.measure.observer import Command
from jointbench.station.measure.running_average import Accepted, Spoiler
from jointbench.station.measure.session_log import hit_entry
from jointbench.station.measure.session_record import Record

_WORDS = {
    Command.ACCEPT: "accepted by the operator",
    Command.REJECT: "rejected by the operator",
    Command.UNDO: "taken back by the operator",
    Command.REPEAT: "set aside, the operator repeats the point",
}


@dataclass(frozen=True, slots=True, eq=False)
class Entered:
    """One hit in the book.

    Attributes:
        index: among all hits of the session, from 0.
        condition: number of the condition that it was struck for.
        cut: its samples.
        hit: with its latest verdict.
    """

    index: int
    condition: int
    cut: CutHit
    hit: Hit


class HitLedger:
    """Hits of the present condition and the one before, as they are judged.

    Older conditions are in the file alone: their samples would fill the memory.
    """

    def __init__(self, recorder: RecorderProcess, record: Record) -> None:
        self._recorder, self._record = recorder, record
        self._entered: list[Entered] = []
        self._said: list[Entered] = []

    @property
    def last(self) -> Entered | None:
        """The hit that the operator may still judge: the last one, trials apart."""
        return self._entered[-1] if self._entered else None

    def enter(self, hit: Hit, cut: CutHit, condition: int | None) -> None:
        """Log a new hit; None stands for a trial hit, which belongs to no condition."""
        index = len(self._record.hits)
        self._recorder.log(hit_entry(hit, number=index, new=True))
        self._record.hits.append(hit)
        if condition is not None:
            self._entered = [e for e in self._entered if e.condition >= condition - 1]
            self._entered.append(Entered(index, condition, cut, hit))
            self._said = []

    def good(self, condition: int) -> list[Accepted]:
        """Return the hits of a condition that enter its average."""
        return [Accepted(e.cut, e.hit) for e in self._good(condition)]

    def bad(self, condition: int) -> int:
        """Return how many hits of a condition do not."""
        own = [e for e in self._entered if e.condition == condition]
        return len(own) - len(self.good(condition))

    def any(self, condition: int) -> bool:
        """Return whether a condition has hits, accepted or rejected."""
        return any(e.condition == condition for e in self._entered)

    def obey(self, command: Command) -> Entered | None:
        """Accept or reject the last hit, or take the last word on it back.

        Args:
            command: `ACCEPT`, `REJECT`, or `UNDO`, which takes back the command on
                the last hit and, where nothing was, the hit itself.

        Returns:
            The last hit as it now stands, None where there is none.
        """
        last = self.last
        if last is None:
            return None
        if command is Command.UNDO and self._said:
            hit = self._said.pop().hit
        else:
            self._said.append(last)
            hit = _judged(last.hit, command)
        return self._replace(last, hit)

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
            self._replace(entered, _judged(entered.hit, Command.REPEAT))
        self._entered = [e for e in self._entered if e.condition != condition]
        self._said = []
        return len(good)

    def _good(self, condition: int) -> list[Entered]:
        own = [e for e in self._entered if e.condition == condition]
        return [e for e in own if e.hit.verdict is Verdict.OK]

    def _replace(self, entered: Entered, hit: Hit) -> Entered:
        new = replace(entered, hit=hit)
        self._recorder.log(hit_entry(hit, number=entered.index, new=False))
        self._record.hits[entered.index] = hit
        at = self._entered.index(entered)
        self._entered[at] = new
        return new


def _judged(hit: Hit, command: Command) -> Hit:
    verdict = Verdict.OK if command is Command.ACCEPT else Verdict.OPERATOR
    words = f"{_WORDS[command]}; was {hit.verdict.value}: {hit.reason}"
    return replace(hit, verdict=verdict, reason=words)
