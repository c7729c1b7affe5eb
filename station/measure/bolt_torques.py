# SPDX-License-Identifier: MIT
"""The torque of every bolt, read from a torque tester while it is tightened.

Hands-free: the bolts are tightened in turn, and the largest reading between two rests
is what a bolt got. Every reading that counts is in the file, those set aside too.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

from jointbench.acquisition.basics.errors import FormatError, InstrumentError
from jointbench.acquisition.basics.registry import Entry
from jointbench.acquisition.serial_lines.instruments import read_torque, torque_tester
from jointbench.acquisition.serial_lines.line import SerialLine
from jointbench.acquisition.serial_lines.serial_instrument import (
    Reading,
    SerialInstrument,
)
from jointbench.station.measure.session_desk import SessionDesk
from jointbench.station.measure.session_record import Record
from jointbench.station.schemas.plan_model import TorqueTable
from jointbench.station.session_events.flow_commands import QuitSession
from jointbench.station.session_events.hit_commands import AcceptHit, UndoVerdict
from jointbench.station.session_events.hit_events import BoltRead
from jointbench.station.session_events.view_events import BoltAsked

BEGUN = 0.3
"""Share of the target from which a bolt counts as being tightened [-]."""
RELEASED = 0.5
"""Share of its largest reading below which a bolt counts as done [-]."""
NONSENSE = 10.0
"""Share of the target beyond which a reading is none: bolts break before [-]."""
_SILENCE = 1.0  # [s] after which a tester does not answer; it takes milliseconds
_RETRY = 0.2  # [s] between attempts to open a line that broke


class BoltChoice(Enum):
    """What the operator wants of the bolt that is tightened."""

    TAKE = "take"
    BACK = "back"
    QUIT = "quit"


class Surroundings(Protocol):
    """What a `BoltWatch` needs of the bench around it."""

    @property
    def desk(self) -> SessionDesk:
        """Logs readings and messages, and has the commands."""
        ...


@dataclass(slots=True)
class PeakHold:
    """From what a tester shows to the torque that a bolt was tightened to.

    Attributes:
        target: asked for [N m].
        top: largest reading since the bolt was begun, None before.
    """

    target: float
    top: Reading | None = None

    def feed(self, reading: Reading) -> Reading | None:
        """Take a reading; return the largest one once the wrench is let go."""
        value = abs(reading.value)
        if self.top is None:
            self.top = reading if value >= BEGUN * self.target else None
        elif value > abs(self.top.value):
            self.top = reading
        elif value < RELEASED * abs(self.top.value):
            done, self.top = self.top, None
            return done
        return None


@dataclass(frozen=True, slots=True, kw_only=True)
class BoltWatch:
    """A torque tester that is read bolt by bolt.

    Attributes:
        table: of the plan.
        line: name of the serial line.
        bolts: how many.
        wait: longest time for a bolt [s].
        now: clock [s].
        sleep: waits [s].
    """

    table: TorqueTable
    line: str
    bolts: int
    wait: float
    now: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep

    def tighten(
        self, target: float, bench: Surroundings, record: Record
    ) -> tuple[float, ...] | None:
        """Read the torque of every bolt while it is tightened to a target [N m].

        Args:
            target: of every bolt [N m].
            bench: its desk shows the request, and has the answers: accept takes the
                reading as it is, undo goes back to the bolt before, quit ends the
                session; the log takes every reading.
            record: says when the session was interrupted.

        Returns:
            Torque of each bolt [N m], None where the operator quits.

        Raises:
            InstrumentError: no bolt is tightened, or the tester does not answer, for
                longer than `wait`.
        """
        tester = Tester(self, torque_tester(self.table.instrument))
        try:
            return self._all(target, tester, bench, record)
        finally:
            tester.close()

    def _all(
        self, target: float, tester: "Tester", bench: Surroundings, record: Record
    ) -> tuple[float, ...] | None:
        desk = bench.desk
        found: list[float] = []
        tries = 0
        while len(found) < self.bolts:
            number = len(found) + 1
            desk.write(BoltAsked(number, self.bolts, target))
            answer = self._one(target, (number, tester), desk, record)
            if answer is BoltChoice.QUIT:
                return None
            if answer is BoltChoice.BACK:
                found, tries = found[:-1], 0
                continue
            assert isinstance(answer, Reading)
            tries += 1
            words, kept = self._weigh(answer, target, tries)
            desk.write(_bolt_read(answer, number, target, kept=kept))
            desk.say(f"bolt {number}: {answer.raw}, {words}")
            if kept:
                found, tries = [*found, abs(answer.value)], 0
        return tuple(found)

    def _weigh(self, reading: Reading, target: float, tries: int) -> tuple[str, bool]:
        """Return whether a reading is kept, in words and as such."""
        share = abs(reading.value) / target - 1
        if abs(share) <= self.table.tolerance:
            return f"{100 * share:+.1f} % of {target:g} N m", True
        words = f"{100 * share:+.1f} % beside the {target:g} N m asked for"
        if tries >= self.table.tries:
            return f"{words}; kept after {tries} tries", True
        return f"{words} (limit {100 * self.table.tolerance:g} %); once more", False

    def _one(
        self, target: float, at: "tuple[int, Tester]", desk: SessionDesk, record: Record
    ) -> Reading | BoltChoice:
        """Return the torque of one bolt, or what the operator wants instead."""
        number, tester = at
        hold, until = PeakHold(target), self.now() + self.wait
        while self.now() < until:
            reading = tester.read(desk, NONSENSE * target)
            done = None if reading is None else hold.feed(reading)
            if done is not None:
                return done
            self.sleep(_RETRY if reading is None else self.table.poll)
            choice = _bolt_choice(desk, begun=hold.top is not None)
            if choice is BoltChoice.TAKE and hold.top is not None:
                return hold.top
            if choice is BoltChoice.QUIT or record.interrupted:
                return BoltChoice.QUIT
            if choice is BoltChoice.BACK:
                return choice
        trouble = f": {tester.trouble}" if tester.trouble else ""
        raise InstrumentError(
            f"bolt {number} was not tightened within {self.wait:g} s{trouble}; what "
            "was recorded is safe, check the torque tester and measure again"
        )


@dataclass(slots=True)
class Tester:
    """A torque tester whose cable may come off and on again.

    Attributes:
        watch: that knows line and rate.
        instrument: driver of the tester.
        trouble: why it could not be read the last time, empty if it could.
    """

    watch: BoltWatch
    instrument: Entry[SerialInstrument]
    trouble: str = ""
    _line: SerialLine | None = None

    def read(self, desk: SessionDesk, most: float) -> Reading | None:
        """Return the reading, None where it cannot be read, which is reported once.

        Args:
            desk: logs the messages.
            most: beyond which no reading is believed [N m].
        """
        try:
            if self._line is None:
                baud = self.watch.table.baud or self.instrument.value.baud
                self._line = SerialLine(self.watch.line, baud=baud, timeout=_SILENCE)
            reading = _believable(read_torque(self.instrument, self._line), most)
        except (InstrumentError, FormatError) as error:
            if str(error) != self.trouble:
                desk.say(f"torque tester: {error}; waiting for it")
            self.trouble = str(error)
            self.close()
            return None
        if self.trouble:
            desk.say("torque tester: it is back")
        self.trouble = ""
        return reading

    def close(self) -> None:
        """Let go of the line."""
        if self._line is not None:
            self._line.close()
            self._line = None


def _believable(reading: Reading, most: float) -> Reading:
    """Return a reading that is a torque of at most `most` [N m].

    Raises:
        FormatError: it is a force, or beyond any torque of the plan.
    """
    if reading.kind != "torque":
        raise FormatError(
            f"the gauge answers {reading.raw!r}, a {reading.kind}; a torque is "
            "needed, plug in the torque tester or set its unit"
        )
    if abs(reading.value) > most:
        raise FormatError(
            f"the gauge answers {reading.raw!r}, {NONSENSE:g} times the target is "
            f"{most:g} N m; check its unit and the plan's torque"
        )
    return reading


def _bolt_choice(desk: SessionDesk, *, begun: bool) -> BoltChoice | None:
    """Return what the operator wants of the bolt, and answer the command."""
    ticket = desk.next_command()
    choice: BoltChoice | None = None
    match None if ticket is None else ticket.command:
        case None:
            return None
        case AcceptHit() if begun:
            choice, words = BoltChoice.TAKE, "the reading is taken as it is"
        case UndoVerdict():
            choice, words = BoltChoice.BACK, "back to the bolt before"
        case QuitSession(confirmed=True):
            choice, words = BoltChoice.QUIT, "the session ends"
        case _:
            words = "bolts are tightened now; accept, undo or quit yes"
    assert ticket is not None
    desk.answer(ticket, words, done=choice is not None)
    return choice


def _bolt_read(reading: Reading, number: int, target: float, *, kept: bool) -> BoltRead:
    return BoltRead(number, target, abs(reading.value), kept=kept, raw=reading.raw)
