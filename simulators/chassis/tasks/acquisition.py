# SPDX-License-Identifier: MIT
"""A running task: its clock, its triggers, its buffer and its read position."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal
from jointbench.simulators.chassis.tasks.edge_search import EdgeSearch
from jointbench.simulators.chassis.tasks.trigger_plan import TriggerPlan

_LONGEST_SLEEP = 0.02  # [s] between polls of the clock
_FAST_SLEEP = 1e-3  # [s] between searches of a chassis that runs as it is read
_NEVER = 2**63
# Samples searched for a trigger before a read's time-out is checked.
_SEARCH = 4096

# First sample and number of samples to volts, shape (n_channels, n).
Volts = Callable[[int, int], FloatArray]


@dataclass(frozen=True, slots=True)
class Pace:
    """Time base of the chassis.

    Attributes:
        speed: seconds of signal per second, infinite for as fast as it is read.
        now: clock [s].
        sleep: waits [s].
    """

    speed: float = 1.0
    now: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """What a started task does.

    Attributes:
        rate: of the sample clock [Hz].
        finite: samples of a block, None for a continuous task.
        buffer: samples kept until they are read.
        overwrites: a full buffer loses its oldest samples instead of stopping.
        triggers: of the task.
        clocked: it has a clock; without one every read takes new samples.
    """

    rate: float
    finite: int | None
    buffer: int
    overwrites: bool = False
    triggers: TriggerPlan = field(default_factory=TriggerPlan)
    clocked: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Patience:
    """How long a call waits.

    Attributes:
        timeout: [s]; below zero for no limit.
        alive: whether the client is still there.
    """

    timeout: float
    alive: Callable[[], bool] = lambda: True


class ClientGone(Exception):
    """The client of a waiting call has disconnected."""


class Acquisition:
    """Samples of one start of a task, counted from its start trigger."""

    def __init__(self, course: Course, pace: Pace, volts: Volts) -> None:
        self.course = course
        self._volts = volts
        self._pace = pace if course.clocked else Pace(math.inf, pace.now, pace.sleep)
        self._started = pace.now()
        self._position = 0
        self._skipped = 0
        self._looked = 1
        self._origin: int | None = 0 if course.triggers.start is None else None
        self._failed = False
        open_end = course.finite is None or course.triggers.reference is not None
        again = course.triggers.retriggers
        self._end = _NEVER if open_end or again else int(course.finite or 0)

    @property
    def position(self) -> int:
        """Next sample that a read returns."""
        return self._position

    @property
    def end(self) -> int | None:
        """Sample after the last one, None while it is not known."""
        return None if self._end == _NEVER else self._end

    @property
    def fast(self) -> bool:
        """Whether samples are made as they are read."""
        return math.isinf(self._pace.speed)

    def acquired(self) -> int:
        """Return how many samples per channel the converter has made so far."""
        if self._failed:
            return self._position
        if self.fast:
            searching = self.course.triggers.reference is not None
            looked = self._looked - 1 if searching else 0
            return min(max(self._position, self._skipped, looked), self._end)
        if self._origin is None and not self._triggered():
            return 0
        return min(max(0, self._elapsed() - (self._origin or 0)), self._end)

    def _elapsed(self) -> int:
        """Return how many samples the converter has made since the start."""
        elapsed = (self._pace.now() - self._started) * self._pace.speed
        return int(elapsed * self.course.rate)

    def skip_to(self, sample: int) -> None:
        """Advance the converter to a sample, read or not."""
        self._skipped = max(self._skipped, sample)

    def done(self) -> bool:
        """Return whether the last sample was made; a task without a clock has none."""
        if not self.course.clocked or self._failed:
            return True
        self._triggered()
        return self._end != _NEVER and (self.fast or self.acquired() >= self._end)

    def await_end(self, waiting: Patience) -> None:
        """Wait for the last sample.

        Raises:
            Refusal: it does not come in time, as in a continuous task.
            ClientGone: the client has disconnected.
        """
        deadline = self._deadline(waiting)
        while not self.done():
            if self._pace.now() >= deadline:
                raise Refusal(
                    DAQmxErrors.WAIT_UNTIL_DONE_DOES_NOT_INDICATE_DONE,
                    "Wait Until Done did not indicate that the task was done within "
                    "the specified timeout.\n\nIncrease the timeout, check the "
                    "program, and if appropriate, stop the task.",
                )
            self._sleep(_LONGEST_SLEEP, waiting)

    def read(self, count: int, waiting: Patience, *, first: int | None) -> FloatArray:
        """Wait for samples and return them [V], shape (n_channels, at most count).

        Fewer are returned only at the end of a finite task.

        Args:
            count: samples per channel.
            waiting: for how long.
            first: sample to begin at, None for the read position.

        Raises:
            Refusal: they do not come in time, are overwritten, or never come.
            ClientGone: the client has disconnected.
        """
        deadline = self._deadline(waiting)
        self._await_triggers(deadline, waiting)
        begin = self._position if first is None else first
        count = self._left(begin, count)
        self._await_samples(begin + count, deadline, waiting)
        if self.course.buffer and self.course.finite is None and self.course.clocked:
            self._require_kept(begin)
        samples = self._volts(begin + (self._origin or 0), count)
        self._position = begin + count
        return samples

    def _deadline(self, waiting: Patience) -> float:
        return self._pace.now() + (
            waiting.timeout if waiting.timeout >= 0 else math.inf
        )

    def _sleep(self, seconds: float, waiting: Patience) -> None:
        if not waiting.alive():
            raise ClientGone
        self._pace.sleep(seconds)

    def _left(self, begin: int, count: int) -> int:
        """Return how many of some samples there will ever be.

        Raises:
            Refusal: none.
        """
        left = min(count, self._end - begin)
        if left <= 0 < count:
            raise Refusal(
                DAQmxErrors.SAMPLES_WILL_NEVER_BE_AVAILABLE,
                "Attempted to read a sample beyond the final sample acquired.\n\n"
                "The sample requested will never be available. The acquisition has "
                "stopped, therefore the sample specified by the combination of "
                "position and offset will never be available.",
                read=0,
            )
        return left

    def _require_kept(self, first: int) -> None:
        """Refuse samples that are no longer in the buffer.

        Source:
            NI-DAQmx properties, OverWrite Mode.
        """
        if first >= self.acquired() - self.course.buffer:
            return
        if self.course.overwrites:
            raise Refusal(
                DAQmxErrors.SAMPLES_NO_LONGER_AVAILABLE,
                "The application is not able to keep up with the hardware "
                "acquisition: samples were overwritten before they were read.",
                read=0,
            )
        self._failed = True
        raise Refusal(
            DAQmxErrors.ACQ_STOPPED_TO_PREVENT_INPUT_BUFFER_OVERWRITE,
            "Acquisition has been stopped to prevent an input buffer overwrite.",
            read=0,
        )

    def _await_samples(self, need: int, deadline: float, waiting: Patience) -> None:
        while not self.fast:
            missing = (need - self.acquired()) / (self.course.rate * self._pace.speed)
            left = deadline - self._pace.now()
            if missing <= 0:
                return
            if left <= 0 or self._failed:
                raise not_yet()
            self._sleep(min(max(missing, 1e-3), left, _LONGEST_SLEEP), waiting)

    def _await_triggers(self, deadline: float, waiting: Patience) -> None:
        while not self._triggered():
            if self._pace.now() >= deadline:
                raise not_yet()
            self._sleep(_FAST_SLEEP if self.fast else _LONGEST_SLEEP, waiting)

    def _triggered(self) -> bool:
        """Search the new samples; return True once all triggers have come."""
        triggers = self.course.triggers
        if self._origin is None and triggers.start is not None:
            self._origin = self._look(triggers.start, least=0)
            self._looked = 1
        if self._origin is None:
            return False
        if triggers.reference is not None and self._end == _NEVER:
            found = self._look(triggers.reference, least=triggers.before)
            if found is not None and self.course.finite is not None:
                self._position = found - triggers.before
                self._end = self._position + self.course.finite
            return found is not None
        return True

    def _look(self, search: EdgeSearch, *, least: int) -> int | None:
        """Return the sample of a trigger, counted from the origin so far."""
        made = self._elapsed() - (self._origin or 0) if not self.fast else 0
        reach = self._looked + _SEARCH if self.fast else made
        if reach <= self._looked:
            return None
        first = self._looked - 1
        reach = min(reach, first + 64 * _SEARCH)
        volts = self._volts(first + (self._origin or 0), reach - first)
        found = search.first(volts, least=max(0, least - first))
        self._looked = reach
        return None if found is None else first + found


def not_yet() -> Refusal:
    """Return the refusal of samples that did not come in time."""
    return Refusal(
        DAQmxErrors.SAMPLES_NOT_YET_AVAILABLE,
        "Some or all of the samples requested have not yet been acquired.\n\n"
        "To wait for the samples to become available use a longer read timeout or "
        "read later in your program. To make the samples available sooner, increase "
        "the sample rate. If your task uses a start trigger, make sure that your "
        "start trigger is configured correctly. It is also possible that you "
        "configured the task for external timing, and no clock was supplied. If this "
        "is the case, supply an external clock.",
        read=0,
    )
