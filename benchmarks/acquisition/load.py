"""Measure on a busy computer, and count every sample: the whole of `measure`.

    python benchmarks/acquisition/load.py --minutes 10
    python benchmarks/acquisition/load.py --minutes 1 --channels 16 --rate 102400

The chassis runs in real time in a process of its own; as many other processes as there
are cores do nothing but compute. `jointbench measure` takes 60 hits a point and is
stopped by Ctrl-C. Every run is added to `load.json` beside this script;
`docs/bench-load.md` is written from that file alone.
"""

import argparse
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import h5py
import numpy as np

RUNS = Path(__file__).with_name("load.json")
PAGE = Path(__file__).parents[2] / "docs" / "bench-load.md"
EXAMPLE = Path(__file__).parents[2] / "examples" / "plates.toml"
HITS = """
points = ["1", "2", "3", "4", "5"]
torques = ["20 N m", "50 N m", "80 N m"]
repeats = 60
most_repeats = 60
trial_hits = 0
length = "0.5 s"
"""
SENSOR = """
[[sensors]]
name = "{name}"
quantity = "acceleration"
point = "{name}"
range = "450 g"
physical = "cDAQSim1Mod{module}/ai{row}"
direction = "+z"
sensitivity = "10 mV/g"
"""
RUN = "from jointbench.station.main import run; run()"
EVERY = 5.0  # [s] between looks at the processes
CONTEXT = multiprocessing.get_context("spawn")


@dataclass(frozen=True, slots=True)
class Run:
    """One run.

    Attributes:
        channels: of the task.
        rate: of each [Hz].
        seconds: of signal stored.
        busy: processes that computed meanwhile.
        acquired: by the device's counter, samples per channel.
        unread: of those, in its buffer at the end.
        stored: in the file.
        lost: by counter.
        gaps: in the stream.
        stated: missing samples by the gaps that the program had seen.
        hits: judged.
        recorder: CPU of the recording process [% of a core].
        program: CPU of the measuring program [% of a core].
        recorder_mb: its memory in the second minute (or first look) and at the end.
        program_mb: the same of the measuring program.
        recorder_growth: of its memory from the second minute on, a straight line
            [MB a minute]; None where it was not fitted.
        program_growth: the same of the measuring program.
        in_file: samples per channel in the finished file, None where not counted.
        load: of the computer over one minute at the end [processes].
    """

    channels: int
    rate: float
    seconds: float
    busy: int
    acquired: int
    unread: int
    stored: int
    lost: int
    gaps: int
    stated: int
    hits: int
    recorder: float
    program: float
    recorder_mb: tuple[float, float]
    program_mb: tuple[float, float]
    in_file: int | None
    load: str
    recorder_growth: float | None = None
    program_growth: float | None = None


def growth(seen: list[tuple[float, float]]) -> float | None:
    """Return the growth of memory after the first minute [MB a minute].

    Args:
        seen: time [s] and memory [MB].
    """
    later = [one for one in seen if one[0] - seen[0][0] > 60.0]
    if len(later) < 10:
        return None
    x, y = np.array(later).T
    return float(60.0 * np.polyfit(x, y, 1)[0])


def serve(parent: Connection, modules: int, rate: float) -> None:
    """Serve a chassis in real time."""
    from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis

    setup = ChassisSetup(modules=modules, top_rate=rate)
    with SimulatedChassis(setup) as server:
        parent.send(server.address)
        parent.recv()


def compute() -> None:
    """Keep a core busy."""
    while True:
        sum(n * n for n in range(100_000))


def plan(folder: Path, channels: int, rate: float) -> Path:
    """Write the example's plan with 60 hits a point and 4 channels or more."""
    text = EXAMPLE.read_text(encoding="utf-8").replace("25.6 kHz", f"{rate:g} Hz")
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    extra = [
        SENSOR.format(name=f"x{n}", module=n // 4 + 1, row=n % 4)
        for n in range(4, channels)
    ]
    path = folder / "plan.toml"
    text = "\n".join((head, f"[hits]{HITS}\n[joint]{tail}", *extra))
    path.write_text(text, encoding="utf-8")
    return path


@contextmanager
def surroundings(channels: int, rate: float, busy: int) -> Iterator[str]:
    """Run the chassis and what else keeps the computer busy; yield its address."""
    here, there = CONTEXT.Pipe()
    modules = -(-channels // 4)
    chassis = CONTEXT.Process(target=serve, args=(there, modules, rate))
    chassis.start()
    others = [CONTEXT.Process(target=compute, daemon=True) for _ in range(busy)]
    for process in others:
        process.start()
    try:
        yield here.recv()
    finally:
        for process in others:
            process.kill()
        here.send("done")
        chassis.join()


def recorder_of(lock: Path) -> int | None:
    """Return the process that holds a session file."""
    for entry in Path("/proc").iterdir():
        try:
            held = entry.name.isdigit() and any(
                handle.readlink() == lock for handle in (entry / "fd").iterdir()
            )
        except OSError:
            continue
        if held:
            return int(entry.name)
    return None


def look(process: int) -> tuple[float, float]:
    """Return CPU time [s] and memory [MB] of a process."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    ticks = int(fields[11]) + int(fields[12])
    page = os.sysconf("SC_PAGE_SIZE")
    return ticks / os.sysconf("SC_CLK_TCK"), pages * page / 1e6


def run(minutes: float, channels: int, rate: float, busy: int) -> Run:
    """Measure for some minutes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        out, summary = folder / "s.h5", folder / "s.json"
        file = plan(folder, channels, rate)
        program = [
            sys.executable,
            "-c",
            "from jointbench.station.main import run; run()",
        ]
        with surroundings(channels, rate, busy) as address:
            measuring = subprocess.Popen(
                [
                    *(*program, "measure", str(file), "--out", str(out)),
                    *("--source", f"ni+grpc://{address}", "--json", str(summary)),
                ],
                stdout=subprocess.DEVNULL,
            )
            seen = watch(measuring, folder / "s.h5.lock", 60 * minutes)
            load = f"{os.getloadavg()[0]:.1f}"
            measuring.send_signal(signal.SIGINT)
            measuring.wait()
        in_file = count_finished(out)
        found = json.loads(summary.read_text())
    (begin, (r0, _), (p0, _)), (end, (r1, r_mb), (p1, p_mb)) = seen[0], seen[-1]
    second = next((s for s in seen if s[0] - begin > 60), seen[0])
    return Run(
        channels=channels,
        rate=rate,
        seconds=found["stored_samples"] / rate,
        busy=busy,
        acquired=found["acquired_samples"],
        unread=found["unread_samples"],
        stored=found["stored_samples"],
        lost=found["lost_samples"],
        gaps=len(found["gaps"]),
        stated=sum(gap["samples"] for gap in found["gaps"]),
        hits=len(found["hits"]),
        recorder=100 * (r1 - r0) / (end - begin),
        program=100 * (p1 - p0) / (end - begin),
        recorder_mb=(second[1][1], r_mb),
        program_mb=(second[2][1], p_mb),
        in_file=in_file,
        load=load,
        recorder_growth=growth([(at, mb) for at, (_, mb), _ in seen]),
        program_growth=growth([(at, mb) for at, _, (_, mb) in seen]),
    )


def count_finished(path: Path) -> int:
    """Return the samples per channel of all recordings of a finished session."""
    with h5py.File(path, "r") as file:
        return sum(group["samples"].shape[1] for group in file["stream"].values())


Look = tuple[float, tuple[float, float], tuple[float, float]]


def watch(
    measuring: "subprocess.Popen[bytes]", lock: Path, seconds: float
) -> list[Look]:
    """Look at recording process and program every few seconds."""
    recorder = None
    while recorder is None:
        time.sleep(0.2)
        recorder = recorder_of(lock)
    seen: list[Look] = []
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        seen.append((time.monotonic(), look(recorder), look(measuring.pid)))
        time.sleep(min(EVERY, seconds / 4))
    return [*seen, (time.monotonic(), look(recorder), look(measuring.pid))]


def span(megabytes: tuple[float, float], growth: float | None) -> str:
    """Return memory after a minute and at the end, and its growth a minute."""
    words = f"{megabytes[0]:.0f} to {megabytes[1]:.0f}"
    return words if growth is None else f"{words} ({growth:+.2f})"


def row(run: Run) -> str:
    """Return a run as a line of the table."""
    return (
        f"| {run.channels} x {run.rate:g} Hz | {run.seconds:.0f} | {run.busy} | "
        f"{run.load} | {run.hits} | {run.acquired} | {run.unread} | {run.stored} | "
        f"{run.lost} | {run.gaps} ({run.stated}) | {run.recorder:.1f} | "
        f"{run.program:.1f} | {run.recorder_mb[0]:.0f} to {run.recorder_mb[1]:.0f} | "
        f"{run.program_mb[0]:.0f} to {run.program_mb[1]:.0f} | "
        f"{'not counted' if run.in_file is None else run.in_file} |"
    )


def page(runs: list[Run]) -> str:
    """Return the page of all runs."""
    return "\n".join(
        [
            "# Measuring on a busy computer",
            "`python benchmarks/acquisition/load.py --minutes 10`, with `--channels 16 "
            "--rate 102400` for the second kind; these commands write this page.",
            "",
            "The whole of `jointbench measure`, 60 hits a point, against a simulated "
            "chassis that runs in real time in a process of its own. The computer has "
            "two cores; beside chassis and measurement so many other processes as "
            "stated compute without a pause. Lost samples are those that the device "
            "counted minus those in its buffer minus those in the file. In brackets "
            "are the missing samples of the gaps that the program states. Memory is "
            "that after a minute and that at the end; in brackets its growth from then "
            "on in MB a minute, by a straight line.",
            "",
            "| channels x rate | signal [s] | other processes | load (1 min) | hits "
            "judged | device counter | in its buffer | stored | lost | gaps (stated) | "
            "CPU of reading and storing [% of a core] | CPU of the program [% of a "
            "core] | memory of the recording process [MB] | of the program [MB] | "
            "in the finished file |",
            "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|",
            *(row(run) for run in sorted(runs, key=lambda r: -r.seconds)),
            "",
        ]
    )


def main() -> None:
    """Run once, and write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--channels", type=int, default=4)
    parser.add_argument("--rate", type=float, default=51_200.0)
    parser.add_argument("--busy", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    runs = [Run(**one) for one in json.loads(RUNS.read_text())] if RUNS.exists() else []
    runs.append(run(options.minutes, options.channels, options.rate, options.busy))
    print(row(runs[-1]))
    RUNS.write_text(json.dumps([asdict(one) for one in runs], indent=1) + "\n")
    PAGE.write_text(page(runs), encoding="utf-8")


if __name__ == "__main__":
    main()
