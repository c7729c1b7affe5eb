"""A second view that joins mid-session, and one that opens what a kill left."""

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.ni.sensors import Axis, Sensor, table_channels
from jointbench.acquisition.ni.stream import Block
from jointbench.acquisition.ni.stream_records import StreamSettings
from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.acquisition.recorder.requests import Setup
from jointbench.acquisition.records.recordings import Quantity
from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.acquisition.session_file.live_write import channel_rows
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis
from jointbench.station.bench_view.live_view import LiveView
from jointbench.station.measure.session_desk import SessionDesk
from jointbench.station.session_events.command_codec import Command
from jointbench.station.session_events.event_codec import Event, Stamped, from_log
from jointbench.station.session_events.flow_events import Asked, RunBegun, Warned
from jointbench.station.session_events.hit_events import HitJudged, VerdictChanged
from jointbench.station.session_events.session_state import SessionState, state_after

HAMMER = Sensor(
    "f", Quantity.FORCE, "1", (Axis("cDAQSim1Mod1/ai0", "+z", 2.25e-3),), "N", 2e3
)
FIRST: tuple[Event, ...] = (
    RunBegun("point 1", "measurement", "1", 20.0),
    Asked("point 1", "1", 0, 2),
    HitJudged(0, 0, 10, 90, "1", 150.0, "ok", 0.0, "single clean pulse"),
    Warned("force drifts"),
)
LATER: tuple[Event, ...] = (
    VerdictChanged(0, 0, 10, 90, "1", 150.0, "operator", 0.0, "rejected"),
    HitJudged(1, 100, 110, 190, "1", 140.0, "ok", 0.0, "single clean pulse"),
)
JOIN = """
import sys
from pathlib import Path
from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.station.session_events.event_codec import from_log
from jointbench.station.session_events.session_state import SessionState, state_after
print(state_after(SessionState(), from_log(read_log(Path(sys.argv[1]))[0])))
"""


class First(LiveView):
    """The view of the measuring process."""

    def __init__(self) -> None:
        self.state = SessionState()

    def follow(self, events: Sequence[Stamped]) -> None:
        """Take note of events."""
        self.state = state_after(self.state, events)

    def level(self, samples: np.ndarray) -> None:
        """Show nothing."""

    def command(self) -> Command | None:
        """Ask for nothing."""
        return None


def show(desk: SessionDesk, view: First, events: Sequence[Event], last: int) -> None:
    """Write events and wait until the view has them."""
    for event in events:
        desk.write(event)
    for item in desk.recorder.items():
        desk.attend()
        if isinstance(item, Block) and view.state.last == last:
            return


@pytest.mark.skipif(sys.platform == "win32", reason="signals: POSIX")
def test_a_second_view_and_a_reopened_kill_show_what_the_first_view_showed(
    tmp_path: Path,
) -> None:
    """Another process joins after four events; two more follow, then a kill."""
    path, view = tmp_path / "s.h5", First()
    meta = {
        "sample_rate": 12_800.0,
        "simulated": True,
        "channels": channel_rows(table_channels((HAMMER,))),
    }
    with SimulatedChassis(ChassisSetup(speed=np.inf)) as server:
        setup = Setup(server.address, (HAMMER,), StreamSettings(12_800.0, 640))
        with RecorderProcess(setup) as recorder:
            recorder.begin(path, meta)
            desk = SessionDesk(recorder, view)
            show(desk, view, FIRST, 3)
            second = subprocess.run(
                [sys.executable, "-c", JOIN, str(path)],
                capture_output=True,
                text=True,
                check=True,
            ).stdout.strip()
            assert second == str(view.state)
            show(desk, view, LATER, 5)
            os.kill(recorder.process_id, signal.SIGKILL)
    reopened = state_after(SessionState(), from_log(read_log(path)[0]))
    assert reopened == view.state
    assert [hit.verdict for hit in reopened.hits.values()] == ["operator", "ok"]
