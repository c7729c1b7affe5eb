"""Stream in real time from a server in another process, and count every sample.

    python benchmarks/acquisition/continuity.py --seconds 600 --channels 4 --rate 51200
    python benchmarks/acquisition/continuity.py --search --seconds 20

Every run is added to `continuity.json` beside this script, with the driver's counter
against what was stored, the CPU of client and store, and the load of the computer;
`docs/bench-continuity.md` is written from that file alone. The search takes more
channels and samples a second until a run does not hold, and continues where an earlier
search ended.
"""

import argparse
import json
import multiprocessing
import os
import tempfile
import time
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import h5py

from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.sensors import Axis, Sensor, table_channels
from jointbench.acquisition.ni.stream import Block, NiStream, StreamSettings
from jointbench.acquisition.records.recordings import Quantity
from jointbench.acquisition.session_file.live_read import read_live
from jointbench.acquisition.session_file.live_write import LiveSession

RUNS = Path(__file__).with_name("continuity.json")
PAGE = Path(__file__).parents[2] / "docs" / "bench-continuity.md"
LADDER = (
    *((4, 51_200.0), (8, 51_200.0), (16, 51_200.0), (16, 102_400.0), (32, 102_400.0)),
    *((48, 102_400.0), (64, 102_400.0), (64, 204_800.0)),
    *((96, 204_800.0), (128, 204_800.0), (128, 409_600.0), (128, 819_200.0)),
)
LATE = 1.0
"""A run holds if the device is no further ahead than this at its end [s]."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run.

    Attributes:
        channels: of the task.
        rate: of each [Hz].
        seconds: of signal.
        wall: that it took [s].
        cpu: of client and store [s].
        acquired: by the device's counter, samples per channel.
        unread: of those, still in its buffer at the end.
        read: by the client.
        stored: in the file with a right checksum.
        damaged: blocks with a wrong one.
        gaps: in the stream.
        load: of the computer over five minutes, and when it was read [processes].
        search: whether it belongs to a search.
    """

    channels: int
    rate: float
    seconds: float
    wall: float
    cpu: float
    acquired: int
    unread: int
    read: int
    stored: int
    damaged: int
    gaps: int
    load: str
    search: bool

    @property
    def lost(self) -> int:
        """Samples per channel that are neither waiting nor stored."""
        return self.acquired - self.unread - self.stored

    @property
    def holds(self) -> bool:
        """Whether nothing was lost and the client kept up."""
        whole = self.lost == 0 and self.gaps == 0 and self.damaged == 0
        return whole and self.unread <= LATE * self.rate


def serve(parent: Connection, modules: int, rate: float) -> None:
    """Serve a chassis in real time."""
    from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis
    from jointbench.simulators.measuring.operator import SimulatedOperator
    from jointbench.simulators.plates.plates_bench import PlatesBench

    bench = PlatesBench(operator=SimulatedOperator(interval=2.0))
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


def stream_for(seconds: float, channels: int, rate: float, *, search: bool) -> Run:
    """Stream for a while and count."""
    here, there = multiprocessing.Pipe()
    context = multiprocessing.get_context("spawn")
    process = context.Process(target=serve, args=(there, -(-channels // 4), rate))
    process.start()
    chassis = Chassis(here.recv())
    rows = sensors(channels)
    block = round(0.05 * rate)
    stream = NiStream(chassis, rows, StreamSettings(rate, block))
    stream.start()
    meta = {"channels": [channel.name for channel in table_channels(rows)]}
    gaps = 0
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "live.h5"
        wall, cpu = time.monotonic(), time.process_time()
        with LiveSession(path, meta, channels=channels, block=block) as live:
            for item in stream.items():
                if isinstance(item, Block):
                    live.append(item.samples, segment=item.segment, first=item.first)
                else:
                    gaps += 1
                if stream.counters.delivered >= seconds * rate:
                    break
            stream.count()
        wall, cpu = time.monotonic() - wall, time.process_time() - cpu
        stored, damaged = count_stored(path)
    stream.close()
    chassis.close()
    here.send("done")
    process.join()
    counters = stream.counters
    return Run(
        channels=channels,
        rate=rate,
        seconds=seconds,
        wall=wall,
        cpu=cpu,
        acquired=counters.acquired,
        unread=counters.unread,
        read=counters.delivered,
        stored=stored,
        damaged=damaged,
        gaps=gaps,
        load=f"{os.getloadavg()[1]:.1f}",
        search=search,
    )


def count_stored(path: Path) -> tuple[int, int]:
    """Return samples with a right checksum, and blocks with a wrong one."""
    with h5py.File(path, "r") as file:
        content = read_live(file)
    return content.samples, content.damaged


def page(runs: list[Run]) -> str:
    """Return the page of all runs."""
    lines = [
        "# Streaming in real time",
        "`python benchmarks/acquisition/continuity.py --seconds 600` and `--search "
        "--seconds 20`; this page is written by it.",
        "",
        "The simulated chassis serves in another process, on the same two cores. Lost "
        "is the device's counter, less what still waits in its buffer, less what is in "
        "the file with a right checksum. Load is the five-minute load average at the "
        "end of the run, all programs together: above 2 the two cores were shared.",
        "",
        "## Runs, longest first",
        "",
        "| channels x rate | signal [s] | CPU of client and store [% of a core] | "
        "device counter | in its buffer | stored | lost | gaps | load |",
        "|---|---|---|---|---|---|---|---|---|",
        *(row(r) for r in sorted(runs, key=lambda r: -r.seconds) if not r.search),
    ]
    found = [run for run in runs if run.search]
    if found:
        best = max(
            (run for run in found if run.holds),
            key=lambda run: run.channels * run.rate,
            default=None,
        )
        lines += [
            "",
            "## The most that holds",
            "",
            f"Each point takes {found[0].seconds:g} s; it holds where nothing is lost "
            f"and the device is at most {LATE:g} s ahead at the end.",
            "",
            "| channels x rate | million samples a second | CPU of client and store [% "
            "of a core] | late at the end [s] | lost | holds | load |",
            "|---|---|---|---|---|---|---|",
            *(point(run) for run in found),
            "",
            "None holds."
            if best is None
            else f"The most that held: {best.channels} channels x {best.rate:g} Hz.",
        ]
    return "\n".join([*lines, ""])


def row(run: Run) -> str:
    """Return a long run as a line of the table."""
    return (
        f"| {run.channels} x {run.rate:g} Hz | {run.seconds:g} | "
        f"{100 * run.cpu / run.seconds:.1f} | {run.acquired} | {run.unread} | "
        f"{run.stored} | {run.lost} | {run.gaps} | {run.load} |"
    )


def point(run: Run) -> str:
    """Return a point of the search as a line of the table."""
    share, late = 100 * run.cpu / run.seconds, run.unread / run.rate
    return (
        f"| {run.channels} x {run.rate:g} Hz | {run.channels * run.rate / 1e6:.2f} | "
        f"{share:.1f} | {late:.2f} | {run.lost} | "
        f"{'yes' if run.holds else 'no'} | {run.load} |"
    )


def main() -> None:
    """Run, remember, write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--channels", type=int, default=4)
    parser.add_argument("--rate", type=float, default=51_200.0)
    parser.add_argument("--search", action="store_true")
    options = parser.parse_args()
    runs = [Run(**run) for run in json.loads(RUNS.read_text())] if RUNS.exists() else []
    if options.search:
        runs = [run for run in runs if not run.search or run.holds]
        held = {(run.channels, run.rate) for run in runs if run.search}
        for channels, rate in LADDER:
            if (channels, rate) in held:
                continue
            runs.append(stream_for(options.seconds, channels, rate, search=True))
            print(point(runs[-1]), flush=True)
            if not runs[-1].holds:
                break
    else:
        one = (options.channels, options.rate)
        runs.append(stream_for(options.seconds, *one, search=False))
        print(row(runs[-1]))
    RUNS.write_text(json.dumps([asdict(run) for run in runs], indent=1) + "\n")
    PAGE.write_text(page(runs), encoding="utf-8")


if __name__ == "__main__":
    main()
