# SPDX-License-Identifier: MIT
"""Check that all sensors are still connected, where the device supports it."""

from dataclasses import dataclass, field

from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.station.measure.session_desk import SessionDesk
from jointbench.station.session_events.flow_events import CableChanged

LOOK_AT_CABLES = 1.0  # [s] of signal between looks at the sensor loops


@dataclass(slots=True)
class CableWatch:
    """Check the sensor loops periodically, and report changes.

    Attributes:
        recorder: that knows the device.
        desk: logs a change and the messages.
        open: channels whose loop is open.
    """

    recorder: RecorderProcess
    desk: SessionDesk
    open: tuple[str, ...] = field(default=())
    _since: int = 0

    def look(self, count: int) -> bool:
        """Look, where it is time to; True where the loops changed.

        Args:
            count: samples since this was called last.
        """
        self._since += count
        if self._since < LOOK_AT_CABLES * self.recorder.sample_rate:
            return False
        self._since = 0
        found = self.recorder.open_loops()
        if found == self.open:
            return False
        self.open = found
        words = ", ".join(found)
        self.desk.write(CableChanged(words or "all closed again"))
        self.desk.say(
            f"sensor loop open: {words}; hits wait until the cable is back"
            if found
            else "sensors are back"
        )
        return True
