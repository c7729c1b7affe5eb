# SPDX-License-Identifier: MIT
"""Commands of the operator, carried out one by one and answered."""

from dataclasses import dataclass

from jointbench.station.measure.bench_parts import BenchParts
from jointbench.station.measure.points import Points
from jointbench.station.measure.session_record import Record
from jointbench.station.measure.trigger import TriggerWatch
from jointbench.station.session_events.command_codec import Command
from jointbench.station.session_events.command_queue import CommandRefused
from jointbench.station.session_events.flow_commands import (
    AddNote,
    ChangeSetting,
    ContinueSession,
    PauseSession,
    QuitSession,
    SeeWarnings,
)
from jointbench.station.session_events.flow_events import RunBegun
from jointbench.station.session_events.hit_commands import (
    AcceptHit,
    GoToPoint,
    NextPoint,
    RejectHit,
    RepeatPoint,
    UndoVerdict,
)
from jointbench.station.session_events.hit_events import SettingProposed
from jointbench.station.session_events.operator_events import (
    PAUSE,
    NoteAdded,
    PauseChanged,
    WarningsSeen,
)


@dataclass(slots=True)
class OperatorCommands:
    """Carries commands out.

    Attributes:
        bench: whose desk has the commands.
        record: knows what is open.
        points: the plan while it is worked off.
        trigger: pauses as well.
        paused: whether hits are ignored.
    """

    bench: BenchParts
    record: Record
    points: Points
    trigger: TriggerWatch
    paused: bool = False

    def obey(self) -> None:
        """Carry out the next command, if there is one.

        Raises:
            InstrumentError: chassis, torque tester or disk refuse.
        """
        ticket = self.bench.desk.next_command()
        if ticket is None:
            return
        try:
            words = self._carry_out(ticket.command)
        except CommandRefused as refusal:
            self.bench.desk.answer(ticket, str(refusal), done=False)
        else:
            self.bench.desk.answer(ticket, words, done=True)

    def _carry_out(self, command: Command) -> str:
        match command:
            case QuitSession(confirmed=confirmed):
                return self._quit(confirmed=confirmed)
            case AddNote(text=text):
                return self._note(text)
            case SeeWarnings():
                return self._see()
            case PauseSession():
                return self._pause()
            case ContinueSession():
                return self._continue()
            case ChangeSetting(name=name, value=value):
                return self._set(name, value)
        if self.paused:
            raise CommandRefused("the session pauses; continue first")
        return self._about_hits(command)

    def _about_hits(self, command: Command) -> str:
        points = self.points
        match command:
            case RejectHit(hit=hit):
                return points.judge(hit, accept=False)
            case AcceptHit(hit=hit):
                return points.judge(hit, accept=True)
        if points.on_trial:
            raise CommandRefused("these are trial hits, in no average")
        match command:
            case UndoVerdict():
                return points.undo()
            case RepeatPoint():
                return points.repeat()
            case NextPoint():
                return points.leave()
            case GoToPoint(point=point):
                return points.go_to(point)
        raise CommandRefused(f"{command.kind} is no command of a measurement")

    def _quit(self, *, confirmed: bool) -> str:
        left = self.points.planned - self.record.done
        if left and not confirmed:
            raise CommandRefused(
                f"{left} of {self.points.planned} conditions are open; confirm with "
                "'quit yes'"
            )
        self.record.interrupted = True
        return "the session ends"

    def _note(self, text: str) -> str:
        words = " ".join(text.split())
        if not words:
            raise CommandRefused("the note is empty")
        self.bench.desk.write(NoteAdded(words))
        return f"noted: {words}"

    def _set(self, name: str, value: float) -> str:
        words = self.points.set_elongation(name, value)
        if words is not None:
            return words
        if self.bench.hardware_trigger:
            raise CommandRefused("the device triggers; its settings are the plan's")
        proposal = self.trigger.change(name, value)
        self.bench.desk.write(
            SettingProposed(proposal.name, proposal.value, proposal.reason)
        )
        return f"{name} is {value:.4g} from now on"

    def _see(self) -> str:
        count = self.bench.desk.warned
        self.bench.desk.write(WarningsSeen(count))
        return f"{count} warnings seen"

    def _pause(self) -> str:
        if self.paused:
            raise CommandRefused("the session pauses already")
        if not self.trigger.armed:
            raise CommandRefused("the noise of the hammer is being measured; wait")
        self.paused = True
        self.trigger.break_off()
        self.bench.desk.write(PauseChanged(paused=True))
        self.bench.desk.write(RunBegun(PAUSE, PAUSE, ""))
        return "hits are ignored until the session continues"

    def _continue(self) -> str:
        if not self.paused:
            raise CommandRefused("the session does not pause")
        self.paused = False
        self.bench.desk.write(PauseChanged(paused=False))
        self.points.restart()
        return "the session continues"
