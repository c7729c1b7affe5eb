# SPDX-License-Identifier: MIT
"""The log of a session: what each kind of entry says."""

from jointbench.acquisition.ni.stream import StreamGap
from jointbench.acquisition.records.recordings import Hit
from jointbench.station.measure.bench_checks import Check
from jointbench.station.measure.plan import Condition
from jointbench.station.measure.trial_settings import Proposal
from jointbench.station.session_events.event_codec import to_entry
from jointbench.station.session_events.flow_events import RunBegun
from jointbench.station.session_events.hit_events import (
    CheckDone,
    HitJudged,
    SettingProposed,
    VerdictChanged,
)

Entry = dict[str, object]


def run_entry(condition: Condition, *, trial: bool) -> Entry:
    """Return the entry that begins a recording of its own."""
    torque = condition.torque if condition.tightened is None else condition.tightened
    return to_entry(
        RunBegun(
            name="trial" if trial else condition.name,
            purpose="trial" if trial else "measurement",
            point=condition.point,
            torque=torque,
            preload=condition.preload,
            level=condition.level,
        )
    )


def hit_entry(hit: Hit, *, number: int, new: bool) -> Entry:
    """Return the entry of a hit, or of a verdict that replaces an earlier one."""
    kind = HitJudged if new else VerdictChanged
    return to_entry(
        kind(
            number=number,
            start=hit.start,
            trigger=hit.trigger,
            stop=hit.stop,
            point=hit.point,
            peak_force=hit.peak_force,
            verdict=hit.verdict.value,
            measure=hit.measure,
            reason=hit.reason,
        )
    )


def setting_entry(proposal: Proposal) -> Entry:
    """Return the entry of a setting that trial hits proposed."""
    return to_entry(SettingProposed(proposal.name, proposal.value, proposal.reason))


def check_entry(check: Check) -> Entry:
    """Return the entry of a check on the part."""
    return to_entry(CheckDone(check.name, check.value, check.limit, check.passed))


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
