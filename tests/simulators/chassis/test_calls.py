"""Calls that NI serves: lists of channels, reads, triggers, events, states."""

import threading
from collections.abc import Callable

import grpc
import nidaqmx
import numpy as np
import pytest
from nidaqmx.constants import (
    READ_ALL_AVAILABLE,
    AcquisitionType,
    ReadRelativeTo,
    Slope,
    TaskMode,
    WindowTriggerCondition1,
)
from nidaqmx.stream_readers import AnalogSingleChannelReader, AnalogUnscaledReader

from jointbench.simulators.chassis.modules.module_type import module_type

NewTask = Callable[..., nidaqmx.Task]
FINITE, CONTINUOUS = AcquisitionType.FINITE, AcquisitionType.CONTINUOUS
RANGE = {"min_val": -5.0, "max_val": 5.0}


def block(
    task: nidaqmx.Task, where: str = "cDAQSim1Mod1/ai0", samples: int = 200
) -> nidaqmx.Task:
    """Add channels of 5 V and a finite block at 12.8 kHz."""
    task.ai_channels.add_ai_voltage_chan(where, **RANGE)
    task.timing.cfg_samp_clk_timing(
        12_800.0, sample_mode=FINITE, samps_per_chan=samples
    )
    return task


@pytest.mark.parametrize(
    ("text", "inputs"),
    [
        ("cDAQSim1Mod4/ai0:3", [0, 1, 2, 3]),
        ("cDAQSim1Mod4/ai2:0", [2, 1, 0]),
        ("cDAQSim1Mod4/ai0, cDAQSim1Mod4/ai5:6", [0, 5, 6]),
        ("/cDAQSim1Mod4/ai7", [7]),
        ("cDAQSim1Mod4/ai1:cDAQSim1Mod4/ai2", [1, 2]),
        ("CDAQSIM1MOD4/AI3", [3]),
    ],
)
def test_a_list_of_inputs_makes_a_channel_of_each(
    new_task: NewTask, text: str, inputs: list[int]
) -> None:
    """A range up, a range down, a list, and a leading slash."""
    task = block(new_task(), text)
    assert task.channel_names == [f"cDAQSim1Mod4/ai{n}" for n in inputs]
    assert len(task.read(4)) == (4 if len(inputs) == 1 else len(inputs))


@pytest.mark.parametrize(
    ("given", "names"),
    [
        ("foo31", ["foo31", "foo32", "foo33"]),
        ("foo 123", ["foo123", "foo124", "foo125"]),
        ("a0, b", ["a0", "b0", "b1"]),
        ("a0:2", ["a0", "a1", "a2"]),
        ("a0:999999999", ["a0", "a1", "a2"]),
        ("a, b, c", ["a", "b", "c"]),
    ],
)
def test_names_continue_as_ni_generates_them(
    new_task: NewTask, given: str, names: list[str]
) -> None:
    """The examples of NI's page on the generation of channel names."""
    task = new_task()
    task.ai_channels.add_ai_voltage_chan("Dev2/ai0:2", given)
    assert task.channel_names == names


def test_one_name_for_several_inputs_gets_numbers(new_task: NewTask) -> None:
    """As NI's test of the properties of a task has it."""
    task = new_task()
    task.ai_channels.add_ai_voltage_chan("Dev2/ai0:3", "mine")
    assert task.channels.name == "mine0:3"


def test_unnamed_tasks_are_distinct(new_task: NewTask) -> None:
    """Two at a time, and no name comes back while a task has it."""
    names = [new_task().name for _ in range(3)]
    assert len(set(names)) == 3


def test_reads_that_start_the_task_read_all_and_stop_at_the_end(
    new_task: NewTask,
) -> None:
    """All of a finite block, then a part of a new one."""
    task = block(new_task())
    assert len(task.read(READ_ALL_AVAILABLE)) == 200
    assert len(task.read(500)) == 200


def test_all_ways_of_reading_agree(new_task: NewTask) -> None:
    """Scaled, codes, bytes and a waveform of the same samples."""
    task = block(new_task(), "Dev2/ai0:1", samples=50)
    scaled = np.array(task.read(50))
    codes = np.zeros((2, 50), dtype=np.int16)
    AnalogUnscaledReader(task.in_stream).read_int16(codes, 50)
    raw = task.in_stream.read(50)
    waveforms = task.read_waveform(50)
    np.testing.assert_allclose(5.0 / 2**15 * codes, scaled, atol=1e-9)
    np.testing.assert_array_equal(raw.reshape(50, 2).T, codes)
    np.testing.assert_array_equal(waveforms[1].scaled_data, scaled[1])
    assert waveforms[0].channel_name == "Dev2/ai0"


def test_one_sample_is_read_as_a_number(new_task: NewTask) -> None:
    """By the task, and by a reader."""
    task = new_task()
    task.ai_channels.add_ai_voltage_chan("Dev2/ai0", min_val=1.0, max_val=1.001)
    assert task.read() == pytest.approx(1.0, abs=1e-3)
    one = AnalogSingleChannelReader(task.in_stream).read_one_sample()
    assert one == pytest.approx(1.0, abs=1e-3)


def test_a_read_begins_at_the_stated_sample(new_task: NewTask) -> None:
    """At a sample of the block, and relative to the position."""
    task = block(new_task())
    task.start()
    whole = task.read(200)
    task.in_stream.relative_to = ReadRelativeTo.FIRST_SAMPLE
    task.in_stream.offset = 20
    assert task.read(10) == whole[20:30]


def test_some_channels_are_read(new_task: NewTask) -> None:
    """The second of three."""
    task = new_task()
    for n in range(3):
        task.ai_channels.add_ai_voltage_chan(
            f"Dev2/ai{n}", min_val=n + 1.0, max_val=n + 1.001
        )
    task.in_stream.channels_to_read = task.ai_channels["Dev2/ai1"]
    assert task.read(2) == pytest.approx([2.0, 2.0], abs=1e-3)


@pytest.mark.parametrize("slope", [Slope.RISING, Slope.FALLING])
def test_a_start_trigger_sets_the_first_sample(new_task: NewTask, slope: Slope) -> None:
    """The first sample is the first one beyond the level."""
    task = block(new_task())
    task.triggers.start_trigger.cfg_anlg_edge_start_trig(
        "cDAQSim1Mod1/ai0", trigger_slope=slope, trigger_level=1.0
    )
    first = task.read(30)
    beyond = first[0] >= 1.0 if slope is Slope.RISING else first[0] <= 1.0
    assert beyond
    assert abs(first[0] - 1.0) < 0.6


def test_a_line_of_the_chassis_starts_a_module(
    new_task: NewTask, channel: grpc.Channel
) -> None:
    """A cDAQ-9178 has two trigger inputs, which it lists among its terminals."""
    session = nidaqmx.GrpcSessionOptions(channel, "")
    chassis = nidaqmx.system.Device("cDAQSim1", grpc_options=session)
    assert chassis.terminals == ["/cDAQSim1/PFI0", "/cDAQSim1/PFI1"]
    task = block(new_task())
    task.triggers.start_trigger.cfg_dig_edge_start_trig("/cDAQSim1/PFI1")
    assert task.triggers.start_trigger.dig_edge_src == "/cDAQSim1/PFI1"
    assert len(task.read(200)) == 200


def test_a_window_ends_a_block(new_task: NewTask) -> None:
    """Ten samples before the signal leaves the window."""
    task = block(new_task(), samples=50)
    task.triggers.reference_trigger.cfg_anlg_window_ref_trig(
        "cDAQSim1Mod1/ai0",
        window_top=2.0,
        window_bottom=-2.0,
        pretrigger_samples=10,
        trigger_when=WindowTriggerCondition1.LEAVING_WINDOW,
    )
    samples = np.abs(task.read(50))
    assert samples[9] <= 2.0 < samples[10]


def test_events_come_for_every_interval_and_once_at_the_end(
    new_task: NewTask,
) -> None:
    """Four intervals of 50 in a block of 200; again after another start."""
    task, seen, done = block(new_task()), [], threading.Semaphore(0)

    def every(handle: object, kind: int, count: int, data: object) -> int:
        seen.append(count)
        return 0

    def ended(handle: object, status: int, data: object) -> int:
        done.release()
        return 0

    task.register_every_n_samples_acquired_into_buffer_event(50, every)
    task.register_done_event(ended)
    for starts in (1, 2):
        task.start()
        task.read(200)
        assert done.acquire(timeout=60.0)
        while len(seen) < 4 * starts:
            assert not done.acquire(timeout=0.02)
        task.stop()
    assert seen == [50] * 8


@pytest.mark.parametrize(
    ("rate", "samples", "size"),
    [
        (50.0, 100, 1_000),
        (5_000.0, 100, 10_000),
        (50_000.0, 100, 100_000),
        (1.5e6, 100, 1_000_000),
        (50.0, 5_000, 5_000),
    ],
)
def test_the_buffer_has_the_size_that_ni_documents(
    new_task: NewTask, rate: float, samples: int, size: int
) -> None:
    """By the rate of a continuous task, unless it asks for more."""
    task = new_task()
    task.ai_channels.add_ai_voltage_chan("Dev2/ai0")
    task.timing.cfg_samp_clk_timing(
        rate, sample_mode=CONTINUOUS, samps_per_chan=samples
    )
    assert task.in_stream.input_buf_size == size


@pytest.mark.parametrize(
    ("module", "asked", "taken"),
    [
        ("9234", 20_000.0, 25_600.0),
        ("9234", 1_000.0, 51_200.0 / 31),
        ("9231", 10_000.0, 10_240.0),
        ("9250", 102_400.0, 102_400.0),
        ("9230", 5_000.0, 12_800.0 / 2),
        ("4431", 12_345.0, 12_345.0),
        ("9215", 1_000.0, 1_000.0),
    ],
)
def test_a_rate_is_taken_as_the_clock_of_the_module_gives_it(
    module: str, asked: float, taken: float
) -> None:
    """The next one that is not below the request."""
    assert module_type(module).rates.taken(asked) == pytest.approx(taken)


def test_the_limits_read_back_are_those_of_the_range(new_task: NewTask) -> None:
    """A board with seven ranges selects the smallest one that holds the limits."""
    task = new_task()
    added = task.ai_channels.add_ai_voltage_chan("Dev2/ai0", min_val=-0.3, max_val=0.3)
    assert (added.ai_min, added.ai_max) == (-0.5, 0.5)
    added.ai_max = 3.0
    assert added.ai_rng_high == 5.0


def test_a_task_remembers_its_state(new_task: NewTask, channel: grpc.Channel) -> None:
    """Reserved before a start and after the stop: no other task gets the module."""
    task, other = block(new_task()), block(new_task())
    task.control(TaskMode.TASK_COMMIT)
    task.start()
    task.stop()
    with pytest.raises(nidaqmx.DaqError):
        other.start()
    task.control(TaskMode.TASK_ABORT)
    other.start()


def test_devices_tell_what_they_are(channel: grpc.Channel) -> None:
    """Product, chassis, ranges and currents of each module."""
    system = nidaqmx.system.System.remote(nidaqmx.GrpcSessionOptions(channel, ""))
    fast = system.devices["cDAQSim1Mod2"]
    assert fast.product_type == "NI 9250"
    assert fast.compact_daq_chassis_device.name == "cDAQSim1"
    assert fast.ai_voltage_rngs == [-5.0, 5.0]
    assert fast.ai_current_int_excit_discrete_vals == [0.004]
    with pytest.raises(nidaqmx.DaqError):
        _ = system.devices["cDAQSim1Mod3"].ai_current_int_excit_discrete_vals
