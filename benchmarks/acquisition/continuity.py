"""Stream in real time from a server in another process, and count every sample.

    python benchmarks/acquisition/continuity.py --seconds 600 --channels 4 --rate 51200

Prints the CPU of client and store as a share of one core, and the driver's counter
against what was stored.
"""

import argparse
import multiprocessing
import tempfile
import time
from multiprocessing.connection import Connection
from pathlib import Path

import h5py

from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.sensors import Axis, Sensor, table_channels
from jointbench.acquisition.ni.stream import Block, NiStream, StreamSettings
from jointbench.acquisition.records import Quantity
from jointbench.acquisition.session_live import LiveSession
from jointbench.acquisition.session_live_read import read_live


def serve(parent: Connection, modules: int, rate: float) -> None:
    """Serve a chassis in real time."""
    from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis
    from jointbench.simulators.hand import Hand
    from jointbench.simulators.plates_bench import PlatesBench

    bench = PlatesBench(hand=Hand(interval=2.0))
    setup = ChassisSetup(bench=bench, modules=modules, top_rate=rate)
    with SimulatedChassis(setup) as server:
        parent.send(server.address)
        parent.recv()


def sensors(count: int) -> tuple[Sensor, ...]:
    """Return a hammer and accelerometers on the first inputs."""

    def at(n: int) -> str:
        return f"cDAQSim1Mod{n // 4 + 1}/ai{n % 4}"

    hammer = Sensor("f", Quantity.FORCE, "", (Axis(at(0), "+z", 2.25e-3),), "N", 2e3)
    return (
        hammer,
        *(
            Sensor(
                f"a{n}",
                Quantity.ACCELERATION,
                str(n),
                (Axis(at(n), "+z", 1e-3),),
                "m/s^2",
                4e3,
            )
            for n in range(1, count)
        ),
    )


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--channels", type=int, default=4)
    parser.add_argument("--rate", type=float, default=51_200.0)
    options = parser.parse_args()
    here, there = multiprocessing.Pipe()
    context = multiprocessing.get_context("spawn")
    modules = -(-options.channels // 4)
    process = context.Process(target=serve, args=(there, modules, options.rate))
    process.start()
    chassis = Chassis(here.recv())
    rows = sensors(options.channels)
    block = round(0.05 * options.rate)
    stream = NiStream(chassis, rows, StreamSettings(options.rate, block))
    stream.start()
    meta = {"channels": [channel.name for channel in table_channels(rows)]}
    gaps = 0
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "live.h5"
        wall, cpu = time.monotonic(), time.process_time()
        with LiveSession(path, meta, channels=options.channels, block=block) as live:
            for item in stream.items():
                if isinstance(item, Block):
                    live.append(item.samples, segment=item.segment, first=item.first)
                else:
                    gaps += 1
                if stream.counters.delivered >= options.seconds * options.rate:
                    break
            stream.count()
        wall, cpu = time.monotonic() - wall, time.process_time() - cpu
        with h5py.File(path, "r") as file:
            content = read_live(file)
    stream.close()
    chassis.close()
    here.send("done")
    process.join()
    counters = stream.counters
    print(f"- {options.channels} channels x {options.rate:g} Hz for {wall:.1f} s")
    print(
        f"- client and store: {cpu:.2f} s of CPU for {options.seconds:g} s of signal, "
        f"{100 * cpu / options.seconds:.1f} % of one core"
    )
    print(
        f"- device counter {counters.acquired}, still in its buffer {counters.unread}, "
        f"read {counters.delivered}, in the file with a right checksum "
        f"{content.samples}, damaged blocks {content.damaged}"
    )
    lost = counters.acquired - counters.unread - content.samples
    print(f"- lost samples per channel: {lost}; gaps: {gaps}")


if __name__ == "__main__":
    main()
