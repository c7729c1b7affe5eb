# SPDX-License-Identifier: MIT
"""The way through the conditions of a plan, and the torque that its bolts have."""

from dataclasses import replace

from jointbench.station.measure.bench_parts import BenchParts
from jointbench.station.measure.plan import Condition, conditions
from jointbench.station.measure.session_record import Record
from jointbench.station.session_events.flow_events import ConditionDone
from jointbench.station.session_events.operator_events import ConditionReopened


class Route:
    """Where a session is in its plan, forth and back."""

    def __init__(self, bench: BenchParts, record: Record) -> None:
        self._bench, self._record = bench, record
        self._conditions = conditions(bench.plan)
        self._at = 0
        self._before: int | None = None
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
    def kept(self) -> tuple[int, int]:
        """Numbers of the present condition and the one before it."""
        return self._at, self._at if self._before is None else self._before

    @property
    def condition(self) -> Condition:
        """The present one, with the torque that its bolts were found to have."""
        planned = self._conditions[self._at]
        joint = self._bench.plan.table.joint
        if self._mean is None or joint is None:
            return planned
        preload = joint.preload(self._mean)
        return replace(planned, tightened=self._mean, preload=preload)

    def advance(self, *, given_up: bool) -> None:
        """Leave the present condition for the next one that is open."""
        if given_up:
            self._record.incomplete.append(self.condition.name)
        self._bench.desk.write(ConditionDone(self.condition.name, given_up))
        self._record.finished.add(self._at)
        following = [*range(self._at + 1, self.planned), *range(self._at)]
        left = [n for n in following if n not in self._record.finished]
        self._before = self._at
        self._at = left[0] if left else self._at

    def back(self) -> None:
        """Go back to the condition before; the first one stays."""
        self.go_to(self._at if self._before is None else self._before)

    def go_to(self, number: int) -> None:
        """Go to a condition; one that was over is open again."""
        self.reopen(number)
        if number != self._at:
            self._before, self._at = self._at, number

    def reopen(self, number: int) -> None:
        """Take note that a condition needs hits, if it was over."""
        if number not in self._record.finished:
            return
        name = self._conditions[number].name
        self._record.finished.discard(number)
        self._record.incomplete[:] = [n for n in self._record.incomplete if n != name]
        self._bench.desk.write(ConditionReopened(name))

    def at_point(self, point: str) -> int | None:
        """Return the condition of a point at the present torque and level, if any."""
        now = self._conditions[self._at]
        same = (c for c in self._conditions if c.point == point)
        near = sorted(
            same, key=lambda c: (c.torque != now.torque, c.level != now.level)
        )
        return near[0].number if near else None

    @property
    def points(self) -> tuple[str, ...]:
        """Points of the plan."""
        return tuple(dict.fromkeys(c.point for c in self._conditions))

    def tighten(self) -> bool:
        """See to it that the bolts have the torque of the present condition.

        Nothing is measured meanwhile: the stream stops and restarts afterwards.

        Returns:
            Whether they were tightened just now.

        Raises:
            InstrumentError: the torque tester, or the chassis, does not answer.
        """
        bench, target = self._bench, self._conditions[self._at].torque
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
