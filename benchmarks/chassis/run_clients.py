"""Acquire from the simulated chassis with LDAQ, and as Rattlesnake does.

    python benchmarks/chassis/run_clients.py --json clients.json

LDAQ and nidaqwrapper are needed for the first; without them it is reported as not run.
Rattlesnake is a program with windows: what is done here is the sequence of calls of its
acquisition, on two modules.
"""

import argparse
import json
import math
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

import nidaqmx
import numpy as np
from client_session import session
from nidaqmx.constants import (
    AccelSensitivityUnits,
    AccelUnits,
    AcquisitionType,
    ExcitationSource,
    ForceIEPESensorSensitivityUnits,
    ForceUnits,
    WaitMode,
)
from nidaqmx.stream_readers import AnalogMultiChannelReader

from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis
from jointbench.simulators.measuring.operator import SimulatedOperator
from jointbench.simulators.plates.plates_bench import PlatesBench

MODULE = "cDAQSim1Mod1"


def bench(**changes: object) -> ChassisSetup:
    """Return plates that are struck every second."""
    plates = PlatesBench(operator=SimulatedOperator(seed=1, interval=1.0))
    return ChassisSetup(bench=plates, **changes)  # type: ignore[arg-type]


def ldaq() -> str:
    """Acquire a triggered second of a hammer and an accelerometer with LDAQ."""
    # LDAQ leaves the current at the client's 4 mA, which an NI 9250 supplies.
    import LDAQ
    from nidaqwrapper import AITask

    with (
        SimulatedChassis(bench(speed=1.0, module="9250")) as server,
        session(server.address),
    ):
        task = AITask("hammer_test", sample_rate=12_800)
        for number, (name, unit) in enumerate((("force", "N"), ("response", "g"))):
            task.add_channel(
                name,
                MODULE,
                number,
                sensitivity=2.25 if unit == "N" else 10.2,
                sensitivity_units=f"mV/{unit}",
                units=unit,
                min_val=-2200.0 if unit == "N" else -450.0,
                max_val=2200.0 if unit == "N" else 450.0,
            )
        source = LDAQ.national_instruments.NIAcquisition(task, "bench")
        source.set_trigger(20.0, "force", duration=1.0, presamples=100)
        source.run_acquisition()
        measured = source.get_measurement_dict()
        task.clear_task()
    data = measured["data"]
    peak = float(np.max(data[:, 0]))
    first = int(np.flatnonzero(np.abs(data[:, 0]) >= 20.0)[0])
    assert data.shape[0] >= 12_000, data.shape
    assert peak > 20.0
    return (
        f"{data.shape[0]} samples of {data.shape[1]} channels, peak {peak:.0f} N "
        + (f"after {first} samples")
    )


def rattlesnake() -> str:
    """Acquire frames of two modules, then what is left, as Rattlesnake does."""
    frame, frames = 4096, 4
    with (
        SimulatedChassis(bench(speed=4.0, modules=2)) as server,
        session(server.address),
    ):
        task = nidaqmx.Task()
        task.ai_channels.add_ai_force_iepe_chan(
            f"{MODULE}/ai0",
            min_val=-5.0 * 1000 / 2.25,
            max_val=5.0 * 1000 / 2.25,
            units=ForceUnits.NEWTONS,
            sensitivity=2.25,
            sensitivity_units=ForceIEPESensorSensitivityUnits.MILLIVOLTS_PER_NEWTON,
            current_excit_source=ExcitationSource.INTERNAL,
            current_excit_val=0.002,
        )
        for place in (f"{MODULE}/ai1", f"{MODULE}/ai2", "cDAQSim1Mod2/ai0"):
            task.ai_channels.add_ai_accel_chan(
                place,
                min_val=-5.0 * 1000 / 10.2,
                max_val=5.0 * 1000 / 10.2,
                units=AccelUnits.G,
                sensitivity=10.2,
                sensitivity_units=AccelSensitivityUnits.MILLIVOLTS_PER_G,
                current_excit_source=ExcitationSource.INTERNAL,
                current_excit_val=0.002,
            )
        task.timing.cfg_samp_clk_timing(
            5120.0, sample_mode=AcquisitionType.CONTINUOUS, samps_per_chan=frame
        )
        task.in_stream.wait_mode = WaitMode.POLL
        reader = AnalogMultiChannelReader(task.in_stream)
        data = np.zeros((len(task.ai_channels), frame))
        task.start()
        peaks = []
        for _ in range(frames):
            reader.read_many_sample(data, number_of_samples_per_channel=frame)
            peaks.append(float(np.abs(data[0]).max()))
        rest = np.zeros((4, task.in_stream.avail_samp_per_chan))
        reader.read_many_sample(rest, number_of_samples_per_channel=rest.shape[1])
        task.stop()
        task.close()
    assert max(peaks) > 20.0, peaks
    assert all(math.isfinite(peak) for peak in peaks)
    return f"{frames} frames of {frame} samples of 4 channels, peak {max(peaks):.0f} N"


def verdict(name: str, acquire: Callable[[], str]) -> tuple[str, str, str]:
    """Return name, verdict and what was acquired."""
    try:
        return name, "runs", acquire()
    except ModuleNotFoundError as error:
        return name, "not run", f"needs {error.name}, which is not installed"
    except Exception as error:  # noqa: BLE001
        traceback.print_exc()
        return name, "fails", str(error).strip().splitlines()[0]


def main() -> None:
    """Run both and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the verdicts to this file")
    arguments = parser.parse_args()
    found = [
        verdict("LDAQ 1.3.2 with nidaqwrapper 0.2.0, NI 9250", ldaq),
        verdict("in the way of Rattlesnake, two NI 9234", rattlesnake),
    ]
    for name, word, text in found:
        print(f"{word:8} {name}: {text}", file=sys.stderr)
    if arguments.json:
        arguments.json.write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
