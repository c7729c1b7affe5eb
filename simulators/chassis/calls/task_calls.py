# SPDX-License-Identifier: MIT
"""NI's calls about tasks: made, configured, started, stopped and cleared."""

# The methods carry the names that the protocol gives them.
# ruff: noqa: N802

from typing import Any

import grpc

from jointbench.simulators.chassis.calls.answers import Calls, answered
from jointbench.simulators.chassis.calls.error_words import error_words
from jointbench.simulators.chassis.modules.lookup import device_named
from jointbench.simulators.chassis.protocol import (
    Daqmx,
    DAQmxErrors,
    Refusal,
    bad_value,
    constants,
    number_of,
)
from jointbench.simulators.chassis.tasks.acquisition import Patience
from jointbench.simulators.chassis.tasks.task import SimulatedTask, TaskState

_MODE = constants.TaskMode
_CLOCK = constants.SampleTimingType.SAMPLE_CLOCK.value
_INITIALIZE_NEW, _ATTACH = 1, 2


class TaskCalls(Calls):
    """Life of a task, its clock and its buffer."""

    @answered
    def CreateTask(self, request: Any, context: Any) -> Any:
        """Make an empty task, or attach to one."""
        name, behaviour = request.session_name, request.initialization_behavior
        if behaviour == _ATTACH and name not in self.tasks:
            context.abort(
                grpc.StatusCode.FAILED_PRECONDITION,
                f"Cannot attach to session {name!r}: it has not been initialized.",
            )
        if behaviour == _INITIALIZE_NEW and name in self.tasks:
            raise Refusal(
                DAQmxErrors.DUPLICATE_TASK,
                f"Task name conflicts with an existing task name.\n\nTask Name: {name}",
            )
        name, fresh = self.make_task(name, context)
        return Daqmx.CreateTaskResponse(
            task={"name": name}, new_session_initialized=fresh
        )

    @answered
    def ClearTask(self, request: Any, context: Any) -> Any:
        """Forget a task."""
        self.drop_task(self.task(request))
        return Daqmx.ClearTaskResponse()

    @answered
    def StartTask(self, request: Any, context: Any) -> Any:
        """Start the clock."""
        task = self.task(request)
        with task.guard:
            task.start()
        return Daqmx.StartTaskResponse()

    @answered
    def StopTask(self, request: Any, context: Any) -> Any:
        """Stop the clock."""
        task = self.task(request)
        with task.guard:
            task.stop()
        return Daqmx.StopTaskResponse()

    @answered
    def TaskControl(self, request: Any, context: Any) -> Any:
        """Change the state of a task."""
        task = self.task(request)
        with task.guard:
            _control(task, number_of(request, "action"))
        return Daqmx.TaskControlResponse()

    @answered
    def IsTaskDone(self, request: Any, context: Any) -> Any:
        """Answer whether a task is done; one that does not run is."""
        task = self.task(request)
        done = not task.running or task.acquisition is None or task.acquisition.done()
        return Daqmx.IsTaskDoneResponse(is_task_done=done)

    @answered
    def WaitUntilTaskDone(self, request: Any, context: Any) -> Any:
        """Wait for the last sample of a task."""
        task = self.task(request)
        if task.running and task.acquisition is not None:
            waiting = Patience(timeout=request.time_to_wait, alive=context.is_active)
            with self.waiters.occupied(context):
                task.acquisition.await_end(waiting)
        return Daqmx.WaitUntilTaskDoneResponse()

    @answered
    def CfgSampClkTiming(self, request: Any, context: Any) -> Any:
        """Set the clock."""
        task = self.task(request)
        with task.guard:
            task.change()
            task.timing.set("SAMP_TIMING_TYPE", _CLOCK)
            task.timing.set("SAMP_CLK_RATE", request.rate)
            task.timing.set("SAMP_CLK_SRC", request.source)
            task.timing.set("SAMP_CLK_ACTIVE_EDGE", number_of(request, "active_edge"))
            task.timing.set("SAMP_QUANT_SAMP_MODE", number_of(request, "sample_mode"))
            task.timing.set("SAMP_QUANT_SAMP_PER_CHAN", request.samps_per_chan)
        return Daqmx.CfgSampClkTimingResponse()

    @answered
    def CfgInputBuffer(self, request: Any, context: Any) -> Any:
        """Set the size of the input buffer."""
        task = self.task(request)
        with task.guard:
            task.change()
            task.buffers.set("INPUT_BUF_SIZE", request.num_samps_per_chan)
        return Daqmx.CfgInputBufferResponse()

    @answered
    def ConfigureLogging(self, request: Any, context: Any) -> Any:
        """Set the properties of logging; a start refuses them."""
        task = self.task(request)
        with task.guard:
            task.change()
            task.reading.set("LOGGING_FILE_PATH", request.file_path)
            task.reading.set("LOGGING_MODE", number_of(request, "logging_mode"))
            task.reading.set("LOGGING_TDMS_GROUP_NAME", request.group_name)
            task.reading.set("LOGGING_TDMS_OPERATION", number_of(request, "operation"))
        return Daqmx.ConfigureLoggingResponse()

    @answered
    def StartNewFile(self, request: Any, context: Any) -> Any:
        """Set the file of logging."""
        self.task(request).reading.set("LOGGING_FILE_PATH", request.file_path)
        return Daqmx.StartNewFileResponse()

    @answered
    def ResetDevice(self, request: Any, context: Any) -> Any:
        """Abort the tasks on a device."""
        device_named(self.inventory, request.device_name)
        for task in list(self.tasks.values()):
            names = {device.name for device in task.devices}
            chassis = {device.chassis for device in task.devices}
            if request.device_name in names | chassis:
                with task.guard:
                    task.abort()
        return Daqmx.ResetDeviceResponse()

    @answered
    def SelfTestDevice(self, request: Any, context: Any) -> Any:
        """Pass the test of a device."""
        device_named(self.inventory, request.device_name)
        return Daqmx.SelfTestDeviceResponse()

    @answered
    def GetNthTaskChannel(self, request: Any, context: Any) -> Any:
        """Answer for the name of a channel, counted from 1."""
        name = _nth([c.name for c in self.task(request).channels], request.index)
        return Daqmx.GetNthTaskChannelResponse(buffer=name)

    @answered
    def GetNthTaskDevice(self, request: Any, context: Any) -> Any:
        """Answer for the name of a device, counted from 1."""
        name = _nth([d.name for d in self.task(request).devices], request.index)
        return Daqmx.GetNthTaskDeviceResponse(buffer=name)

    @answered
    def GetErrorString(self, request: Any, context: Any) -> Any:
        """Answer for the name of an error."""
        return Daqmx.GetErrorStringResponse(
            error_string=error_words(request.error_code)
        )


def _control(task: SimulatedTask, action: int) -> None:
    states = {
        _MODE.TASK_VERIFY.value: TaskState.VERIFIED,
        _MODE.TASK_RESERVE.value: TaskState.RESERVED,
        _MODE.TASK_COMMIT.value: TaskState.COMMITTED,
    }
    plain = {
        _MODE.TASK_START.value: task.start,
        _MODE.TASK_STOP.value: task.stop,
        _MODE.TASK_UNRESERVE.value: task.unreserve,
        _MODE.TASK_ABORT.value: task.abort,
    }
    if action in plain:
        plain[action]()
    elif action in states:
        task.reach(states[action])
    else:
        raise bad_value("Task_Control_Action", action)


def _nth(names: list[str], index: int) -> str:
    if not 1 <= index <= len(names):
        raise bad_value("Index", index, low=1, high=len(names))
    return names[index - 1]
