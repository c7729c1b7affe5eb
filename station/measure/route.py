# SPDX-License-Identifier: MIT
"""The way through the conditions of a plan, and the torque that its bolts have."""

from dataclasses import replace

from jointbench.station.measure.bench_parts import BenchParts
from jointbench.station.measure.plan import Condition, conditions
from jointbench.station.measure.session_record import Record
from jointbench.station.session_events.event_codec import to_entry
from jointbench.station.session_events.flow_events import ConditionDone


class Route:
    """Where a session is in its plan, forth and back."""

    def __init__(self, bench: BenchParts, record: Record) -> None:
        self._bench, self._record = bench, record
        self._conditions = conditions(bench.plan)
        self._tight: float | None = None
        self._mean: float | None = None

    @property
    def planned(self) -> int:
        """How many conditions there are."""
        return len(self._conditions)

    @property
    def done(self) -> int:
        """Number of completed conditions."""
        return self._record.done

    @property
    def over(self) -> bool:
        """Whether all of them are done."""
        return self._record.done == self.planned

    @property
    def condition(self) -> Condition:
        """The present one, with the torque that its bolts were found to have."""
        planned = self._conditions[self._record.done]
        joint = self._bench.plan.table.joint
        if self._mean is None or joint is None:
            return planned
        preload = joint.preload(self._mean)
        return replace(planned, tightened=self._mean, preload=preload)

    def advance(self, *, given_up: bool) -> None:
        """Leave the present condition for the next one."""
        if given_up:
            self._record.incomplete.append(self.condition.name)
        done = ConditionDone(self.condition.name, given_up)
        self._bench.recorder.log(to_entry(done))
        self._record.done += 1

    def back(self) -> None:
        """Go back to the condition before; the first one stays."""
        self._record.done = max(0, self._record.done - 1)
        name = self.condition.name
        self._record.incomplete[:] = [n for n in self._record.incomplete if n != name]

    def tighten(self) -> bool:
        """See to it that the bolts have the torque of the present condition.

        Nothing is measured meanwhile: the stream stops and restarts afterwards.

        Returns:
            Whether they were tightened just now.

        Raises:
            InstrumentError: the torque tester, or the chassis, does not answer.
        """
        bench, target = self._bench, self._conditions[self._record.done].torque
        if bench.bolts is None or target is None or target == self._tight:
            return False
        bench.recorder.pause()
        readings = bench.bolts.tighten(target, bench, self._record)
        if readings is None:
            self._record.interrupted = True
        else:
            self._tight, self._mean = target, sum(readings) / len(readings)
        bench.recorder.resume()
        return True
