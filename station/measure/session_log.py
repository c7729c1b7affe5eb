# SPDX-License-Identifier: MIT
"""Events of a measurement, made from its records."""

from collections.abc import Mapping, Sequence

from jointbench.acquisition.ni.stream import StreamGap
from jointbench.acquisition.records.recordings import Channel, Hit, Quantity
from jointbench.station.measure.plan import Condition, MeasurePlan, conditions
from jointbench.station.session_events.flow_events import RunBegun
from jointbench.station.session_events.hit_events import HitJudged, VerdictChanged
from jointbench.station.session_events.view_events import SessionBegun


def run_begun(condition: Condition, *, trial: bool) -> RunBegun:
    """Return the event that begins a recording of its own."""
    torque = condition.torque if condition.tightened is None else condition.tightened
    return RunBegun(
        name="trial" if trial else condition.name,
        purpose="trial" if trial else "measurement",
        point=condition.point,
        torque=torque,
        preload=condition.preload,
        level=condition.level,
    )


def hit_judged(hit: Hit, *, number: int, new: bool) -> HitJudged:
    """Return the event of a hit, or of a verdict that replaces an earlier one."""
    kind = HitJudged if new else VerdictChanged
    return kind(
        number=number,
        start=hit.start,
        trigger=hit.trigger,
        stop=hit.stop,
        point=hit.point,
        peak_force=hit.peak_force,
        verdict=hit.verdict.value,
        measure=hit.measure,
        reason=hit.reason,
        temperature=hit.temperature,
    )


def session_begun(
    plan: MeasurePlan,
    channels: Sequence[Channel],
    *,
    source: str,
    simulated: bool,
    sample_rate: float,
    teds: Mapping[str, str],
) -> SessionBegun:
    """Return the event that states what is known before the first sample.

    Args:
        plan: what is measured.
        channels: of the stream.
        source: URL of the chassis.
        simulated: whether it is a simulation.
        sample_rate: of the device [Hz].
        teds: what the sensor of each channel says of itself, for people.
    """
    hammer = next(c for c in channels if c.quantity is Quantity.FORCE)
    return SessionBegun(
        operator=plan.table.operator,
        source=source,
        simulated=simulated,
        sample_rate=sample_rate,
        direction=hammer.direction,
        repeats=plan.hits.repeats,
        channels=[
            {"name": c.name, "range": c.range, "teds": teds.get(c.name, "")}
            for c in channels
        ],
        conditions=[
            {"name": c.name, "point": c.point, "torque": c.torque, "level": c.level}
            for c in conditions(plan)
        ],
    )


def gap_words(gap: StreamGap) -> str:
    """Return a gap in one line for the operator."""
    if gap.kind == "lost":
        return f"connection lost, waiting for it: {gap.words}"
    if gap.kind == "back":
        return f"connection is back after {gap.seconds:.2f} s; the gap is noted"
    if gap.kind == "rearmed":
        return (
            f"the device stopped and was started again, {gap.samples} samples lost and "
            f"{gap.seconds:.2f} s without any; the gap is noted ({gap.words})"
        )
    return f"overrun: {gap.samples} samples lost; the gap is noted"
