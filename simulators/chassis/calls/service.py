# SPDX-License-Identifier: MIT
"""The complete service: NI's calls for analogue input, and the faults of a script.

Every other call gets gRPC's answer "unimplemented", as from an older server.
"""

from jointbench.simulators.chassis.calls.attribute_calls import AttributeCalls
from jointbench.simulators.chassis.calls.channel_calls import ChannelCalls
from jointbench.simulators.chassis.calls.event_calls import EventCalls
from jointbench.simulators.chassis.calls.read_calls import ReadCalls
from jointbench.simulators.chassis.calls.scripted_faults import ScriptedFaults
from jointbench.simulators.chassis.calls.task_calls import TaskCalls
from jointbench.simulators.chassis.calls.trigger_calls import TriggerCalls
from jointbench.simulators.chassis.limits import Limits
from jointbench.simulators.chassis.modules.inventory import Inventory
from jointbench.simulators.chassis.tasks.task import NewTask


class ChassisService(
    AttributeCalls, ChannelCalls, TaskCalls, TriggerCalls, ReadCalls, EventCalls
):
    """NI's device service of the simulated chassis."""

    def __init__(
        self,
        inventory: Inventory,
        new_task: NewTask,
        *,
        faults: ScriptedFaults | None = None,
        limits: Limits | None = None,
    ) -> None:
        super().__init__(inventory, new_task, limits)
        self.faults = faults or ScriptedFaults()

    def latest(self) -> int:
        """Return the latest sample of the running task, 0 without one."""
        running = (task for task in list(self.tasks.values()) if task.running)
        made = (t.acquisition.acquired() for t in running if t.acquisition is not None)
        return max(made, default=0)
