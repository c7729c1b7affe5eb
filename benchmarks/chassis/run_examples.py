"""Run the example files of nidaqmx-python, unchanged, against the simulated chassis.

    python benchmarks/chassis/run_examples.py ../nidaqmx-python --json examples.json

The launcher supplies the gRPC session, presses Enter, and ends endless loops as Ctrl-C
does. The files need a copy of https://github.com/ni/nidaqmx-python.
"""

import argparse
import builtins
import contextlib
import io
import json
import logging
import os
import runpy
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import grpc
import nidaqmx
import nidaqmx.system
from stand_in import stand_in

from jointbench.simulators.chassis.server import SimulatedChassis

SPEED = 10.0  # seconds of signal per second
PATIENCE = 1.0  # [s] before Enter or Ctrl-C
FILES = (
    *(f"analog_in/{name}" for name in ("*.py",)),
    "channel_properties.py",
    "system_properties.py",
    "every_n_samples_event.py",
)
OTHER_HARDWARE = {
    "analog_in/calculated_power_acq_int_clk.py": "calculated power: a PXIe-4311 only",
    "analog_in/cont_calculated_power_acq_int_clk.py": "calculated power, as above",
    "analog_in/thrmcpl_sample.py": "thermocouple: no temperature module is simulated",
    "analog_in/cont_thrmcpl_samples_int_clk.py": "thermocouple, as above",
    "analog_in/voltage_acq_int_clk_tdms_logging.py": (
        "the driver itself writes a TDMS file: the chassis writes no files for a client"
    ),
}


@contextlib.contextmanager
def session(address: str) -> Iterator[None]:
    """Give every task and system of the client a session at an address."""
    task, local, enter = nidaqmx.Task, nidaqmx.system.System.local, builtins.input
    with grpc.insecure_channel(address) as channel:

        def options(name: str) -> nidaqmx.GrpcSessionOptions:
            return nidaqmx.GrpcSessionOptions(channel, name)

        class RemoteTask(task):  # type: ignore[misc, valid-type]
            """A task on the chassis."""

            def __init__(self, new_task_name: str = "") -> None:
                super().__init__(new_task_name, grpc_options=options(new_task_name))

        def system() -> Any:
            return nidaqmx.system.System.remote(options(""))

        def press_enter(prompt: str = "") -> str:
            time.sleep(PATIENCE)
            return ""

        nidaqmx.Task, builtins.input = RemoteTask, press_enter  # type: ignore[assignment, misc]
        nidaqmx.system.System.local = staticmethod(system)  # type: ignore[method-assign]
        try:
            yield
        finally:
            nidaqmx.Task, builtins.input = task, enter  # type: ignore[misc]
            nidaqmx.system.System.local = local  # type: ignore[method-assign]


def interrupt(number: int, frame: FrameType | None) -> None:
    """End an endless loop."""
    raise KeyboardInterrupt


def run(path: Path) -> tuple[str, str]:
    """Return the verdict on an example, and its last line or its error."""
    output = io.StringIO()
    signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 4 * PATIENCE)
    try:
        with contextlib.redirect_stdout(output), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            runpy.run_path(str(path), run_name="__main__")
    except ModuleNotFoundError as error:
        return "not run", f"needs {error.name}, which is not installed"
    except (Exception, KeyboardInterrupt) as error:  # noqa: BLE001
        first = str(error).strip().splitlines() or [type(error).__name__]
        code = getattr(error, "error_code", "")
        return "fails", f"{code} {first[0]}".strip()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    lines = output.getvalue().replace("\r", "\n").strip().splitlines()
    return "runs", lines[-1][:90] if lines else ""


def main() -> None:
    """Run all examples and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("copy", type=Path, help="copy of nidaqmx-python")
    parser.add_argument("--json", type=Path, help="write the verdicts to this file")
    arguments = parser.parse_args()
    folder = arguments.copy.resolve() / "examples"
    paths = [path for name in FILES for path in sorted(folder.glob(name))]
    os.environ["MPLBACKEND"] = "Agg"
    # Some examples close a task while its last event is on the way.
    logging.getLogger("nidaqmx").setLevel(logging.CRITICAL)
    verdicts = []
    with (
        SimulatedChassis(stand_in(SPEED)) as server,
        session(server.address),
        tempfile.TemporaryDirectory() as scratch,
        contextlib.chdir(scratch),
    ):
        for path in paths:
            name = path.relative_to(folder).as_posix()
            verdict, words = run(path)
            words = OTHER_HARDWARE.get(name, words) if verdict == "fails" else words
            verdicts.append((name, verdict, words))
            print(f"{verdict:8} {name}: {words}", file=sys.stderr)
    if arguments.json:
        arguments.json.write_text(json.dumps(verdicts, indent=1))


if __name__ == "__main__":
    main()
