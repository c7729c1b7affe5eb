# SPDX-License-Identifier: MIT
"""NI's calls that read samples: scaled, raw, as codes, one at a time, as waveforms."""

# The methods carry the names that the protocol gives them.
# ruff: noqa: N802

import time
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.chassis.calls.answers import Calls, answered
from jointbench.simulators.chassis.calls.scripted_faults import ScriptedFaults
from jointbench.simulators.chassis.calls.task_properties import available
from jointbench.simulators.chassis.protocol import (
    Daqmx,
    DAQmxErrors,
    Refusal,
    bad_value,
    constants,
    number_of,
)
from jointbench.simulators.chassis.tasks.acquisition import Patience
from jointbench.simulators.chassis.tasks.task import (
    MOST_BYTES,
    SimulatedTask,
    no_memory,
)

_BY_CHANNEL = constants.FillMode.GROUP_BY_CHANNEL.value
_FROM = constants.ReadRelativeTo
_READ_ARRAY = Daqmx.ReadAnalogF64Response.DESCRIPTOR.fields_by_name["read_array"].number
_LENGTH_DELIMITED = 2  # wire type of protocol buffers
_BYTES = 8
_LONGEST_SLEEP = 0.05  # [s] of a slow read, before the client is looked for
_EPOCH_1904 = 2_082_844_800  # [s] from 1904, where NI's time begins, to 1970
_TIMING = constants.WaveformAttributeMode.TIMING.value
_EXTENDED = constants.WaveformAttributeMode.EXTENDED_PROPERTIES.value


class ReadCalls(Calls):
    """Every way of reading an analogue task.

    Attributes:
        faults: the script.
    """

    faults: ScriptedFaults

    @answered
    def ReadAnalogF64(self, request: Any, context: Any) -> Any:
        """Deliver samples in the units of the channels."""
        samples = self._scaled(request, request.num_samps_per_chan, context)
        # Doubles travel packed: their bytes are the message, which saves a Python
        # object for every sample.
        packed = _ordered(samples, request).astype("<f8").tobytes()
        response = Daqmx.ReadAnalogF64Response.FromString(
            _packed_field(_READ_ARRAY, len(packed)) + packed
        )
        response.samps_per_chan_read = samples.shape[1]
        return response

    @answered
    def ReadAnalogScalarF64(self, request: Any, context: Any) -> Any:
        """Deliver one sample of one channel."""
        if len(self.task(request).read_channels()) > 1:
            raise Refusal(
                DAQmxErrors.ONE_CHAN_READ_FOR_MULTI_CHAN_TASK,
                "Specified read cannot be performed, because it reads one channel and "
                "the task has several.",
                read=0,
            )
        samples = self._scaled(request, 1, context)
        return Daqmx.ReadAnalogScalarF64Response(value=float(samples[0, 0]))

    @answered
    def ReadAnalogWaveforms(self, request: Any, context: Any) -> Any:
        """Deliver samples with their time and name, a waveform for each channel."""
        task = self.task(request)
        samples = self._scaled(request, request.num_samps_per_chan, context)
        response = Daqmx.ReadAnalogWaveformsResponse()
        response.samps_per_chan_read = samples.shape[1]
        mode = number_of(request, "waveform_attribute_mode")
        for row, index in zip(samples, task.read_channels(), strict=True):
            waveform = response.waveforms.add()
            waveform.y_data.extend(row.tolist())
            if mode & _TIMING:
                _stamp(waveform, task, samples.shape[1])
            if mode & _EXTENDED:
                channel = task.channels[index]
                waveform.attributes["NI_ChannelName"].string_value = channel.name
                waveform.attributes["NI_UnitDescription"].string_value = "Volts"
        return response

    @answered
    def ReadBinaryI16(self, request: Any, context: Any) -> Any:
        """Deliver codes of a converter of at most 16 bits."""
        return self._binary(request, context, "ReadBinaryI16", 16)

    @answered
    def ReadBinaryU16(self, request: Any, context: Any) -> Any:
        """Deliver codes as numbers without a sign."""
        return self._binary(request, context, "ReadBinaryU16", 16)

    @answered
    def ReadBinaryI32(self, request: Any, context: Any) -> Any:
        """Deliver codes of any converter."""
        return self._binary(request, context, "ReadBinaryI32", 32)

    @answered
    def ReadBinaryU32(self, request: Any, context: Any) -> Any:
        """Deliver codes as numbers without a sign."""
        return self._binary(request, context, "ReadBinaryU32", 32)

    @answered
    def ReadRaw(self, request: Any, context: Any) -> Any:
        """Deliver codes as the bytes of the device, sample by sample."""
        task = self.task(request)
        count = request.num_samps_per_chan
        if count < 0 and task.channels:
            # "All" fills the array of the client, whole samples of all channels.
            width = sum(c.values.whole("AI_RAW_SAMP_SIZE") for c in task.channels) // 8
            count = request.array_size_in_bytes // width
        codes = self._codes(request, count, context)
        small = max(c.values.whole("AI_RAW_SAMP_SIZE") for c in task.channels) == 16
        packed = codes.T.astype("<i2" if small else "<i4").tobytes()
        return Daqmx.ReadRawResponse(
            read_array=packed,
            samps_read=codes.shape[1],
            num_bytes_per_samp=2 if small else 4,
        )

    def _binary(self, request: Any, context: Any, call: str, bits: int) -> Any:
        task = self.task(request)
        for channel in task.channels:
            size = channel.values.whole("AI_RAW_SAMP_SIZE")
            if size > bits:
                raise Refusal(
                    DAQmxErrors.READ_CHAN_TYPE_MISMATCH,
                    "Read cannot be performed: the raw samples of the channel have "
                    f"{size} bits, more than this read returns.\n\n"
                    f"Channel Name: {channel.name}",
                    read=0,
                )
        codes = self._codes(request, request.num_samps_per_chan, context)
        unsigned = call.startswith("ReadBinaryU")
        values = codes & (2**bits - 1) if unsigned else codes
        response = getattr(Daqmx, f"{call}Response")()
        response.read_array.extend(_ordered(values, request).ravel().tolist())
        response.samps_per_chan_read = codes.shape[1]
        return response

    def _scaled(self, request: Any, count: int, context: Any) -> FloatArray:
        task = self.task(request)
        volts, wanted = self._volts(task, request.timeout, count, context)
        for row, index in zip(volts, wanted, strict=True):
            row /= task.channels[index].volts_per_unit
        return volts

    def _codes(
        self, request: Any, count: int, context: Any
    ) -> "np.ndarray[Any, np.dtype[np.int64]]":
        task = self.task(request)
        volts, wanted = self._volts(task, request.timeout, count, context)
        counts = np.array([[task.channels[index].count] for index in wanted])
        return np.asarray(np.round(volts / counts), dtype=np.int64)

    def _volts(
        self, task: SimulatedTask, timeout: float, count: int, context: Any
    ) -> tuple[FloatArray, list[int]]:
        """Return digitised volts of the channels to read, and their indices."""
        own_start = self._started(task)
        try:
            made, wanted = task.acquisition, task.read_channels()
            assert made is not None
            count = _count(task, count)
            if count * len(task.channels) * _BYTES > MOST_BYTES:
                raise no_memory()
            self.faults.before_read(task, count)
            waiting = Patience(timeout=timeout, alive=context.is_active)
            with self.waiters.occupied(context):
                self._slow_down(waiting)
                volts = made.read(count, waiting, first=_first(task))
            self._open_loops(task, volts)
            self.faults.delivered += volts.shape[1]
            return volts[wanted], wanted
        finally:
            self._stop_own(task, own_start)

    def _started(self, task: SimulatedTask) -> bool:
        """Start a task that does not run; return whether this was needed.

        Raises:
            Refusal: the client has forbidden it, or the task cannot start.
        """
        with task.guard:
            if task.running:
                return False
            if not task.reading.get("AUTO_START"):
                raise Refusal(
                    DAQmxErrors.CANNOT_READ_WHEN_AUTO_START_FALSE_AND_TASK_NOT_RUNNING_OR_COMMITTED,
                    "Read cannot be performed when the Auto Start property is false "
                    "and the task is not running or committed.",
                    read=0,
                )
            task.start()
            return True

    def _stop_own(self, task: SimulatedTask, own_start: bool) -> None:
        """Stop what a read started: without a clock, or after the last sample."""
        made = task.acquisition
        with task.guard:
            task.started_by_read |= own_start
            ended = made is not None and made.end is not None
            if not task.started_by_read or made is None:
                return
            if not task.clocked or (ended and made.position >= (made.end or 0)):
                task.stop()

    def _slow_down(self, waiting: Patience) -> None:
        until = time.monotonic() + self.faults.delay
        while self.faults.delay and time.monotonic() < until and waiting.alive():
            time.sleep(min(_LONGEST_SLEEP, self.faults.delay))

    def _open_loops(self, task: SimulatedTask, volts: FloatArray) -> None:
        """Drive the inputs of open loops to the compliance voltage: full scale."""
        for row, channel in zip(volts, task.channels, strict=True):
            if channel.input.number in self.faults.open:
                row[:] = channel.range or 0.0


def _count(task: SimulatedTask, asked: int) -> int:
    """Return the samples that a read returns; -1 stands for all of them."""
    if asked >= 0:
        return asked
    if asked != constants.READ_ALL_AVAILABLE:
        raise bad_value("NumSampsPerChan", asked, low=-1)
    if not task.clocked:
        return 1
    if task.finite is not None and not task.reading.get("READ_ALL_AVAIL_SAMP"):
        return task.finite
    return available(task)


def _first(task: SimulatedTask) -> int | None:
    """Return the sample at which a read begins, None for the read position.

    Raises:
        Refusal: there is no such sample.
    """
    relative = task.reading.whole("RELATIVE_TO")
    offset, made = task.reading.whole("OFFSET"), task.acquisition
    assert made is not None
    origin = {
        _FROM.FIRST_SAMPLE.value: 0,
        _FROM.MOST_RECENT_SAMPLE.value: made.acquired(),
    }
    if relative == _FROM.CURRENT_READ_POSITION.value:
        return made.position + offset if offset else None
    if relative in origin:
        return max(0, origin[relative] + offset)
    if task.triggers.whole("REF_TRIG_TYPE") == constants.TriggerType.NONE.value:
        raise Refusal(
            DAQmxErrors.NO_REF_TRIG_CONFIGURED,
            "Read relative to a reference trigger is not possible, because none is "
            "configured for the task.",
            read=0,
        )
    if made.end is None or made.course.finite is None:
        raise Refusal(
            DAQmxErrors.CANNOT_READ_RELATIVE_TO_REF_TRIG_UNTIL_DONE,
            "Read relative to the reference trigger is not possible until the "
            "acquisition is complete.",
            read=0,
        )
    first = made.end - made.course.finite
    at = relative == _FROM.REFERENCE_TRIGGER.value
    return first + offset + (made.course.triggers.before if at else 0)


def _ordered(samples: Any, request: Any) -> Any:
    """Return samples in the order that a request asks for."""
    by_channel = number_of(request, "fill_mode") == _BY_CHANNEL
    return samples if by_channel else samples.T


def _stamp(waveform: Any, task: SimulatedTask, count: int) -> None:
    """Set the time of the first sample and the interval."""
    assert task.acquisition is not None
    rate = task.acquisition.course.rate
    waveform.dt = 1.0 / rate
    since = time.time() + _EPOCH_1904 - count / rate
    waveform.t0.seconds = int(since)
    waveform.t0.fractional_seconds = int((since % 1.0) * 2**64)


def _packed_field(number: int, size: int) -> bytes:
    """Return the head of a field of some bytes in protocol buffers' encoding."""
    head = bytearray([number << 3 | _LENGTH_DELIMITED])
    while size > 0x7F:
        head.append(size & 0x7F | 0x80)
        size >>= 7
    return bytes([*head, size])
