# SPDX-License-Identifier: MIT
"""Parts of a session: plan, recording, operator, desk, torque tester."""

from dataclasses import dataclass

from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.acquisition.records.recordings import Channel
from jointbench.station.measure.bolt_torques import BoltWatch
from jointbench.station.measure.observer import Operator
from jointbench.station.measure.plan import MeasurePlan
from jointbench.station.measure.session_desk import SessionDesk


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class BenchParts:
    """Everything that a session talks to.

    Attributes:
        plan: what is measured.
        recorder: process that stores every sample, and passes it on.
        channels: of its stream.
        operator: whoever strikes and tightens.
        desk: events out, commands in.
        bolts: reads the torque of every bolt; None where the plan names no tester.
        hardware_trigger: whether the device itself looks for hits after the trials.
    """

    plan: MeasurePlan
    recorder: RecorderProcess
    channels: tuple[Channel, ...]
    operator: Operator
    desk: SessionDesk
    bolts: BoltWatch | None = None
    hardware_trigger: bool = False
