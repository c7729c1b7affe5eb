# SPDX-License-Identifier: MIT
"""Trial hits: kept in the file, in no average; the settings come of them."""

from dataclasses import dataclass, field, replace

from jointbench.acquisition.records.recordings import Hit, Verdict
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.measure.bench_parts import BenchParts
from jointbench.station.measure.hit_sketch import hit_averaged
from jointbench.station.measure.session_record import Record
from jointbench.station.measure.trigger import TriggerWatch
from jointbench.station.session_events.hit_events import SettingProposed


@dataclass(slots=True)
class Trials:
    """Trial hits until there are enough.

    Attributes:
        bench: of the session.
        record: takes the proposals.
        trigger: takes the settings.
        peaks: of the trial hits that were fit to propose from [N].
    """

    bench: BenchParts
    record: Record
    trigger: TriggerWatch
    peaks: list[float] = field(default_factory=list)
    _fit: list[CutHit] = field(default_factory=list)

    @property
    def over(self) -> bool:
        """Whether there are enough, or none are wanted."""
        return len(self._fit) >= self.bench.plan.hits.trial_hits

    def take(self, cut: CutHit, hit: Hit) -> Hit:
        """Keep a trial hit if it is fit to propose from; return it as it is stored."""
        if hit.verdict is not Verdict.OK:
            return hit
        self._fit.append(cut)
        self.peaks.append(hit.peak_force)
        reason = f"trial hit, in no average; {hit.reason}"
        return replace(hit, verdict=Verdict.OPERATOR, reason=reason)

    def show(self, cut: CutHit) -> None:
        """Show the trial hit that was entered last."""
        hits, wanted = self.record.hits, self.bench.plan.hits.trial_hits
        self.bench.desk.write(
            hit_averaged(
                len(hits) - 1,
                (len(self._fit), wanted),
                cut,
                None,
                channels=self.bench.channels,
                sample_rate=self.bench.recorder.sample_rate,
                trial=True,
            )
        )

    def settle(self) -> None:
        """Propose settings with reasons, and use those that the plan leaves open."""
        self.record.proposals = self.trigger.settle(self._fit)
        for proposal in self.record.proposals:
            self.bench.desk.write(
                SettingProposed(proposal.name, proposal.value, proposal.reason)
            )
