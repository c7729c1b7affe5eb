# SPDX-License-Identifier: MIT
"""What hits mean for the plan: verdict, average, next hit, next point, and back."""

from jointbench.acquisition.records.recordings import Hit, Verdict
from jointbench.signal.frf.frf import Frf
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.measure.asking import Asker
from jointbench.station.measure.bench_checks import CheckBook
from jointbench.station.measure.bench_parts import BenchParts
from jointbench.station.measure.hit_ledger import HitLedger
from jointbench.station.measure.observer import Command, HitNews
from jointbench.station.measure.route import Route
from jointbench.station.measure.running_average import (
    GrowingAverage,
    mean_coherence,
    weak_force,
)
from jointbench.station.measure.session_log import check_entry, run_entry
from jointbench.station.measure.session_record import Record
from jointbench.station.measure.trial_hits import Trials
from jointbench.station.measure.trigger import TriggerWatch


class Points:
    """The plan while it is worked off, condition by condition."""

    def __init__(
        self, bench: BenchParts, record: Record, trigger: TriggerWatch
    ) -> None:
        self._bench, self._record, self._trigger = bench, record, trigger
        self._route = Route(bench, record)
        self._ledger = HitLedger(bench.recorder, record)
        self._asker = Asker(bench, self._route, trigger)
        self._book = CheckBook(bench.channels)
        self._trials = Trials(bench, record, trigger)
        self._average = GrowingAverage(bench.channels, bench.recorder.sample_rate)
        self.tighten, self.ask = self._route.tighten, self._asker.ask
        self.wait = self._asker.wait

    @property
    def over(self) -> bool:
        """Whether all conditions are done."""
        return self._route.over

    @property
    def on_trial(self) -> bool:
        """Whether hits are still trial hits."""
        return not self._trials.over

    def begin(self) -> None:
        """Begin a recording of the present condition, its bolts tightened.

        Raises:
            InstrumentError: torque tester or chassis do not answer.
        """
        bench, condition = self._bench, self._route.condition
        if self._route.tighten():
            self._trigger.break_off(bench.recorder.samples)
            condition = self._route.condition
        if self._trials.over and bench.hardware_trigger:
            bench.recorder.trigger_by(self._trigger.on_the_device())
            self._trigger.break_off(bench.recorder.samples)
        bench.recorder.log(run_entry(condition, trial=self.on_trial))
        self._asker.ask()

    def take(self, cut: CutHit) -> None:
        """Judge a hit, store the verdict, and continue."""
        condition = self._route.condition
        good = self._ledger.good(condition.number)
        least = weak_force(condition.level, good, self._elsewhere())
        hit = self._trigger.judge(cut, condition.point, least)
        if self.on_trial:
            self._ledger.enter(self._trials.take(cut, hit), cut, None)
            self._trials.show(cut)
            if self.on_trial:
                self._asker.ask()
            else:
                self._trials.settle()
                self.begin()
            return
        self._ledger.enter(hit, cut, condition.number)
        if hit.verdict is Verdict.OK:
            self._weed(condition.number)
        last = self._ledger.last
        self._go_on(cut, hit if last is None else last.hit)

    def _elsewhere(self) -> list[float]:
        """Return the peaks of trial hits and of good hits at any condition [N]."""
        good = [h.peak_force for h in self._record.hits if h.verdict is Verdict.OK]
        return [*self._trials.peaks, *good]

    def _weed(self, number: int) -> None:
        """Take the hit out that spoils the average, be it the last one or another."""
        spoiler = self._average.spoiler(
            self._ledger.good(number), wanted=self._bench.plan.hits.coherence
        )
        if spoiler is not None:
            index = self._ledger.take_out(number, spoiler)
            self._bench.watcher.say(f"hit {index + 1} is taken out: {spoiler.reason}")

    def obey(self, command: Command) -> None:
        """Do what the operator said."""
        watcher, condition = self._bench.watcher, self._route.condition
        if command is Command.QUIT:
            self._record.interrupted = True
        elif self.on_trial:
            watcher.say(f"{command.value}: these are trial hits, in no average")
        elif command is Command.NEXT:
            good = self._ledger.good(condition.number)
            short = len(good) < self._bench.plan.hits.repeats
            self._finish(self._average.frf(good), given_up=short)
        elif command is Command.REPEAT:
            if not self._ledger.any(condition.number):
                self._route.back()
            condition = self._route.condition
            count = self._ledger.set_aside(condition.number)
            watcher.say(f"{condition.name} again, {count} hits set aside")
            self._trigger.break_off()
            self.begin()
        else:
            self._judge_last(command)

    def _judge_last(self, command: Command) -> None:
        """Accept, reject or undo; where the point was left, go back to it."""
        last = self._ledger.obey(command)
        if last is None:
            self._bench.watcher.say(f"{command.value}: there is no hit yet")
            return
        if last.condition != self._route.condition.number:
            self._route.back()
            self.begin()
        self._go_on(last.cut, last.hit)

    def _go_on(self, cut: CutHit, hit: Hit) -> None:
        """Show the last hit, and ask for the next or go to the next condition."""
        hits, condition = self._bench.plan.hits, self._route.condition
        good = self._ledger.good(condition.number)
        frf = self._average.frf(good)
        coherence = mean_coherence(frf)
        number, count = len(self._record.hits), len(good)
        self._bench.watcher.hit(
            HitNews(number, cut, hit, condition, count, hits.repeats, frf, coherence)
        )
        agreed = coherence is None or coherence >= hits.coherence
        most = hits.most_repeats or 2 * hits.repeats
        if count >= most or (count >= hits.repeats and agreed):
            if not agreed:
                self._bench.watcher.say(
                    f"{condition.name}: coherence stays at {coherence:.3f} after "
                    f"{count} hits (limit {hits.coherence:g})"
                )
            self._finish(frf, given_up=not agreed)
        elif self._ledger.bad(condition.number) >= hits.most_rejected:
            self._bench.watcher.say(f"{condition.name}: given up, too many bad hits")
            self._finish(frf, given_up=True)
        else:
            self._asker.ask()

    def _finish(self, frf: Frf | None, *, given_up: bool) -> None:
        """Check what can be checked, and go to the next condition."""
        if frf is not None:
            for check in self._book.enter(self._route.condition, frf):
                self._record.checks.append(check)
                self._bench.recorder.log(check_entry(check))
                if not check.passed:
                    self._bench.watcher.say(f"check {check.name}: {check.words}")
        self._route.advance(given_up=given_up)
        if not self._route.over:
            self.begin()
