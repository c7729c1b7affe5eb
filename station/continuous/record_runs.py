# SPDX-License-Identifier: MIT
"""``jointbench record PLAN.toml``: timed runs of any channels, into one session."""

import uuid
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from jointbench.acquisition.basics.errors import JointbenchError, UsageError
from jointbench.acquisition.basics.steady_memory import keep_memory_steady
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.ni.module_limits import require_capable
from jointbench.acquisition.ni.sensor_calibration import (
    calibration_warning,
)
from jointbench.acquisition.ni.sensors import table_channels
from jointbench.acquisition.ni.stream import Block, Counters, StreamGap, StreamSettings
from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.acquisition.recorder.requests import Setup
from jointbench.acquisition.records.session import software_version
from jointbench.acquisition.session_file.finish import finish_live
from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.acquisition.session_file.live_write import channel_rows
from jointbench.station.bench_view.finishing_shown import FinishingShown
from jointbench.station.bench_view.live_view import LiveView
from jointbench.station.bench_view.terminal_view import viewing
from jointbench.station.continuous.channel_checks import ChannelChecks
from jointbench.station.continuous.record_plan import (
    RecordPlan,
    RunTable,
    read_record_plan,
)
from jointbench.station.continuous.run_commands import obey_next
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.session_place import check_session_name, session_place
from jointbench.station.measure.chassis import OpenChassis, open_chassis
from jointbench.station.measure.session_desk import SessionDesk
from jointbench.station.measure.session_log import gap_words
from jointbench.station.measure.teds_checks import teds_serials, teds_warnings
from jointbench.station.screen.interrupt import patient_interrupt
from jointbench.station.screen.terminal import lasting_console, table, write_json
from jointbench.station.session_events.command_mailbox import CommandMailbox
from jointbench.station.session_events.flow_events import ConditionDone, RunBegun
from jointbench.station.session_events.view_events import SessionBegun


@dataclass(slots=True)
class RunsRecord:
    """What a recording amounts to so far.

    Attributes:
        done: names of the runs that came to their end.
        cut_short: names of those that the operator ended.
        overloaded: names of channels by the name of the run.
        interrupted: whether the operator ended the recording.
        next_run: whether the operator ended the present run.
        counters: what the device made against what was stored.
    """

    done: list[str] = field(default_factory=list)
    cut_short: list[str] = field(default_factory=list)
    overloaded: dict[str, list[str]] = field(default_factory=dict)
    interrupted: bool = False
    next_run: bool = False
    counters: Counters = field(default_factory=Counters)


def run_record_plan(
    plan_file: Path,
    out: Path,
    *,
    source: str | None,
    overwrite: bool,
    json_target: str | None,
) -> bool:
    """Record the runs of a plan.

    Args:
        plan_file: TOML.
        out: session file to write.
        source: URL of the chassis; None for the plan's own.
        overwrite: replace a session that is there, once the new one is whole.
        json_target: where the JSON goes.

    Returns:
        Whether all runs were recorded to their end without an overload.

    Raises:
        UsageError: there is no source, or the session is there already.
        InstrumentError: the chassis refuses or does not come back; what was recorded
            until then is in the session file.
    """
    plan = read_record_plan(plan_file)
    url = source or plan.table.source
    if url is None:
        raise UsageError(
            "no source: add --source ni:, ni+grpc://host:31763 or sim:spindle?seed=1"
        )
    check_session_name(out)
    check_outputs([plan_file, out], [json_target])
    keep_memory_steady()
    screen, record = lasting_console(json_target), RunsRecord()
    with session_place(out, overwrite=overwrite) as place:
        with open_chassis(url) as opened, viewing(screen, place.own) as view:
            record_plan(plan, opened, place.own, view, record)
        whole = not record.interrupted and not record.cut_short
        path = place.settle(whole=whole)
    rows = [
        ("runs", ", ".join(record.done) or "none"),
        ("ended early", ", ".join(record.cut_short) or "none"),
        ("overloaded", _overload_words(record) or "none"),
        ("samples per channel", f"{record.counters.delivered}"),
        ("lost samples", f"{record.counters.lost}"),
    ]
    screen.print(table(f"{path}", ("session", "holds"), rows))
    screen.print(f"\nnext: {_next_words(plan, path)}", soft_wrap=True)
    write_json(json_target, _summary(path, record))
    return whole and not record.overloaded


def record_plan(
    plan: RecordPlan,
    opened: OpenChassis,
    out: Path,
    view: LiveView,
    record: RunsRecord,
) -> None:
    """Record the runs of a plan into a file and finish it, come what may.

    Raises:
        InstrumentError: the chassis refuses or does not come back, or the disk is
            full; the file holds what was recorded until then.
    """
    acquisition = plan.table.acquisition
    require_capable(plan.sensors, opened.chassis.limits(), acquisition.sample_rate)
    warnings = tuple(_warnings(plan, opened))
    settings = StreamSettings(
        sample_rate=acquisition.sample_rate,
        block=round(acquisition.block * acquisition.sample_rate),
        buffer=acquisition.buffer,
        patience=acquisition.patience,
    )
    setup = Setup(opened.chassis.address, plan.sensors, settings)
    with patient_interrupt(record):
        try:
            with RecorderProcess(
                setup, given_up=lambda: record.interrupted
            ) as recorder:
                _record(plan, opened, out, (recorder, view, warnings), record)
            record.counters = recorder.counters
        except BaseException:
            # What went wrong first is what the operator has to know.
            with suppress(JointbenchError):
                if out.exists() and not is_held(out):
                    finish_live(out, out, overwrite=True)
            raise
        finish_live(out, out, overwrite=True, progress=FinishingShown(view))


def _record(
    plan: RecordPlan,
    opened: OpenChassis,
    out: Path,
    running: tuple[RecorderProcess, LiveView, tuple[str, ...]],
    record: RunsRecord,
) -> None:
    recorder, view, warnings = running
    desk = SessionDesk(recorder, view, mailbox=CommandMailbox(out))
    recorder.begin(out, _meta(plan, opened, recorder.sample_rate))
    desk.write(
        SessionBegun(
            operator=plan.table.operator,
            source=opened.name,
            simulated=opened.simulated,
            sample_rate=recorder.sample_rate,
            direction="",
            repeats=0,
            channels=[
                {"name": c.name, "range": c.range} for c in table_channels(plan.sensors)
            ],
        )
    )
    for words in warnings:
        desk.warn(words)
    try:
        _runs(plan, desk, record)
    except KeyboardInterrupt:
        record.interrupted = True
    recorder.stop(interrupted=record.interrupted)
    desk.leave(read_log(out)[0])


def _runs(plan: RecordPlan, desk: SessionDesk, record: RunsRecord) -> None:
    """Record one run after the other; the stream is never stopped between them."""
    recorder = desk.recorder
    items = recorder.items()
    channels = table_channels(plan.sensors)
    for run in plan.table.runs:
        desk.write(_begun(run))
        checks = ChannelChecks(channels)
        until = recorder.samples + round(run.duration * recorder.sample_rate)
        while recorder.samples < until and not record.next_run:
            item = next(items, None)
            if item is None:
                record.interrupted = True
            elif isinstance(item, Block):
                desk.samples(item.samples)
                for words in checks.feed(item.samples):
                    desk.warn(f"{run.name}: {words}")
            elif isinstance(item, StreamGap):
                desk.gap()
                desk.warn(gap_words(item))
            obey_next(desk, record)
            if record.interrupted:
                break
        _finish_run(run, desk, checks, record)
        if record.interrupted:
            return


def _finish_run(
    run: RunTable, desk: SessionDesk, checks: ChannelChecks, record: RunsRecord
) -> None:
    for words in checks.dead():
        desk.warn(f"{run.name}: {words}")
    if checks.overloaded:
        record.overloaded[run.name] = checks.overloaded
    early = record.interrupted or record.next_run
    record.next_run = False
    (record.cut_short if early else record.done).append(run.name)
    desk.write(ConditionDone(run.name, early))


def _begun(run: RunTable) -> RunBegun:
    return RunBegun(
        name=run.name,
        purpose=run.kind.value,
        point="",
        torque=run.torque,
        duration=run.duration,
    )


def _warnings(plan: RecordPlan, opened: OpenChassis) -> Iterator[str]:
    today = datetime.now(UTC).date()
    for sensor in plan.sensors:
        words = calibration_warning(sensor, today)
        if words is not None:
            yield words
    yield from teds_warnings(teds_serials(opened.chassis, plan.sensors), plan.sensors)


def _meta(plan: RecordPlan, opened: OpenChassis, rate: float) -> dict[str, object]:
    torques = {run.torque for run in plan.table.runs}
    return {
        "uuid": str(uuid.uuid4()),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "software": software_version(),
        "operator": plan.table.operator,
        "notes": plan.table.notes,
        "source": opened.name,
        "simulated": opened.simulated,
        "sample_rate": rate,
        "torque": torques.pop() if len(torques) == 1 else None,
        "plan": plan.text,
        "channels": channel_rows(table_channels(plan.sensors)),
    }


def _next_words(plan: RecordPlan, path: Path) -> str:
    kinds = {run.kind.value for run in plan.table.runs}
    if "shaker" in kinds:
        return f"jointbench modal {path}"
    if "operating" in kinds:
        return f"jointbench modal {path} --output-only"
    return f"jointbench inspect {path}"


def _overload_words(record: RunsRecord) -> str:
    return "; ".join(f"{run}: {', '.join(n)}" for run, n in record.overloaded.items())


def _summary(path: Path, record: RunsRecord) -> dict[str, object]:
    counters = record.counters
    return {
        "session": str(path),
        "runs": list(record.done),
        "ended_early": list(record.cut_short),
        "overloaded": dict(record.overloaded),
        "interrupted": record.interrupted,
        "lost_samples": counters.lost,
        "acquired_samples": counters.acquired,
        "stored_samples": counters.delivered,
    }
