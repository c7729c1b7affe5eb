# SPDX-License-Identifier: MIT
"""``jointbench doctor``: driver, devices, sensors, noise and one hit of a bench."""

import os
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, InstrumentError, UsageError
from jointbench.acquisition.ni.sensors import Sensor, table_channels
from jointbench.acquisition.ni.stream import Block, NiStream, StreamSettings
from jointbench.station.continuous.record_plan import read_record_plan
from jointbench.station.doctor.bench_finding import BenchFinding, Health, bad, good
from jointbench.station.doctor.bolt_checks import bolt_findings
from jointbench.station.doctor.device_checks import (
    OPEN_RATE,
    device_findings,
    open_inputs,
    sensor_findings,
)
from jointbench.station.doctor.hit_checks import hit_findings, no_hit
from jointbench.station.doctor.noise_checks import noise_findings
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.measure.chassis import OpenChassis, open_chassis
from jointbench.station.measure.plan import MeasurePlan, conditions, read_plan
from jointbench.station.measure.trigger import TriggerWatch
from jointbench.station.screen.terminal import console, table, write_json

BLOCK = 0.1  # [s]
ASK_EVERY = 3.0
"""Time between requests of a hit from a simulated operator [s]."""


@dataclass(frozen=True, slots=True)
class Examination:
    """What is examined, and for how long.

    Attributes:
        sensors: the channel table; empty for all inputs of the first device.
        sample_rate: [Hz]; None for what the device offers.
        plan: of hammer hits, None where there is none.
        noise_time: for the noise [s].
        hit_time: for one hit [s]; 0 to leave it out.
    """

    sensors: tuple[Sensor, ...]
    sample_rate: float | None
    plan: MeasurePlan | None
    noise_time: float
    hit_time: float


def run_doctor(
    plan_file: Path | None,
    *,
    source: str | None,
    noise_time: float,
    hit_time: float,
    json_target: str | None,
) -> tuple[BenchFinding, ...]:
    """Examine a bench and show each finding with what to do.

    Args:
        plan_file: of `measure` or `record`; None for the devices alone.
        source: URL of the chassis; None for the plan's own.
        noise_time: for the noise [s].
        hit_time: for one hit [s]; 0 to leave it out.
        json_target: where the JSON goes.

    Returns:
        The findings, good ones as well.

    Raises:
        UsageError: there is no source.
    """
    os.environ.setdefault("GRPC_VERBOSITY", "NONE")
    check_outputs([plan_file] if plan_file else [], [json_target])
    url, case = _case(plan_file, source, noise_time, hit_time)
    screen = console(json_target)
    found: list[BenchFinding] = []
    for finding in _findings(url, case):
        found.append(finding)
        if screen.is_terminal:
            screen.print(f"{finding.step}: {_of(finding)} {finding.health.value}")
    rows = [(f.step, f.what, f.health.value, f.seen) for f in found]
    screen.print(table(url, ("step", "of", "", "seen"), rows, words={0, 1, 2, 3}))
    for line in remedy_lines(found):
        screen.print(line, soft_wrap=True)
    open_ = [f for f in found if f.health is not Health.GOOD]
    words = f"{len(open_)} of {len(found)} findings need a look"
    screen.print(f"\n{words if open_ else 'all is good'}")
    write_json(json_target, {"source": url, "findings": [f.to_json() for f in found]})
    return tuple(found)


def remedy_lines(findings: Sequence[BenchFinding]) -> list[str]:
    """Return what to do, a line each; findings with one remedy share it."""
    names: dict[str, list[str]] = {}
    for finding in findings:
        if finding.remedy:
            names.setdefault(finding.remedy, []).append(finding.what.removesuffix(":"))
    return [f"{', '.join(dict.fromkeys(of))}: {remedy}" for remedy, of in names.items()]


def _of(finding: BenchFinding) -> str:
    """Return what a finding is about with its colon, which 'ni:' has already."""
    return f"{finding.what.removesuffix(':')}:"


def _case(
    plan_file: Path | None, source: str | None, noise_time: float, hit_time: float
) -> tuple[str, Examination]:
    """Return the URL and what is examined there."""
    sensors: tuple[Sensor, ...] = ()
    own, rate, plan = None, None, None
    if plan_file is not None:
        try:
            plan = read_plan(plan_file)
            own, rate = plan.table.source, plan.acquisition.sample_rate
            sensors = plan.sensors
        except BadData as no_hits:
            try:
                runs = read_record_plan(plan_file)
            except BadData:
                raise no_hits from None
            own, rate = runs.table.source, runs.table.acquisition.sample_rate
            sensors = runs.sensors
    url = source or own
    if url is None:
        raise UsageError(
            "no source: add --source ni:, ni+grpc://host:31763 or sim:plates"
        )
    hits = hit_time if plan is not None else 0.0
    return url, Examination(sensors, rate, plan, noise_time, hits)


def _findings(url: str, case: Examination) -> Iterator[BenchFinding]:
    try:
        with open_chassis(url) as opened:
            yield good("driver", url, "the driver answers")
            yield from _examined(opened, case)
    except InstrumentError as error:
        seen, _, remedy = str(error).partition("; ")
        yield bad("driver", url, seen, remedy or "check cable, power and driver")


def _examined(opened: OpenChassis, case: Examination) -> Iterator[BenchFinding]:
    chassis, sensors = opened.chassis, case.sensors
    modules = chassis.modules()
    yield from device_findings(modules)
    if not modules:
        return
    rate = case.sample_rate
    if sensors:
        assert rate is not None
        found = list(
            sensor_findings(
                chassis, sensors, sample_rate=rate, today=datetime.now(UTC).date()
            )
        )
        yield from found
        if any(f.health is Health.BAD and "change the plan" in f.remedy for f in found):
            return
    else:
        sensors = open_inputs(chassis, modules)
        rate = OPEN_RATE
    settings = StreamSettings(rate, max(1, round(BLOCK * rate)))
    with closing(NiStream(chassis, sensors, settings)) as stream:
        stream.start()
        yield from _streamed(opened, stream, case)


def _streamed(
    opened: OpenChassis, stream: NiStream, case: Examination
) -> Iterator[BenchFinding]:
    rate = stream.sample_rate
    samples = _quiet_samples(stream, round(case.noise_time * rate))
    for name in stream.open_loops():
        yield bad("noise", name, "its loop is open", "check cable, plug and sensor")
    yield from noise_findings(samples, stream.sensors, sample_rate=rate)
    if case.plan is not None:
        tables = case.plan.table.preload
        yield from bolt_findings(tables, table_channels(stream.sensors), samples)
    if case.plan is not None and case.hit_time > 0:
        yield from _one_hit(opened, stream, case)


def _quiet_samples(stream: NiStream, count: int) -> FloatArray:
    parts: list[FloatArray] = []
    for item in stream.items():
        if isinstance(item, Block):
            parts.append(item.samples)
        if sum(part.shape[1] for part in parts) >= count:
            break
    return np.hstack(parts)[:, :count]


def _one_hit(
    opened: OpenChassis, stream: NiStream, case: Examination
) -> Iterator[BenchFinding]:
    """Yield findings on the first hit; the time is that of the samples."""
    assert case.plan is not None
    channels, rate = table_channels(stream.sensors), stream.sample_rate
    trigger = TriggerWatch(case.plan.hits, channels, rate)
    condition = conditions(case.plan)[0]
    heard = asked = stored = 0
    until = time.monotonic() + case.hit_time + 60.0
    for item in stream.items():
        if not isinstance(item, Block):
            continue
        stored += item.samples.shape[1]
        if not trigger.armed:
            if trigger.listen(item.samples, stored=stored):
                opened.operator.ask(condition)
            continue
        heard += item.samples.shape[1]
        cut = trigger.feed(item.samples)
        if cut is not None:
            hit = trigger.judge(cut, condition.point, None)
            yield from hit_findings(cut, hit, channels)
            return
        if heard - asked > ASK_EVERY * rate:
            asked = heard
            opened.operator.ask(condition)
        if heard > case.hit_time * rate or time.monotonic() > until:
            yield no_hit(case.hit_time)
            return
