# SPDX-License-Identifier: MIT
"""The session engine: from a stream to judged hits, condition by condition.

Everything that arrives is stored first and judged afterwards; the plan only decides
what is asked for next. The engine never waits for the operator: a hit that falls while
somebody reads the screen counts like any other.
"""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import InstrumentError
from jointbench.acquisition.ni.stream import Block, Gap, NiStream
from jointbench.acquisition.records import Channel, Hit, Quantity, Verdict
from jointbench.acquisition.session_live import LiveSession
from jointbench.signal.frf import Frf
from jointbench.signal.hit_verdicts import HitLimits
from jointbench.signal.live_hits import CutHit, HitCutter, judge_cut
from jointbench.station.measure_average import (
    Accepted,
    average,
    mean_coherence,
    spoils,
    weak_force,
)
from jointbench.station.measure_checks import CheckBook
from jointbench.station.measure_log import (
    check_entry,
    gap_entry,
    gap_words,
    hit_entry,
    run_entry,
    setting_entry,
)
from jointbench.station.measure_plan import Condition, MeasurePlan, conditions
from jointbench.station.measure_record import Record
from jointbench.station.measure_trial import (
    Proposal,
    propose_settings,
    propose_trigger,
)
from jointbench.station.measure_watch import Command, Hand, HitNews, Watcher

LISTEN = 0.3  # [s] quiet time in which the noise of the hammer is measured
TRIAL_LENGTH = 2.0  # [s] block of a trial hit where the plan names none
ASK_AGAIN = 4.0  # [s] beyond one block without a hit, the hand is asked again
LOOK_AT_CABLES = 1.0  # [s] between looks at the sensor loops


class MeasureSession:
    """One session; `run` returns when the plan is done or the operator ends it."""

    def __init__(
        self,
        plan: MeasurePlan,
        stream: NiStream,
        live: LiveSession,
        *,
        channels: tuple[Channel, ...],
        hand: Hand,
        watcher: Watcher,
    ) -> None:
        self.record = Record()
        self._plan, self._stream, self._live = plan, stream, live
        self._channels, self._hand, self._watcher = channels, hand, watcher
        self._row = next(
            i for i, c in enumerate(channels) if c.quantity is Quantity.FORCE
        )
        self._conditions = conditions(plan)
        self._quiet: list[FloatArray] = []
        self._cutter: HitCutter | None = None
        self._trial: list[CutHit] | None = [] if plan.hits.trial_hits else None
        self._trigger = Proposal("trigger_n", plan.hits.trigger or 0.0, "of the plan")
        self._accepted: list[Accepted] = []
        self._last: Accepted | None = None
        self._rejected = 0
        self._book = CheckBook(channels)
        self._silent = 0
        self._since_look = 0
        self._open: tuple[str, ...] = ()

    def run(self) -> None:
        """Measure until the plan is done.

        Raises:
            InstrumentError: the chassis does not come back, the disk refuses, or
                nobody hits for longer than the plan waits.
        """
        for item in self._stream.items():
            if isinstance(item, Gap):
                self._gap(item)
            else:
                self._block(item)
            self._obey(self._watcher.command())
            if self.record.interrupted or self.record.done == len(self._conditions):
                return

    @property
    def _condition(self) -> Condition:
        return self._conditions[self.record.done]

    def _block(self, block: Block) -> None:
        self._live.append(block.samples, segment=block.segment, first=block.first)
        # Judged is what was stored, to the last bit.
        samples = block.samples.astype(np.float32).astype(np.float64)
        self._watcher.block(samples)
        self._look_at_cables(samples.shape[1])
        if self._cutter is None:
            self._listen(samples)
            return
        cut = self._cutter.feed(samples)
        self._silent += samples.shape[1]
        if self._open:
            return
        if cut is not None:
            self._hit(cut)
        elif self._silent > self._samples(ASK_AGAIN) + self._cutter.after:
            self._nudge()

    def _samples(self, seconds: float) -> int:
        return round(seconds * self._stream.sample_rate)

    def _listen(self, samples: FloatArray) -> None:
        """Measure the noise of the quiet hammer, then arm the trigger."""
        self._quiet.append(samples[self._row])
        force = np.concatenate(self._quiet)
        if force.size < self._samples(LISTEN):
            return
        if self._plan.hits.trigger is None:
            self._trigger = propose_trigger(force, self._channels[self._row])
        length = self._plan.hits.length or TRIAL_LENGTH
        self._cutter = HitCutter(
            row=self._row,
            level=self._trigger.value,
            before=self._samples(self._plan.hits.pretrigger),
            after=self._samples(length),
            offset=float(np.median(force)),
            origin=self._live.samples,
        )
        self._begin_run()

    def _begin_run(self) -> None:
        condition = self._condition
        self._live.log(run_entry(condition, trial=self._trial is not None))
        self._accepted, self._last, self._rejected = [], None, 0
        self._ask()

    def _ask(self) -> None:
        self._silent = 0
        self._watcher.ask(self._condition, self.record.done, len(self._conditions))
        self._hand.ask(self._condition)

    def _nudge(self) -> None:
        """Ask the hand again; give up where nobody has hit for too long."""
        if self._silent > self._samples(self._plan.hits.wait):
            raise InstrumentError(
                f"no hit for {self._plan.hits.wait:g} s at {self._condition.name!r}; "
                "what was recorded is safe: lower 'trigger', or check the hammer"
            )
        self._hand.ask(self._condition)

    def _hit(self, cut: CutHit) -> None:
        """Judge a hit, store the verdict, and go on."""
        assert self._cutter is not None
        hit = judge_cut(
            cut,
            self._channels,
            row=self._row,
            sample_rate=self._stream.sample_rate,
            point=self._condition.point,
            needed=self._cutter.after,
            limits=HitLimits(
                weak_force=weak_force(self._condition.level, self._accepted)
            ),
        )
        if self._trial is not None:
            self._take_trial(self._trial, cut, hit)
            return
        accepted = Accepted(cut, hit)
        if hit.verdict is Verdict.OK:
            worse = spoils(
                accepted,
                self._accepted,
                self._channels,
                sample_rate=self._stream.sample_rate,
                wanted=self._plan.hits.coherence,
            )
            if worse is not None:
                hit = replace(
                    hit,
                    verdict=Verdict.POOR_COHERENCE,
                    measure=worse[0],
                    reason=worse[1],
                )
        self._store(hit, number=len(self.record.hits))
        self._last = Accepted(cut, hit)
        if hit.verdict is Verdict.OK:
            self._accepted.append(self._last)
        else:
            self._rejected += 1
        self._show_and_go_on(self._last)

    def _take_trial(self, trial: list[CutHit], cut: CutHit, hit: Hit) -> None:
        """Keep a trial hit if it is fit to propose from; it enters no average."""
        if hit.verdict is Verdict.OK:
            trial.append(cut)
            hit = replace(
                hit,
                verdict=Verdict.OPERATOR,
                reason=f"trial hit, in no average; {hit.reason}",
            )
        self._store(hit, number=len(self.record.hits))
        self._watcher.hit(
            HitNews(len(self.record.hits), cut, hit, None, len(trial), 0, None, None)
        )
        if len(trial) < self._plan.hits.trial_hits:
            self._ask()
            return
        self._settle(trial)
        self._trial = None
        self._begin_run()

    def _settle(self, trial: list[CutHit]) -> None:
        """Take the proposals for whatever the plan leaves open."""
        assert self._cutter is not None
        self.record.proposals = propose_settings(
            trial,
            self._channels,
            sample_rate=self._stream.sample_rate,
            trigger=self._trigger,
        )
        for proposal in self.record.proposals:
            self._live.log(setting_entry(proposal))
            self._watcher.say(
                f"{proposal.name} {proposal.value:.4g}: {proposal.reason}"
            )
        values = {proposal.name: proposal.value for proposal in self.record.proposals}
        if self._plan.hits.trigger is None:
            self._cutter.level = values["trigger_n"]
        if self._plan.hits.length is None:
            self._cutter.after = self._samples(values["length_s"])

    def _store(self, hit: Hit, *, number: int) -> None:
        """Log a hit, new or judged again."""
        new = number == len(self.record.hits)
        self._live.log(hit_entry(hit, number=number, new=new))
        if new:
            self.record.hits.append(hit)
        else:
            self.record.hits[number] = hit

    def _show_and_go_on(self, last: Accepted) -> None:
        hits = self._plan.hits
        frf = average(self._accepted, self._channels, self._stream.sample_rate)
        coherence = mean_coherence(frf)
        self._watcher.hit(
            HitNews(
                len(self.record.hits),
                last.cut,
                last.hit,
                self._condition,
                len(self._accepted),
                hits.repeats,
                frf,
                coherence,
            )
        )
        good = len(self._accepted)
        agreed = coherence is None or coherence >= hits.coherence
        if good >= (hits.most_repeats or 2 * hits.repeats) or (
            good >= hits.repeats and agreed
        ):
            self._finish_condition(frf)
        elif self._rejected >= hits.most_rejected:
            self.record.incomplete.append(self._condition.name)
            self._watcher.say(
                f"{self._condition.name}: given up after too many bad hits"
            )
            self._finish_condition(frf)
        else:
            self._ask()

    def _finish_condition(self, frf: Frf | None) -> None:
        condition = self._condition
        if frf is not None:
            for check in self._book.enter(condition, frf):
                self.record.checks.append(check)
                self._live.log(check_entry(check))
                if not check.passed:
                    self._watcher.say(f"check {check.name}: {check.words}")
        self.record.done += 1
        if self.record.done < len(self._conditions):
            self._begin_run()

    def _gap(self, gap: Gap) -> None:
        """Note what is missing; a hit cut short by it is late, and asked for again."""
        self.record.gaps.append(gap)
        self._live.log(gap_entry(gap))
        self._watcher.say(gap_words(gap))
        cut = None if self._cutter is None else self._cutter.break_off()
        if cut is not None and self._trial is None:
            self._hit(cut)
        elif self._cutter is not None and gap.kind != "lost":
            self._ask()

    def _look_at_cables(self, count: int) -> None:
        """Pause while the loop of a sensor is open, where the device can tell."""
        self._since_look += count
        if self._since_look < self._samples(LOOK_AT_CABLES):
            return
        self._since_look = 0
        found = self._stream.open_loops()
        if found == self._open:
            return
        closed, self._open = bool(self._open) and not found, found
        words = ", ".join(found) or "all closed again"
        self._live.log({"kind": "cable", "channels": words})
        self._watcher.say(f"sensor loop open: {words}" if found else "sensors are back")
        if self._cutter is not None:
            self._cutter.break_off()
            if closed:
                self._ask()

    def _obey(self, command: Command | None) -> None:
        """Do what the operator said."""
        if command is None:
            return
        if command is Command.QUIT:
            self.record.interrupted = True
            return
        last = self._last
        if last is None:
            self._watcher.say(f"{command.value}: there is no hit at this point yet")
            return
        verdict = Verdict.OK if command is Command.ACCEPT else Verdict.OPERATOR
        hit = replace(
            last.hit,
            verdict=verdict,
            reason=f"{command.value}ed by the operator; was {last.hit.verdict.value}: "
            f"{last.hit.reason}",
        )
        number = len(self.record.hits) - 1
        self._store(hit, number=number)
        self._accepted = [a for a in self._accepted if a.hit is not last.hit]
        self._last = Accepted(last.cut, hit)
        if verdict is Verdict.OK:
            self._accepted.append(self._last)
        self._show_and_go_on(self._last)
