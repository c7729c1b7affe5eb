# SPDX-License-Identifier: MIT
"""The NI-DAQmx driver: the one module that talks to `nidaqmx`.

The same calls are used for a driver on this computer and for a remote device server,
real or simulated; only the channel differs.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

import grpc
import nidaqmx
import numpy as np
from nidaqmx.constants import (
    AccelSensitivityUnits,
    AccelUnits,
    AcquisitionType,
    Coupling,
    ExcitationSource,
    ForceIEPESensorSensitivityUnits,
    ForceUnits,
    OverwriteMode,
    ReadRelativeTo,
    SoundPressureUnits,
    VelocityIEPESensorSensitivityUnits,
    VelocityUnits,
)
from nidaqmx.errors import DaqError, RpcError
from nidaqmx.stream_readers import AnalogMultiChannelReader
from nidaqmx.system import System

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.ni.driver_answers import (
    ConnectionLost,
    Module,
    Teds,
)
from jointbench.acquisition.ni.error_codes import (
    NO_TEDS,
    lost_words,
    named_errors,
    reported,
)
from jointbench.acquisition.ni.module_limits import ModuleLimits, device_limits
from jointbench.acquisition.ni.sensors import (
    Axis,
    Sensor,
    channel_name,
    excitation_current,
)
from jointbench.acquisition.records.recordings import Quantity

STANDARD_GRAVITY = 9.80665  # [m/s^2]
_QUIETEST = 20e-6  # [Pa] at 0 dB
_STROKE = 5.0  # [s] for a stroke of a simulated bench; it is requested again
_CONNECTION = 60.0  # [s] for the first answer of a server on a busy computer
_OPTIONS = (
    ("grpc.max_receive_message_length", -1),
    ("grpc.max_send_message_length", -1),
    # A server on a busy computer answers late; its buffer holds 20 s meanwhile.
    ("grpc.keepalive_time_ms", 10_000),
    ("grpc.keepalive_timeout_ms", 20_000),
    # In spite of its name the time in which a connection must be made, greetings of the
    # server included; attempts that are refused are repeated after the other two.
    ("grpc.min_reconnect_backoff_ms", 20_000),
    ("grpc.initial_reconnect_backoff_ms", 100),
    ("grpc.max_reconnect_backoff_ms", 1_000),
)


class Chassis:
    """A driver, local or on a device server; close it after use."""

    def __init__(self, address: str | None) -> None:
        """Connect to a driver.

        Args:
            address: ``host:port`` of a device server, None for this computer.
        """
        self.address = address
        self._channel = (
            None if address is None else grpc.insecure_channel(address, _OPTIONS)
        )
        # Tasks that could not be closed; a device server keeps them, and the device.
        self._left: list[str] = []

    def close(self) -> None:
        """Disconnect from the server."""
        if self._channel is not None:
            self._channel.close()

    def modules(self) -> tuple[Module, ...]:
        """Return the devices that have analogue inputs.

        Raises:
            InstrumentError: there is no driver, or the server does not answer.
        """
        with named_errors(self.address):
            return tuple(
                Module(
                    device.name,
                    device.product_type,
                    device.is_simulated,
                    device.anlg_trig_supported,
                    tuple(device.ai_physical_chans.channel_names),
                )
                for device in self._system().devices
                if device.ai_physical_chans.channel_names
            )

    def limits(self) -> dict[str, ModuleLimits]:
        """Return what each device with analogue inputs can do, by its name.

        Raises:
            InstrumentError: there is no driver, or the server does not answer.
        """
        with named_errors(self.address):
            return {
                device.name: device_limits(device)
                for device in self._system().devices
                if device.ai_physical_chans.channel_names
            }

    def teds(self, physical: str) -> Teds | None:
        """Return the TEDS of the sensor at an input, or None without one."""
        device = physical.partition("/")[0]
        with named_errors(self.address):
            channel = self._system().devices[device].ai_physical_chans[physical]
            try:
                return Teds(
                    channel.teds_mfg_id, channel.teds_model_num, channel.teds_serial_num
                )
            except DaqError as error:
                if error.error_code in NO_TEDS:
                    return None
                raise

    def task(self, name: str, sensors: Sequence[Sensor]) -> "AnalogTask":
        """Create a task with a channel for each axis of the sensors.

        Raises:
            InstrumentError: a channel is refused.
            UsageError: a module does not supply the current of a sensor.
        """
        axes = [(sensor, axis) for sensor in sensors for axis in sensor.axes]
        with named_errors(self.address):
            offered = self._offered({_device(axis) for _, axis in axes})
            currents = [
                excitation_current(sensor, axis, offered[_device(axis)])
                for sensor, axis in axes
            ]
            task = self._new_task(name)
            try:
                gains = [
                    _add_channel(task, sensor, axis, current)
                    for (sensor, axis), current in zip(axes, currents, strict=True)
                ]
            except Exception:
                task.close()
                raise
            return AnalogTask(task, self.address, (name, self._left), gains)

    def _new_task(self, name: str) -> Any:
        """Return an empty task, after those left over were closed.

        A device server attaches to a task of the same name, for example that of a
        program that was killed.
        """
        while self._left:
            nidaqmx.Task(
                self._left[-1], grpc_options=self._options(self._left[-1])
            ).close()
            self._left.pop()
        task = nidaqmx.Task(name, grpc_options=self._options(name))
        if self._channel is None or not task.channel_names:
            return task
        task.close()
        return nidaqmx.Task(name, grpc_options=self._options(name))

    def strike(self, request: bytes) -> bytes | None:
        """Request a stroke of a simulated bench; None for a real one."""
        return self._ask_simulation("Strike", request, _STROKE)

    def has_clock(self) -> bool:
        """Return whether samples arrive on time; some simulations wait for a reader."""
        return self._ask_simulation("Clock", b"", _CONNECTION) != b"none"

    def _ask_simulation(
        self, what: str, request: bytes, timeout: float
    ) -> bytes | None:
        """Return the answer of a simulated bench; None for a real one."""
        if self._channel is None:
            return None
        call = self._channel.unary_unary(f"/jointbench.Hand/{what}")
        try:
            answer: bytes = call(request, timeout=timeout)
        except grpc.RpcError as error:
            code = error.code()
            if code is grpc.StatusCode.UNIMPLEMENTED:
                return None
            if code is grpc.StatusCode.INVALID_ARGUMENT:
                raise UsageError(str(error.details())) from error
            raise ConnectionLost(lost_words(self.address)) from error
        return answer

    def _offered(self, devices: Iterable[str]) -> dict[str, tuple[float, ...]]:
        """Return the currents of devices for sensors [A], by name."""
        found = {}
        for name in devices:
            found[name] = _currents(self._system().devices[name])
        return found

    def _system(self) -> Any:
        if self._channel is None:
            return System.local()
        return System.remote(self._options(""))

    def _options(self, name: str) -> Any:
        if self._channel is None:
            return None
        return nidaqmx.GrpcSessionOptions(self._channel, name)


class AnalogTask:
    """A task that streams; its calls raise this package's errors."""

    def __init__(
        self,
        task: Any,
        address: str | None,
        left: tuple[str, list[str]],
        gains: Sequence[float],
    ) -> None:
        self._task, self._address = task, address
        self._name, self._left = left
        # Of channels that the driver delivers in volts [SI unit/V].
        self._gains = np.array(gains)[:, None] if set(gains) != {1.0} else None
        self._reader = AnalogMultiChannelReader(task.in_stream)
        # The shape is set here, which saves a request to the server at every read.
        self._reader.verify_array_shape = False
        self._count = len(task.channel_names)

    def start(self, sample_rate: float, *, buffer: int) -> float:
        """Start streaming and return the actual rate of the device [Hz].

        Args:
            sample_rate: requested [Hz].
            buffer: samples per channel that the driver keeps until they are read.
        """
        with named_errors(self._address):
            self._task.timing.cfg_samp_clk_timing(
                sample_rate,
                sample_mode=AcquisitionType.CONTINUOUS,
                samps_per_chan=buffer,
            )
            self._task.in_stream.input_buf_size = buffer
            # By default a full buffer stops the device, and the samples meanwhile are
            # lost. With this setting the oldest samples are lost, and the newest can be
            # read.
            self._task.in_stream.overwrite = OverwriteMode.OVERWRITE_UNREAD_SAMPLES
            rate = float(self._task.timing.samp_clk_rate)
            self._task.start()
            return rate

    def start_triggered(
        self,
        sample_rate: float,
        *,
        samples: int,
        source: str,
        before: int,
        level: float,
    ) -> float:
        """Start a finite block around a rising edge detected by the hardware.

        Args:
            sample_rate: requested [Hz].
            samples: of the whole block.
            source: name of the trigger channel.
            before: samples kept before the edge.
            level: [SI unit of the channel].
        """
        with named_errors(self._address):
            self._task.timing.cfg_samp_clk_timing(
                sample_rate, sample_mode=AcquisitionType.FINITE, samps_per_chan=samples
            )
            self._task.triggers.reference_trigger.cfg_anlg_edge_ref_trig(
                source, before, trigger_level=level
            )
            rate = float(self._task.timing.samp_clk_rate)
            self._task.start()
            return rate

    def read(self, count: int, *, timeout: float) -> FloatArray:
        """Return the next samples in SI units, shape (n_channels, count).

        Raises:
            Overrun: some of them were overwritten.
            NotYet: they have not arrived in time.
            Stopped: the device stopped the task.
            ConnectionLost: the server or the device went away.
            InstrumentError: anything else went wrong.
        """
        samples = np.empty((self._count, count))
        with named_errors(self._address):
            self._reader.read_many_sample(samples, count, timeout)
        if self._gains is not None:
            samples *= self._gains
        return samples

    def done(self) -> bool:
        """Return whether a finite block is complete."""
        with named_errors(self._address):
            return bool(self._task.is_task_done())

    def acquired(self) -> int:
        """Return the number of samples per channel acquired since the start."""
        with named_errors(self._address):
            return int(self._task.in_stream.total_samp_per_chan_acquired)

    def available(self) -> int:
        """Return the number of unread samples per channel."""
        with named_errors(self._address):
            return int(self._task.in_stream.avail_samp_per_chan)

    def buffer(self) -> int:
        """Return the size of the driver's buffer in samples per channel."""
        with named_errors(self._address):
            return int(self._task.in_stream.input_buf_size)

    def position(self) -> int:
        """Return the index of the next sample to read, from the driver's counter."""
        with named_errors(self._address):
            return int(self._task.in_stream.curr_read_pos)

    def resume_at(self, sample: int, count: int, *, timeout: float) -> FloatArray:
        """Read from a sample counted from the start, and continue from there.

        Args:
            sample: index of the first sample to read.
            count: samples to read.
            timeout: [s].
        """
        with self._relative(ReadRelativeTo.FIRST_SAMPLE, sample):
            return self.read(count, timeout=timeout)

    def read_back(
        self, back: int, count: int, *, timeout: float
    ) -> tuple[int, FloatArray]:
        """Read from a sample counted back from the newest, and continue from there.

        Args:
            back: number of the newest samples before which nothing is read.
            count: samples to read.
            timeout: [s].

        Returns:
            Index of the first sample read, and the samples, shape (n_channels, count).
        """
        with self._relative(ReadRelativeTo.MOST_RECENT_SAMPLE, -back):
            samples = self.read(count, timeout=timeout)
            return self.position() - count, samples

    @contextmanager
    def _relative(self, origin: ReadRelativeTo, offset: int) -> Iterator[None]:
        """Read from another place; what follows continues from there."""
        stream = self._task.in_stream
        with named_errors(self._address):
            stream.relative_to, stream.offset = origin, offset
        try:
            yield
        finally:
            with named_errors(self._address):
                stream.relative_to = ReadRelativeTo.CURRENT_READ_POSITION
                stream.offset = 0

    def open_loops(self) -> tuple[str, ...]:
        """Return the channels with an open IEPE loop: a disconnected cable or sensor.

        Empty if the device has no such check.
        """
        stream = self._task.in_stream
        try:
            if not stream.open_current_loop_chans_exist:
                return ()
            return tuple(stream.open_current_loop_chans)
        except DaqError:
            return ()

    def close(self) -> None:
        """Stop and clear the task, if it still exists."""
        with suppress(DaqError, RpcError):
            self._task.stop()
        try:
            self._task.close()
        except RpcError:
            self._left.append(self._name)
        except DaqError:
            return


def _currents(device: Any) -> tuple[float, ...]:
    values = reported(lambda: device.ai_current_int_excit_discrete_vals)
    return tuple(float(value) for value in values or () if value > 0)


def _device(axis: Axis) -> str:
    return axis.physical.partition("/")[0]


def _add_channel(task: Any, sensor: Sensor, axis: Axis, current: float) -> float:
    """Add a channel; return the SI units of one unit that the driver delivers."""
    name, source = channel_name(sensor, axis), ExcitationSource
    supply = {
        "current_excit_source": source.INTERNAL if current else source.NONE,
        "current_excit_val": current,
    }
    limits = {"min_val": -sensor.range, "max_val": sensor.range}
    channels, millivolts = task.ai_channels, 1e3 * axis.sensitivity
    gain = 1.0
    if sensor.quantity is Quantity.FORCE:
        channel = channels.add_ai_force_iepe_chan(
            axis.physical,
            name,
            units=ForceUnits.NEWTONS,
            sensitivity=millivolts,
            sensitivity_units=ForceIEPESensorSensitivityUnits.MILLIVOLTS_PER_NEWTON,
            **limits,
            **supply,
        )
    elif sensor.quantity is Quantity.ACCELERATION:
        channel = channels.add_ai_accel_chan(
            axis.physical,
            name,
            units=AccelUnits.METERS_PER_SECOND_SQUARED,
            sensitivity=millivolts * STANDARD_GRAVITY,
            sensitivity_units=AccelSensitivityUnits.MILLIVOLTS_PER_G,
            **limits,
            **supply,
        )
    elif current and sensor.quantity is Quantity.VELOCITY:
        unit = VelocityIEPESensorSensitivityUnits
        channel = channels.add_ai_velocity_iepe_chan(
            axis.physical,
            name,
            units=VelocityUnits.METERS_PER_SECOND,
            sensitivity=1e-3 * millivolts,
            sensitivity_units=unit.MILLIVOLTS_PER_MILLIMETER_PER_SECOND,
            **limits,
            **supply,
        )
    elif current and sensor.quantity is Quantity.PRESSURE:
        channel = channels.add_ai_microphone_chan(
            axis.physical,
            name,
            units=SoundPressureUnits.PA,
            mic_sensitivity=millivolts,
            max_snd_press_level=_sound_level(sensor.range),
            **supply,
        )
    else:
        # Everything else, and what has a supply of its own, is a voltage.
        if current:
            raise UsageError(
                f"channel {name!r} measures {sensor.quantity.value}, for which the "
                "driver has no current; write iepe = '0 mA', or leave it out"
            )
        volts, gain = sensor.range * axis.sensitivity, 1 / axis.sensitivity
        channel = channels.add_ai_voltage_chan(
            axis.physical, name, min_val=-volts, max_val=volts
        )
    channel.ai_coupling = Coupling[sensor.coupling]
    return gain


def _sound_level(pressure: float) -> float:
    """Return the level of a sine of an amplitude [Pa] in dB above 20 uPa."""
    return 20 * math.log10(pressure / math.sqrt(2) / _QUIETEST)
