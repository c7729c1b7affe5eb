# SPDX-License-Identifier: MIT
"""Properties of a task that the chassis knows, with NI's defaults.

Source:
    NI-DAQmx help, properties of timing, trigger, read and buffer.
"""

from jointbench.simulators.chassis.property_values import Value
from jointbench.simulators.chassis.protocol import constants

_NONE = constants.TriggerType.NONE.value
_RISING = constants.Edge.RISING.value
_RISING_SLOPE = constants.Slope.RISING.value
_ENTERING = constants.WindowTriggerCondition1.ENTERING_WINDOW.value

TIMING: dict[str, Value] = {
    "SAMP_TIMING_TYPE": constants.SampleTimingType.ON_DEMAND.value,
    "SAMP_QUANT_SAMP_MODE": constants.AcquisitionType.CONTINUOUS.value,
    "SAMP_QUANT_SAMP_PER_CHAN": 1000,
    "SAMP_CLK_RATE": 1000.0,
    "SAMP_CLK_SRC": "",
    "SAMP_CLK_ACTIVE_EDGE": _RISING,
    "SAMP_CLK_MAX_RATE": 0.0,
    "SAMP_CLK_TIMEBASE_DIV": 0,
    "SAMP_CLK_TIMEBASE_RATE": 0.0,
    "SAMP_CLK_TIMEBASE_SRC": "",
    "REF_CLK_SRC": "None",
    "REF_CLK_RATE": 10e6,
    "SYNC_PULSE_SRC": "",
}


def _trigger(which: str) -> dict[str, Value]:
    """Return the properties that start and reference triggers share."""
    return {
        f"{which}_TYPE": _NONE,
        f"DIG_EDGE_{which}_SRC": "",
        f"DIG_EDGE_{which}_EDGE": _RISING,
        f"DIG_EDGE_{which}_DIG_FLTR_ENABLE": False,
        f"DIG_EDGE_{which}_DIG_FLTR_MIN_PULSE_WIDTH": 0.0,
        f"DIG_EDGE_{which}_DIG_FLTR_TIMEBASE_SRC": "",
        f"DIG_EDGE_{which}_DIG_FLTR_TIMEBASE_RATE": 0.0,
        f"ANLG_EDGE_{which}_SRC": "",
        f"ANLG_EDGE_{which}_SLOPE": _RISING_SLOPE,
        f"ANLG_EDGE_{which}_LVL": 0.0,
        f"ANLG_EDGE_{which}_HYST": 0.0,
        f"ANLG_WIN_{which}_SRC": "",
        f"ANLG_WIN_{which}_WHEN": _ENTERING,
        f"ANLG_WIN_{which}_TOP": 0.0,
        f"ANLG_WIN_{which}_BTM": 0.0,
    }


TRIGGER: dict[str, Value] = {
    **_trigger("START_TRIG"),
    **_trigger("REF_TRIG"),
    "REF_TRIG_PRETRIG_SAMPLES": 2,
    "START_TRIG_RETRIGGERABLE": False,
    "START_TRIG_TERM": "",
    "PAUSE_TRIG_TYPE": _NONE,
    "ARM_START_TRIG_TYPE": _NONE,
    "TRIGGER_SYNC_TYPE": constants.SyncType.NONE.value,
}

READ: dict[str, Value] = {
    "AUTO_START": True,
    "CHANNELS_TO_READ": "",
    "LOGGING_FILE_PATH": "",
    "LOGGING_FILE_PREALLOCATION_SIZE": 0,
    "LOGGING_FILE_WRITE_SIZE": 0,
    "LOGGING_MODE": constants.LoggingMode.OFF.value,
    "LOGGING_PAUSE": False,
    "LOGGING_SAMPS_PER_FILE": 0,
    "LOGGING_TDMS_GROUP_NAME": "",
    "LOGGING_TDMS_OPERATION": constants.LoggingOperation.OPEN_OR_CREATE.value,
    "OFFSET": 0,
    "OVERWRITE": constants.OverwriteMode.DO_NOT_OVERWRITE_UNREAD_SAMPLES.value,
    "READ_ALL_AVAIL_SAMP": False,
    "RELATIVE_TO": constants.ReadRelativeTo.CURRENT_READ_POSITION.value,
    "SLEEP_TIME": 0.001,
    "WAIT_MODE": constants.WaitMode.WAIT_FOR_INTERRUPT.value,
}

BUFFER: dict[str, Value] = {"INPUT_BUF_SIZE": 0, "INPUT_ONBRD_BUF_SIZE": 4095}
EXPORT: dict[str, Value] = {
    "START_TRIG_OUTPUT_TERM": "",
    "REF_TRIG_OUTPUT_TERM": "",
    "SAMP_CLK_OUTPUT_TERM": "",
}


def default_buffer(rate: float | None, samples: int, *, finite: bool) -> int:
    """Return the size of the input buffer [samples per channel].

    Args:
        rate: of the sample clock [Hz], None if not stated.
        samples: per channel, as the client configured them.
        finite: the task ends after them.

    Source:
        NI-DAQmx help, How Is Buffer Size Determined?
    """
    if finite:
        return samples
    steps = ((100.0, 1_000), (10_000.0, 10_000), (1e6, 100_000))
    usual = 1_000_000
    if rate is None:
        usual = 10_000
    else:
        usual = next((size for top, size in steps if rate <= top), usual)
    return max(usual, samples)
