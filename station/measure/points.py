# SPDX-License-Identifier: MIT
"""What hits mean for the plan: verdict, average, next hit, next point, and back."""

import re
from dataclasses import asdict, replace

from jointbench.acquisition.file_access.quoting import shown
from jointbench.acquisition.records.recordings import Verdict
from jointbench.signal.frf.frf import Frf
from jointbench.signal.frf.further_hits import further_hits
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.bolts.bolt_forces import BoltForces, hit_temperature
from jointbench.station.measure.asking import Asker
from jointbench.station.measure.bench_checks import CheckBook
from jointbench.station.measure.bench_parts import BenchParts
from jointbench.station.measure.hit_ledger import HitLedger
from jointbench.station.measure.hit_sketch import hit_averaged
from jointbench.station.measure.route import Route
from jointbench.station.measure.running_average import (
    GrowingAverage,
    mean_coherence,
    weak_force,
)
from jointbench.station.measure.session_log import run_begun
from jointbench.station.measure.session_record import Record
from jointbench.station.measure.stored_cut import HitCut
from jointbench.station.measure.trial_hits import Trials
from jointbench.station.measure.trigger import TriggerWatch
from jointbench.station.session_events.command_queue import CommandRefused
from jointbench.station.session_events.hit_events import CheckDone, GainForecast

_ELONGATION = re.compile(r"elongation_(\d{1,4})_um")
_MICROMETRE = 1e-6  # [m]
_MORE = 2
"""Further hits that a forecast is made for."""


class Points:
    """The plan while it is worked off, condition by condition."""

    def __init__(
        self, bench: BenchParts, record: Record, trigger: TriggerWatch
    ) -> None:
        self._bench, self._record, self._trigger = bench, record, trigger
        self._route = Route(bench, record)
        self._ledger = HitLedger(bench.desk, bench.recorder, record)
        self._asker = Asker(bench, self._route, trigger)
        self._book = CheckBook(bench.channels)
        self._trials = Trials(bench, record, trigger)
        joint = bench.plan.table.joint
        self._forces = BoltForces(
            bench.plan.table.preload,
            bench.channels,
            None if joint is None else joint.bolts,
        )
        self._torque: float | None = None
        self._average = GrowingAverage(bench.channels, bench.recorder.sample_rate)
        self.tighten, self.ask = self._route.tighten, self._asker.ask
        self.wait = self._asker.wait

    @property
    def over(self) -> bool:
        """Whether all conditions are done."""
        return self._route.over

    @property
    def planned(self) -> int:
        """How many conditions there are."""
        return self._route.planned

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
        self._ledger.keep(self._route.kept)
        if condition.torque != self._torque:
            self._forces.loosen()
            self._torque = condition.torque
        bench.desk.write(run_begun(condition, trial=self.on_trial))
        self._asker.ask()

    def take(self, cut: CutHit) -> None:
        """Judge a hit, store the verdict, and continue."""
        condition = self._route.condition
        good = self._ledger.good(condition.number)
        least = weak_force(condition.level, good, self._elsewhere())
        hit = self._trigger.judge(cut, condition.point, least)
        samples = cut.samples
        warmth = hit_temperature(self._bench.channels, samples)
        hit = replace(hit, temperature=warmth)
        self._forces.hit(samples)
        if self.on_trial:
            self._ledger.enter(self._trials.take(cut, hit), None)
            self._trials.show(cut)
            if self.on_trial:
                self._asker.ask()
            else:
                self._trials.settle()
                self.begin()
            return
        self._ledger.enter(hit, condition.number)
        if hit.verdict is Verdict.OK:
            self._weed(condition.number)
        self._go_on(cut)

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
            self._bench.desk.say(f"hit {index + 1} is taken out: {spoiler.reason}")

    def judge(self, number: int | None, *, accept: bool) -> str:
        """Accept or reject a hit; where the last one ended a point, go back to it.

        Args:
            number: of the hit from 1, None for the last one.
            accept: True to accept it.

        Returns:
            What was done.

        Raises:
            CommandRefused: there is no such hit, or it is a trial hit.
        """
        struck_last = self._ledger.struck_last
        index = struck_last if number is None else number - 1
        condition = self._condition_of(index)
        wanted = Verdict.OK if accept else Verdict.OPERATOR
        if self._record.hits[index].verdict is wanted:
            raise CommandRefused(f"hit {index + 1} has the verdict {wanted.value}")
        self._ledger.judge(index, accept=accept)
        words = f"hit {index + 1} is {'accepted' if accept else 'rejected'}"
        if index == struck_last:
            self._return_to(condition)
        elif condition == self._route.condition.number:
            self._go_on(None)
        elif self._ledger.count_good(condition) < self._bench.plan.hits.repeats:
            self._route.reopen(condition)
            words += ", its point needs one more"
        return words

    def undo(self) -> str:
        """Undo the last decision on the last hit; return what was done.

        Raises:
            CommandRefused: there is no hit yet.
        """
        last = self._ledger.last
        if last is None:
            raise CommandRefused("there is no hit to undo")
        self._ledger.undo(last)
        self._return_to(last.condition)
        return f"hit {last.index + 1} is {self._record.hits[last.index].verdict.value}"

    def leave(self) -> str:
        """Go to the next point; return what was done."""
        condition = self._route.condition
        good = self._ledger.good(condition.number)
        short = len(good) < self._bench.plan.hits.repeats
        self._finish(self._average.frf(good), given_up=short)
        return f"{condition.name} {'is left incomplete' if short else 'is done'}"

    def repeat(self) -> str:
        """Set the hits of the point aside and ask for it again; return it in words."""
        if not self._ledger.any(self._route.condition.number):
            self._route.back()
            self._ledger.keep(self._route.kept)
        condition = self._route.condition
        count = self._ledger.set_aside(condition.number)
        self.restart()
        return f"{condition.name} again, {count} hits set aside"

    def go_to(self, point: str) -> str:
        """Go to a point of the plan; return what was done.

        Raises:
            CommandRefused: the plan has no such point.
        """
        number = self._route.at_point(point)
        if number is None:
            points = ", ".join(self._route.points)
            raise CommandRefused(
                f"the plan has no point {shown(point)}; it has {points}"
            )
        self._route.go_to(number)
        self.restart()
        return f"{self._route.condition.name} is next"

    def set_elongation(self, name: str, length: float) -> str | None:
        """Take the elongation of a bolt that the operator read; return what was done.

        Args:
            name: of the setting, ``elongation_3_um`` for bolt 3.
            length: [um].

        Returns:
            None where the setting is another one.

        Raises:
            CommandRefused: the plan states no stiffness for this bolt.
        """
        match = _ELONGATION.fullmatch(name)
        if match is None:
            return None
        bolt = int(match[1])
        found = self._forces.elongation(bolt, length * _MICROMETRE)
        if found is None:
            raise CommandRefused(
                f"bolt {bolt} has no stiffness in the plan, or has a channel; state "
                "stiffness = '350 N/um' in its [[preload]]"
            )
        return (
            f"bolt {bolt}: {length:g} um, {found.force / 1e3:.4g} kN "
            f"(sd {found.force_sd / 1e3:.2g} kN)"
        )

    def restart(self) -> None:
        """Begin a recording again, after a pause or at another point.

        The samples of a pause are stored, and the trigger was not fed with them.
        """
        self._trigger.break_off(self._bench.recorder.samples)
        if not self._route.over:
            self.begin()

    def _condition_of(self, index: int) -> int:
        count = len(self._record.hits)
        if index < 0 and not count:
            raise CommandRefused("there is no hit yet")
        if not 0 <= index < count:
            raise CommandRefused(f"there is no hit {index + 1}; {count} were struck")
        condition = self._ledger.condition_of(index)
        if condition is None:
            raise CommandRefused(f"hit {index + 1} is a trial hit, in no average")
        return condition

    def _return_to(self, condition: int) -> None:
        """Show the last hit again; where its point was left, go back to it."""
        if condition != self._route.condition.number:
            self._route.go_to(condition)
            self.begin()
        last = self._ledger.last
        self._go_on(None if last is None else last.cut)

    def _go_on(self, cut: HitCut | None) -> None:
        """Show the last hit, if any, and ask for the next or go to the next point."""
        hits, condition = self._bench.plan.hits, self._route.condition
        good = self._ledger.good(condition.number)
        frf = self._average.frf(good)
        coherence = mean_coherence(frf)
        count = len(good)
        if cut is not None:
            self._show(cut, frf, count)
        agreed = coherence is None or coherence >= hits.coherence
        most = hits.most_repeats or 2 * hits.repeats
        if count >= most or (count >= hits.repeats and agreed):
            if not agreed:
                self._bench.desk.warn(
                    f"{condition.name}: coherence stays at {coherence:.3f} after "
                    f"{count} hits (limit {hits.coherence:g})"
                )
            self._finish(frf, given_up=not agreed)
        elif self._ledger.bad(condition.number) >= hits.most_rejected:
            self._bench.desk.warn(f"{condition.name}: given up, too many bad hits")
            self._finish(frf, given_up=True)
        else:
            self._asker.ask()

    def _show(self, cut: HitCut, frf: Frf | None, count: int) -> None:
        bench = self._bench
        bench.desk.write(
            hit_averaged(
                self._ledger.last.index if self._ledger.last else 0,
                (count, bench.plan.hits.repeats),
                cut,
                frf,
                channels=bench.channels,
                sample_rate=bench.recorder.sample_rate,
            )
        )

        forecast = () if frf is None else further_hits(frf, more=_MORE)
        if forecast:
            hit = self._ledger.last.index if self._ledger.last else 0
            peaks = [asdict(peak) for peak in forecast]
            bench.desk.write(GainForecast(hit, _MORE, peaks))

    def _finish(self, frf: Frf | None, *, given_up: bool) -> None:
        """Check what can be checked, and go to the next condition."""
        if frf is not None:
            for check in self._book.enter(self._route.condition, frf):
                self._record.checks.append(check)
                self._bench.desk.write(
                    CheckDone(check.name, check.value, check.limit, check.passed)
                )
                if not check.passed:
                    self._bench.desk.warn(f"check {check.name}: {check.words}")
        condition = self._route.condition
        read = self._forces.preload(condition.name, condition.torque)
        if read is not None:
            self._bench.desk.write(read)
        self._route.advance(given_up=given_up)
        if not self._route.over:
            self.begin()
