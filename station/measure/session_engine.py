# SPDX-License-Identifier: MIT
"""The session engine: it follows a recording and judges what was stored.

The engine never waits for the operator: a hit that falls while somebody reads the
screen counts like any other. What a hit means for the plan is `points`' affair.
"""

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.ni.stream import Block, StreamGap
from jointbench.station.measure.bench_parts import BenchParts
from jointbench.station.measure.cable_checks import CableWatch
from jointbench.station.measure.operator_commands import OperatorCommands
from jointbench.station.measure.points import Points
from jointbench.station.measure.session_log import gap_words
from jointbench.station.measure.session_record import Record
from jointbench.station.measure.trigger import TriggerWatch


class MeasureSession:
    """One session; `run` returns when the plan is done or the operator ends it."""

    def __init__(self, bench: BenchParts, record: Record) -> None:
        self.record = record
        self._bench = bench
        self._trigger = TriggerWatch(
            bench.plan.hits, bench.channels, bench.recorder.sample_rate
        )
        self._points = Points(bench, self.record, self._trigger)
        self._cables = CableWatch(bench.recorder, bench.desk)
        self._commands = OperatorCommands(
            bench, self.record, self._points, self._trigger
        )

    def run(self) -> None:
        """Measure until the plan is done.

        Raises:
            InstrumentError: the chassis does not come back, the disk refuses, or
                no hit comes for longer than the plan waits.
        """
        self._points.tighten()
        for item in self._bench.recorder.items():
            if self.record.interrupted:
                return
            if isinstance(item, StreamGap):
                self._gap(item)
            elif isinstance(item, Block):
                self._block(item.samples)
            elif not self._commands.paused:
                self._points.wait(item.samples)
            if not self._points.over:
                self._commands.obey()
            if self.record.interrupted or self._points.over:
                return
        self.record.interrupted = True

    def _block(self, samples: FloatArray) -> None:
        self._bench.desk.samples(samples)
        if self._cables.look(samples.shape[1]):
            self._trigger.break_off()
            if self._trigger.armed and not self._cables.open:
                self._points.ask()
        if not self._commands.paused:
            self._hear(samples)

    def _hear(self, samples: FloatArray) -> None:
        if not self._trigger.armed:
            if self._trigger.listen(samples, stored=self._bench.recorder.samples):
                self._points.begin()
            return
        cut = self._trigger.feed(samples)
        if self._cables.open:
            return
        if cut is None:
            self._points.wait(samples.shape[1])
        else:
            self._points.take(cut)

    def _gap(self, gap: StreamGap) -> None:
        """Note what is missing; a hit cut short by it is late, and asked for again."""
        self.record.gaps.append(gap)
        self._bench.desk.gap()
        self._bench.desk.warn(gap_words(gap))
        cut = self._trigger.break_off()
        if cut is not None and not self._points.on_trial:
            self._points.take(cut)
        elif self._trigger.armed and not self._commands.paused and gap.kind != "lost":
            self._points.ask()
