# SPDX-License-Identifier: MIT
"""``jointbench measure``: a bench session by a plan, into one file."""

import uuid
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from rich.console import Console

from jointbench.acquisition.basics.errors import (
    InstrumentError,
    JointbenchError,
    UsageError,
)
from jointbench.acquisition.basics.steady_memory import keep_memory_steady
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.ni.module_limits import require_capable
from jointbench.acquisition.ni.sensor_calibration import (
    calibration_warning,
    sensor_entry,
)
from jointbench.acquisition.ni.sensors import (
    table_channels,
)
from jointbench.acquisition.ni.stream import Counters, StreamSettings
from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.acquisition.recorder.requests import Setup
from jointbench.acquisition.records.recordings import Channel, Hit, Verdict
from jointbench.acquisition.records.session import software_version
from jointbench.acquisition.session_file.finish import finish_live
from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.acquisition.session_file.live_write import channel_rows
from jointbench.station.bench_view.finishing_shown import FinishingShown
from jointbench.station.bench_view.live_view import LiveView, Viewing
from jointbench.station.bench_view.terminal_view import viewing as viewing_terminal
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.session_place import (
    Place,
    check_session_name,
    session_place,
)
from jointbench.station.measure.bench_parts import BenchParts
from jointbench.station.measure.bolt_torques import BoltWatch
from jointbench.station.measure.chassis import OpenChassis, open_chassis
from jointbench.station.measure.plan import MeasurePlan, conditions, read_plan
from jointbench.station.measure.session_desk import SessionDesk
from jointbench.station.measure.session_engine import MeasureSession
from jointbench.station.measure.session_log import session_begun
from jointbench.station.measure.session_record import Record
from jointbench.station.measure.teds_checks import (
    NO_TRIGGER,
    by_device,
    teds_serials,
    teds_warnings,
    teds_words,
)
from jointbench.station.screen.interrupt import patient_interrupt
from jointbench.station.screen.terminal import lasting_console, table, write_json
from jointbench.station.session_events.command_mailbox import CommandMailbox
from jointbench.station.session_events.command_queue import CommandQueue
from jointbench.station.sources.serial_port import line_name


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """What a session came to.

    Attributes:
        path: of the session file; beside the one asked for where an earlier session
            keeps its name.
        record: hits, gaps, proposals, checks.
        counters: what the device made against what was stored.
        planned: conditions of the plan.
        sample_rate: at which the device ran [Hz].
    """

    path: Path
    record: Record
    counters: Counters
    planned: int
    sample_rate: float

    @property
    def whole(self) -> bool:
        """Whether every condition was measured as the plan wanted."""
        return self.record.done == self.planned and not self.record.incomplete


def run_measure(
    plan_file: Path,
    out: Path,
    *,
    source: str | None,
    overwrite: bool,
    json_target: str | None,
    viewing: Viewing = viewing_terminal,
    commands: CommandQueue | None = None,
) -> Measured:
    """Measure by a plan, hands-free.

    Args:
        plan_file: TOML.
        out: session file to write.
        source: URL of the chassis; None for the plan's own.
        overwrite: replace a session that is there, once the new one is whole.
        json_target: where the JSON goes.
        viewing: opens the view of the session.
        commands: queue that other views submit to; None for the terminal's alone.

    Raises:
        UsageError: there is no source, the session is there already, is being
            recorded, or what is there is no session.
        InstrumentError: the chassis refuses or does not come back; what was recorded
            until then is in the session file.
    """
    plan = read_plan(plan_file)
    url = source or plan.table.source
    if url is None:
        raise UsageError(
            "no source: add --source ni:, ni+grpc://host:31763 or sim:plates?seed=1"
        )
    check_session_name(out)
    check_outputs([plan_file, out], [json_target])
    keep_memory_steady()
    screen = lasting_console(json_target)
    with session_place(out, overwrite=overwrite) as place:
        with _naming_file(place, screen), open_chassis(url) as opened:
            with viewing(screen, place.own) as view:
                measured = measure(plan, opened, place.own, view, commands)
        measured = replace(measured, path=place.settle(whole=measured.whole))
        write_json(json_target, _summary(measured))
        _show(measured, screen)
        if measured.path != out:
            screen.print(place.stays, soft_wrap=True)
    return measured


@contextmanager
def _naming_file(place: Place, screen: Console) -> Iterator[None]:
    """On an error, name the file that holds what was recorded."""
    try:
        yield
    except BaseException:
        if place.stays and place.own.exists():
            screen.print(place.stays, soft_wrap=True)
        raise


def measure(
    plan: MeasurePlan,
    opened: OpenChassis,
    out: Path,
    view: LiveView,
    commands: CommandQueue | None = None,
) -> Measured:
    """Record a session into `out` and finish its file, come what may.

    Args:
        plan: what is measured.
        opened: chassis.
        out: new file.
        view: on this computer.
        commands: queue that other views submit to; None for the view's alone.

    Raises:
        InstrumentError: the chassis refuses or does not come back, or the disk is
            full; the file holds what was recorded until then.
    """
    limits = opened.chassis.limits()
    require_capable(plan.sensors, limits, plan.acquisition.sample_rate)
    serials = teds_serials(opened.chassis, plan.sensors)
    warnings = _warnings(plan, opened, serials)
    record = Record()
    with patient_interrupt(record):
        try:
            with RecorderProcess(
                _setup(plan, opened), given_up=lambda: record.interrupted
            ) as recorder:
                desk = SessionDesk(
                    recorder,
                    view,
                    commands or CommandQueue(),
                    mailbox=CommandMailbox(out),
                )
                _record(plan, opened, out, (desk, warnings, record), serials)
        except BaseException:
            # What went wrong first is what the operator has to know.
            with suppress(JointbenchError):
                if out.exists() and not is_held(out):
                    finish_session(out)
            raise
        finish_session(out, FinishingShown(view))
    return Measured(
        out, record, recorder.counters, len(conditions(plan)), recorder.sample_rate
    )


def _setup(plan: MeasurePlan, opened: OpenChassis) -> Setup:
    acquisition = plan.acquisition
    settings = StreamSettings(
        sample_rate=acquisition.sample_rate,
        block=round(acquisition.block * acquisition.sample_rate),
        buffer=acquisition.buffer,
        patience=acquisition.patience,
    )
    return Setup(opened.chassis.address, plan.sensors, settings)


def finish_session(path: Path, progress: Callable[[float], None] | None = None) -> None:
    """Turn the file of a recording into a finished session, compressed, in its place.

    Until the new file is whole and on the disk, the old one stays.

    Args:
        path: of the file.
        progress: called with the share that is written [-].

    Raises:
        InstrumentError: there is no room for it; the recording is safe as it is.
    """
    try:
        finish_live(path, path, overwrite=True, progress=progress)
    except UsageError as error:
        raise InstrumentError(
            f"'{path}' could not be finished ({error}); what was recorded is safe in "
            "it: make room, then `jointbench recover` it"
        ) from error


def _record(
    plan: MeasurePlan,
    opened: OpenChassis,
    out: Path,
    running: tuple[SessionDesk, tuple[str, ...], Record],
    serials: Mapping[str, str | None],
) -> None:
    desk, warnings, record = running
    recorder = desk.recorder
    channels = table_channels(plan.sensors)
    with _torque_tester(plan) as bolts:
        recorder.begin(out, _meta(plan, opened, channels, recorder.sample_rate))
        session = MeasureSession(
            BenchParts(
                plan=plan,
                recorder=recorder,
                channels=channels,
                operator=opened.operator,
                desk=desk,
                bolts=bolts,
                hardware_trigger=by_device(plan, opened.chassis),
            ),
            record,
        )
        try:
            desk.write(
                session_begun(
                    plan,
                    channels,
                    source=opened.name,
                    simulated=opened.simulated,
                    sample_rate=recorder.sample_rate,
                    teds=teds_words(serials, plan.sensors),
                )
            )
            for sensor in plan.sensors:
                desk.log(sensor_entry(sensor))
            for words in warnings:
                desk.warn(words)
            session.run()
        except KeyboardInterrupt:
            record.interrupted = True
        try:
            recorder.stop(interrupted=record.interrupted)
        finally:
            # The session may have ended before the last ones were reported.
            record.gaps = recorder.gaps
            desk.leave(read_log(out)[0])


@contextmanager
def _torque_tester(plan: MeasurePlan) -> Iterator[BoltWatch | None]:
    """Give what reads the bolts, None where the plan names no tester."""
    torque, joint = plan.table.torque, plan.table.joint
    if torque is None or joint is None:
        yield None
        return
    with line_name(torque.line) as name:
        yield BoltWatch(table=torque, line=name, bolts=joint.bolts, wait=plan.hits.wait)


def _warnings(
    plan: MeasurePlan, opened: OpenChassis, serials: Mapping[str, str | None]
) -> tuple[str, ...]:
    today = datetime.now(UTC).date()
    old = (calibration_warning(sensor, today) for sensor in plan.sensors)
    expired = (words for words in old if words is not None)
    asked = plan.acquisition.trigger == "hardware"
    trigger = asked and not by_device(plan, opened.chassis)
    return (
        *expired,
        *teds_warnings(serials, plan.sensors),
        *((NO_TRIGGER,) if trigger else ()),
    )


def _meta(
    plan: MeasurePlan, opened: OpenChassis, channels: tuple[Channel, ...], rate: float
) -> dict[str, object]:
    table_ = plan.table
    notes = [table_.notes]
    if table_.temperature:
        notes.append(f"temperature {table_.temperature}")
    torques = plan.hits.torques
    return {
        "uuid": str(uuid.uuid4()),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "software": software_version(),
        "operator": table_.operator,
        "notes": "; ".join(note for note in notes if note),
        "source": opened.name,
        "simulated": opened.simulated,
        "sample_rate": rate,
        "torque": torques[0] if len(torques) == 1 else None,
        "plan": plan.text,
        "channels": channel_rows(channels),
    }


def _show(measured: Measured, screen: Console) -> None:
    counts = _counts(measured.record.hits)
    rows = [
        ("hits", ", ".join(f"{n} {word}" for word, n in counts.items()) or "none"),
        ("conditions", f"{measured.record.done} of {measured.planned}"),
        ("samples per channel", f"{measured.counters.delivered}"),
        ("lost samples", _lost(measured)),
        (
            "interruptions",
            f"{sum(g.kind in ('back', 'rearmed') for g in measured.record.gaps)}",
        ),
    ]
    screen.print(table(f"{measured.path}", ("session", "holds"), rows))
    for check in measured.record.checks:
        word = "good" if check.passed else "LOOK AT IT"
        screen.print(f"check {check.name}: {word}, {check.words}", soft_wrap=True)
    screen.print(f"\nnext: jointbench modal {measured.path}")


def _lost(measured: Measured) -> str:
    """Return the lost samples, and the gaps that they are in."""
    counted, gaps = measured.counters.lost, measured.record.gaps
    holes = sum(gap.samples > 0 for gap in gaps)
    return f"{counted}" if not counted else f"{counted}, in {holes} gaps"


def _counts(hits: list[Hit]) -> dict[str, int]:
    found = Counter(hit.verdict for hit in hits)
    return {verdict.value: found[verdict] for verdict in Verdict if found[verdict]}


def _summary(measured: Measured) -> dict[str, object]:
    record, counters = measured.record, measured.counters
    return {
        "session": str(measured.path),
        "complete": measured.whole,
        "hits": [
            {
                "number": number,
                "time_s": hit.trigger / measured.sample_rate,
                "point": hit.point,
                "peak_n": hit.peak_force,
                "verdict": hit.verdict.value,
                "measure": hit.measure,
                "reason": hit.reason,
            }
            for number, hit in enumerate(record.hits, 1)
        ],
        "verdicts": {v.value: _counts(record.hits).get(v.value, 0) for v in Verdict},
        "lost_samples": counters.lost,
        "acquired_samples": counters.acquired,
        "unread_samples": counters.unread,
        "stored_samples": counters.delivered,
        "gaps": [
            {
                "kind": g.kind,
                "segment": g.segment,
                "first_sample": g.first,
                "samples": g.samples,
                "seconds": g.seconds,
                "words": g.words,
            }
            for g in record.gaps
        ],
        "settings": {p.name: p.value for p in record.proposals},
        "checks": [
            {"name": c.name, "value": c.value, "limit": c.limit, "passed": c.passed}
            for c in record.checks
        ],
        "incomplete": list(record.incomplete),
        "interrupted": record.interrupted,
    }
