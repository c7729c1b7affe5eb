"""What NI's hardware refuses, the chassis refuses: with NI's code, by its name.

Codes and texts that NI's own tests or users' reports show are marked "seen"; of the
others NI's help and the names of the codes are all that is known.
"""

from collections.abc import Callable

import nidaqmx
import pytest
from nidaqmx.constants import (
    AcquisitionType,
    Coupling,
    ExcitationSource,
    ReadRelativeTo,
    SampleTimingType,
    TaskMode,
    TerminalConfiguration,
    TriggerType,
)
from nidaqmx.error_codes import DAQmxErrors
from nidaqmx.grpc_session_options import SessionInitializationBehavior

MODULE = "cDAQSim1Mod1"  # NI 9234
BOARD = "Dev2/ai0"  # PCIe-6363
VOLTAGE_ONLY = "cDAQSim1Mod3"  # NI 9215
FINITE, CONTINUOUS = AcquisitionType.FINITE, AcquisitionType.CONTINUOUS
NewTask = Callable[..., nidaqmx.Task]


def volt(task: nidaqmx.Task, where: str = f"{MODULE}/ai0", **options: object) -> None:
    """Add a voltage within the range of every module."""
    limits = {"min_val": -5.0, "max_val": 5.0} | options
    task.ai_channels.add_ai_voltage_chan(where, **limits)  # type: ignore[arg-type]


def accelerometer(task: nidaqmx.Task, where: str, **options: object) -> None:
    """Add an accelerometer of 100 mV/g, fed with 2 mA."""
    usual = {"sensitivity": 100.0, "current_excit_val": 0.002}
    task.ai_channels.add_ai_accel_chan(where, **(usual | options))  # type: ignore[arg-type]


def clocked(
    task: nidaqmx.Task, rate: float = 12_800.0, samples: int = 100
) -> nidaqmx.Task:
    """Add a voltage and a finite block."""
    volt(task)
    task.timing.cfg_samp_clk_timing(rate, sample_mode=FINITE, samps_per_chan=samples)
    return task


def beyond_the_range(task: nidaqmx.Task) -> None:
    """Ten volts at an input of five."""
    volt(task, min_val=-10.0, max_val=10.0)
    task.start()


def limits_reversed(task: nidaqmx.Task) -> None:
    """The minimum above the maximum."""
    volt(task, min_val=1.0, max_val=-1.0)
    task.start()


def too_much_current(task: nidaqmx.Task) -> None:
    """One ampere for an IEPE sensor."""
    accelerometer(task, f"{MODULE}/ai0", current_excit_val=1.0)
    task.start()


def current_of_another_module(task: nidaqmx.Task) -> None:
    """Four milliamperes, which an NI 9250 has and an NI 9234 has not."""
    accelerometer(task, f"{MODULE}/ai0", current_excit_val=0.004)
    task.start()


def no_current_at_all(task: nidaqmx.Task) -> None:
    """An NI 9215 feeds no sensor."""
    accelerometer(task, f"{VOLTAGE_ONLY}/ai0")
    task.start()


def fed_and_coupled_dc(task: nidaqmx.Task) -> None:
    """A sensor that the module feeds is coupled AC."""
    accelerometer(task, f"{MODULE}/ai0")
    task.ai_channels.all.ai_coupling = Coupling.DC
    task.start()


def coupling_of_another_module(task: nidaqmx.Task) -> None:
    """An NI 9215 has DC coupling only."""
    volt(task, f"{VOLTAGE_ONLY}/ai0")
    task.ai_channels.all.ai_coupling = Coupling.AC
    task.start()


def terminal_of_another_module(task: nidaqmx.Task) -> None:
    """An NI 9234 has pseudodifferential inputs only."""
    volt(task, terminal_config=TerminalConfiguration.RSE)
    task.start()


def sensitivity_zero(task: nidaqmx.Task) -> None:
    """Nothing can be divided by it."""
    accelerometer(task, f"{MODULE}/ai0", sensitivity=0.0)
    task.start()


def rate_too_high(task: nidaqmx.Task) -> None:
    """Twice the top rate."""
    clocked(task, 102_400.0).start()


def rate_too_low(task: nidaqmx.Task) -> None:
    """No clock is as slow."""
    clocked(task, 1e-300).start()


def no_samples(task: nidaqmx.Task) -> None:
    """A block of nothing."""
    clocked(task, samples=0).start()


def more_than_memory(task: nidaqmx.Task) -> None:
    """A block of 8 TB."""
    clocked(task, samples=10**12).start()


def no_channels(task: nidaqmx.Task) -> None:
    """An empty task."""
    task.start()


def no_such_device(task: nidaqmx.Task) -> None:
    """A module that is not there."""
    volt(task, "cDAQSim1Mod9/ai0")


def no_such_input(task: nidaqmx.Task) -> None:
    """A fifth input of four."""
    volt(task, f"{MODULE}/ai4")


def no_input_at_all(task: nidaqmx.Task) -> None:
    """An empty list."""
    volt(task, "")


def malformed_list(task: nidaqmx.Task) -> None:
    """A range without an end."""
    volt(task, f"{MODULE}/ai0:")


def same_name_twice(task: nidaqmx.Task) -> None:
    """Two channels of one name."""
    volt(task, name_to_assign_to_channel="a")
    volt(task, f"{MODULE}/ai1", name_to_assign_to_channel="A")


def same_input_twice(task: nidaqmx.Task) -> None:
    """Two names for one input."""
    volt(task, name_to_assign_to_channel="a")
    volt(task, name_to_assign_to_channel="b")
    task.start()


def other_measurement(task: nidaqmx.Task) -> None:
    """A thermocouple."""
    task.ai_channels.add_ai_thrmcpl_chan(f"{MODULE}/ai0")


def started_twice(task: nidaqmx.Task) -> None:
    """A running task."""
    volt(task)
    task.timing.cfg_samp_clk_timing(12_800.0, sample_mode=CONTINUOUS)
    task.start()
    task.start()


def changed_while_running(task: nidaqmx.Task) -> None:
    """A new rate for a running task."""
    clocked(task).start()
    task.timing.samp_clk_rate = 25_600.0


def channel_while_running(task: nidaqmx.Task) -> None:
    """Another channel for a running task."""
    clocked(task).start()
    volt(task, f"{MODULE}/ai1")


def wait_for_ever(task: nidaqmx.Task) -> None:
    """The end of a continuous task."""
    volt(task)
    task.timing.cfg_samp_clk_timing(12_800.0, sample_mode=CONTINUOUS)
    task.start()
    task.wait_until_done(timeout=0.02)


def read_past_the_end(task: nidaqmx.Task) -> None:
    """A sample after the last one."""
    clocked(task).start()
    task.read(100)
    task.read(1)


def read_without_start(task: nidaqmx.Task) -> None:
    """A task that may not start by itself."""
    clocked(task).in_stream.auto_start = False
    task.read(1)


def no_clock(task: nidaqmx.Task) -> None:
    """A delta-sigma converter needs a rate."""
    volt(task)
    task.control(TaskMode.TASK_VERIFY)


def trigger_without_clock(task: nidaqmx.Task) -> None:
    """On demand there is nothing to trigger."""
    volt(task, BOARD)
    task.triggers.start_trigger.trig_type = TriggerType.ANALOG_EDGE
    task.control(TaskMode.TASK_VERIFY)


def reference_of_continuous(task: nidaqmx.Task) -> None:
    """A reference trigger ends a finite block only."""
    volt(task)
    task.timing.cfg_samp_clk_timing(12_800.0, sample_mode=CONTINUOUS)
    task.triggers.reference_trigger.cfg_anlg_edge_ref_trig(f"{MODULE}/ai0", 10)
    task.start()


def pretrigger_too_long(task: nidaqmx.Task) -> None:
    """More samples before the trigger than the block has."""
    trigger = clocked(task).triggers.reference_trigger
    trigger.cfg_anlg_edge_ref_trig(f"{MODULE}/ai0", 200)
    task.start()


def pretrigger_too_short(task: nidaqmx.Task) -> None:
    """One sample before the trigger."""
    trigger = clocked(task).triggers.reference_trigger
    trigger.cfg_anlg_edge_ref_trig(f"{MODULE}/ai0", 1)
    task.start()


def level_beyond_the_range(task: nidaqmx.Task) -> None:
    """A level that the signal cannot reach."""
    trigger = clocked(task).triggers.reference_trigger
    trigger.cfg_anlg_edge_ref_trig(f"{MODULE}/ai0", 10, trigger_level=6.0)
    task.start()


def trigger_by_a_foreign_channel(task: nidaqmx.Task) -> None:
    """A channel that is not in the task."""
    trigger = clocked(task).triggers.reference_trigger
    trigger.cfg_anlg_edge_ref_trig(f"{MODULE}/ai3", 10)
    task.start()


def no_such_line(task: nidaqmx.Task) -> None:
    """A terminal that does not exist."""
    clocked(task).triggers.start_trigger.cfg_dig_edge_start_trig("/Dev1/PFI99")
    task.start()


def no_such_clock(task: nidaqmx.Task) -> None:
    """A clock that does not exist; the first property read shows it."""
    volt(task)
    task.timing.cfg_samp_clk_timing(1000.0, source="Nowhere")
    _ = task.timing.samp_clk_src


def property_of_other_hardware(task: nidaqmx.Task) -> None:
    """A bridge."""
    volt(task)
    _ = task.ai_channels.all.ai_bridge_nom_resistance


def overload_of_other_hardware(task: nidaqmx.Task) -> None:
    """An NI 9215 does not report overloads."""
    volt(task, f"{VOLTAGE_ONLY}/ai0")
    _ = task.in_stream.overloaded_chans_exist


def property_of_one_device(task: nidaqmx.Task) -> None:
    """The rate is that of the whole task."""
    volt(task)
    _ = task.timing[MODULE].samp_clk_rate


def relative_to_no_trigger(task: nidaqmx.Task) -> None:
    """A read from a trigger that is not configured."""
    clocked(task).start()
    task.in_stream.relative_to = ReadRelativeTo.REFERENCE_TRIGGER
    task.read(1)


def no_such_channel_to_read(task: nidaqmx.Task) -> None:
    """A name that the task does not have."""
    clocked(task)
    task.in_stream.channels_to_read = task.ai_channels["nobody"]


def buffer_on_demand(task: nidaqmx.Task) -> None:
    """Without a clock there is no buffer."""
    volt(task, BOARD)
    task.in_stream.input_buf_size = 1000
    task.start()


def events_that_do_not_divide(task: nidaqmx.Task) -> None:
    """An interval that does not divide the buffer of a finite task."""
    clocked(task, samples=100)
    task.register_every_n_samples_acquired_into_buffer_event(30, lambda *_: 0)
    task.start()


def events_that_do_not_divide_a_stated_buffer(task: nidaqmx.Task) -> None:
    """A continuous task keeps the size of buffer that the program states."""
    volt(task)
    task.timing.cfg_samp_clk_timing(12_800.0, sample_mode=CONTINUOUS)
    task.in_stream.input_buf_size = 1000
    task.register_every_n_samples_acquired_into_buffer_event(300, lambda *_: 0)
    task.start()


def unrelated_devices(task: nidaqmx.Task) -> None:
    """A module of a chassis and a board of the computer share no clock."""
    volt(task)
    volt(task, BOARD)
    task.control(TaskMode.TASK_VERIFY)


def single_points_on_usb(task: nidaqmx.Task) -> None:
    """A chassis on USB cannot time single points by hardware."""
    volt(task)
    task.timing.cfg_samp_clk_timing(
        12_800.0, sample_mode=AcquisitionType.HW_TIMED_SINGLE_POINT
    )
    task.start()


def input_of_many_digits(task: nidaqmx.Task) -> None:
    """A number that no integer of the language is read from."""
    volt(task, "Dev2/ai" + 5000 * "9")


def events_of_nothing(task: nidaqmx.Task) -> None:
    """An interval of no samples."""
    clocked(task)
    task.register_every_n_samples_acquired_into_buffer_event(0, lambda *_: 0)


def logging_to_a_file(task: nidaqmx.Task) -> None:
    """The chassis writes no files for a client."""
    clocked(task).in_stream.configure_logging("a.tdms")
    task.start()


E = DAQmxErrors
REFUSED: tuple[tuple[Callable[[nidaqmx.Task], None], DAQmxErrors], ...] = (
    (beyond_the_range, E.INVALID_ATTRIBUTE_VALUE),  # seen
    (limits_reversed, E.MIN_NOT_LESS_THAN_MAX),
    (too_much_current, E.INVALID_ATTRIBUTE_VALUE),
    (current_of_another_module, E.INVALID_ATTRIBUTE_VALUE),
    (no_current_at_all, E.INVALID_ATTRIBUTE_VALUE),
    (fed_and_coupled_dc, E.INVALID_ATTRIBUTE_VALUE),
    (coupling_of_another_module, E.INVALID_ATTRIBUTE_VALUE),
    (terminal_of_another_module, E.INVALID_ATTRIBUTE_VALUE),
    (sensitivity_zero, E.INVALID_ATTRIBUTE_VALUE),
    (rate_too_high, E.INVALID_ATTRIBUTE_VALUE),
    (rate_too_low, E.INVALID_ATTRIBUTE_VALUE),
    (no_samples, E.INVALID_ATTRIBUTE_VALUE),  # seen
    (more_than_memory, E.PAL_MEMORY_FULL),
    (no_channels, E.CAN_NOT_PERFORM_OP_WHEN_NO_CHANS_IN_TASK),
    (no_such_device, E.INVALID_DEVICE_ID),
    (no_such_input, E.PHYSICAL_CHAN_DOES_NOT_EXIST),
    (no_input_at_all, E.PHYSICAL_CHANNEL_NOT_SPECIFIED),
    (malformed_list, E.INVALID_SYNTAX_FOR_PHYSICAL_CHANNEL_RANGE),
    (same_name_twice, E.CHAN_ALREADY_IN_TASK),
    (same_input_twice, E.REPEATED_AI_PHYSICAL_CHAN),
    (other_measurement, E.PHYS_CHAN_MEAS_TYPE),
    (started_twice, E.CAN_NOT_PERFORM_OP_WHILE_TASK_RUNNING),
    (changed_while_running, E.CANNOT_SET_PROPERTY_WHEN_TASK_RUNNING),
    (channel_while_running, E.CAN_NOT_PERFORM_OP_WHILE_TASK_RUNNING),
    (wait_for_ever, E.WAIT_UNTIL_DONE_DOES_NOT_INDICATE_DONE),
    (read_past_the_end, E.SAMPLES_WILL_NEVER_BE_AVAILABLE),
    (
        read_without_start,
        E.CANNOT_READ_WHEN_AUTO_START_FALSE_AND_TASK_NOT_RUNNING_OR_COMMITTED,
    ),
    (no_clock, E.SAMP_CLK_RATE_MUST_BE_SPECD),  # seen
    (trigger_without_clock, E.TRIG_WHEN_ON_DEMAND_SAMP_TIMING),  # seen
    (reference_of_continuous, E.REF_TRIG_WHEN_CONTINUOUS),
    (pretrigger_too_long, E.TOO_MANY_PRETRIG_PLUS_MIN_POST_TRIG_SAMPS),
    (pretrigger_too_short, E.INVALID_ATTRIBUTE_VALUE),
    (level_beyond_the_range, E.INVALID_ATTRIBUTE_VALUE),
    (trigger_by_a_foreign_channel, E.INVALID_ATTRIBUTE_VALUE),
    (no_such_line, E.INVALID_ROUTING_SOURCE_TERMINAL_NAME_ROUTING),
    (no_such_clock, E.INVALID_ROUTING_SOURCE_TERMINAL_NAME_ROUTING),  # seen
    (property_of_other_hardware, E.ATTRIBUTE_NOT_SUPPORTED_IN_TASK_CONTEXT),
    (overload_of_other_hardware, E.ATTRIBUTE_NOT_SUPPORTED_IN_TASK_CONTEXT),
    (property_of_one_device, E.M_STUDIO_OPERATION_DOES_NOT_SUPPORT_DEVICE_CONTEXT),
    (relative_to_no_trigger, E.NO_REF_TRIG_CONFIGURED),
    (no_such_channel_to_read, E.INVALID_CHANNEL),
    (buffer_on_demand, E.BUFFER_WITH_ON_DEMAND_SAMP_TIMING),
    (
        events_that_do_not_divide,
        E.BUFFER_SIZE_NOT_MULTIPLE_OF_EVERY_N_SAMPS_EVENT_INTERVAL_WHEN_DMA,
    ),
    (
        events_that_do_not_divide_a_stated_buffer,
        E.BUFFER_SIZE_NOT_MULTIPLE_OF_EVERY_N_SAMPS_EVENT_INTERVAL_WHEN_DMA,
    ),
    (unrelated_devices, E.MULTI_DEVS_IN_TASK),
    (single_points_on_usb, E.INVALID_ATTRIBUTE_VALUE),
    (input_of_many_digits, E.PHYSICAL_CHAN_DOES_NOT_EXIST),
    (events_of_nothing, E.EVERY_N_SAMPS_EVENT_INTERVAL_ZERO_NOT_SUPPORTED),
    (logging_to_a_file, E.MEASUREMENT_TYPE_NOT_SUPPORTED_FOR_LOGGING),
)


@pytest.mark.parametrize(
    ("mistake", "code"), REFUSED, ids=[mistake.__name__ for mistake, _ in REFUSED]
)
def test_a_mistake_is_refused_with_nis_code(
    new_task: NewTask, mistake: Callable[[nidaqmx.Task], None], code: DAQmxErrors
) -> None:
    """Each on a task of its own."""
    with pytest.raises(nidaqmx.DaqError) as refused:
        mistake(new_task())
    assert refused.value.error_code == code


def test_the_text_names_property_value_limits_channel_and_task(
    new_task: NewTask,
) -> None:
    """As quoted by a user of a USB-4431 in nidaqmx-python issue 1007."""
    task = new_task()
    volt(task, "Dev1/ai0", min_val=-20.0, max_val=20.0)
    with pytest.raises(nidaqmx.DaqError) as refused:
        task.start()
    lines = str(refused.value).splitlines()
    assert lines[0].startswith("Requested value is not a supported value for this")
    assert lines[2:7] == [
        "Property: DAQmx_AI_Max",
        "Requested Value: 20.0",
        "Maximum Value:  10.000000",
        "Minimum Value: -10.000000",
        "Channel Name: Dev1/ai0",
    ]
    assert lines[8] == f"Task Name: {task.name}"
    assert lines[-1] == "Status Code: -200077"


def test_a_device_that_another_task_holds_is_reserved(new_task: NewTask) -> None:
    """Two tasks on one input: -50103, until the first one lets go."""
    first, second = clocked(new_task()), clocked(new_task())
    first.control(TaskMode.TASK_RESERVE)
    with pytest.raises(nidaqmx.DaqError) as refused:
        second.start()
    assert refused.value.error_code == DAQmxErrors.PAL_RESOURCE_RESERVED
    first.control(TaskMode.TASK_UNRESERVE)
    second.start()


def test_a_chassis_runs_three_tasks_and_no_fourth(new_task: NewTask) -> None:
    """A cDAQ-9178 has three timing engines for analogue input."""
    tasks = [new_task() for _ in range(4)]
    for slot, task in enumerate(tasks, 1):
        volt(task, f"cDAQSim1Mod{slot}/ai0")
        task.timing.cfg_samp_clk_timing(12_800.0, sample_mode=CONTINUOUS)
    for task in tasks[:3]:
        task.start()
    with pytest.raises(nidaqmx.DaqError) as refused:
        tasks[3].start()
    assert refused.value.error_code == DAQmxErrors.PAL_RESOURCE_RESERVED


def test_a_name_that_is_taken_is_a_duplicate_for_a_new_session(
    new_task: NewTask,
) -> None:
    """By default the client attaches; a new session is refused."""
    new_task("mine")
    with pytest.raises(nidaqmx.DaqError) as refused:
        new_task(
            "mine",
            initialization_behavior=SessionInitializationBehavior.INITIALIZE_SERVER_SESSION,
        )
    assert refused.value.error_code == DAQmxErrors.DUPLICATE_TASK


def test_an_event_is_registered_once(new_task: NewTask) -> None:
    """NI's own test sees both codes."""
    task = clocked(new_task())
    task.register_done_event(lambda *_: 0)
    task._event_handlers.clear()  # the client keeps its own account  # noqa: SLF001
    with pytest.raises(nidaqmx.DaqError) as refused:
        task.register_done_event(lambda *_: 0)
    assert refused.value.error_code == DAQmxErrors.DONE_EVENT_ALREADY_REGISTERED


def test_a_task_on_demand_has_no_clock(new_task: NewTask) -> None:
    """Its timing type shows it, and it is always done."""
    task = new_task()
    volt(task, BOARD)
    assert task.timing.samp_timing_type == SampleTimingType.ON_DEMAND
    task.start()
    task.wait_until_done()
    assert task.is_task_done()


def test_the_chassis_has_no_external_supply(new_task: NewTask) -> None:
    """A sensor with a supply of its own is read by every module."""
    task = new_task()
    accelerometer(
        task, f"{VOLTAGE_ONLY}/ai0", current_excit_source=ExcitationSource.NONE
    )
    assert len(task.read(3)) == 3
