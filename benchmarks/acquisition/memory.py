"""Measure the memory of a session of some hours: recording, and every step after it.

    python benchmarks/acquisition/memory.py --hours 4

Recording itself is measured by `load.py`. A session of `--hours` of 4 x 51.2 kS/s is
not waited for: its file is written at the speed of the disk, in the layout that a
recording has when it is killed, with hits of a two-mode structure. `recover`, `verify`,
`modal`, `process` and `export` run on it, each in a process of its own whose memory is
looked at twice a second. Universal files are text, 59 GB for 4 h, so that `export-uff`
is for shorter ones. Every step is added to `memory.json` beside this script;
`docs/bench-memory.md` is written from that file.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
import zlib
from dataclasses import asdict, dataclass
from pathlib import Path

import h5py
import numpy as np

RUNS = Path(__file__).with_name("memory.json")
PAGE = Path(__file__).parents[2] / "docs" / "bench-memory.md"
RATE, BLOCK, CHANNELS = 51_200, 2560, 4
RUN = "from jointbench.station.main import run; run()"
LOOK = 0.5  # [s] between looks at a process
HITS = 60  # of a condition
EVERY, LENGTH, BEFORE = 102_400, 25_600, 512  # samples of a hit and around it
MODES = ((310.0, 0.012), (742.0, 0.008))
POINTS = ("1", "2", "3", "4", "5")
COMMANDS = {
    "recover": "recover {live} --out {done}",
    "verify": "verify {done}",
    "modal": "modal {done} --json {modal}",
    "process": "process {done}",
    "export-netcdf": "export {done} --to netcdf",
    "export-uff": "export {done} --to uff",
}


@dataclass(frozen=True, slots=True)
class Step:
    """One step.

    Attributes:
        name: of the step.
        hours: of signal.
        seconds: that it took [s].
        cpu: of its processes [s].
        peak: largest memory of a process [MB].
        growth: of the memory over the second half of its time [MB a minute].
        code: exit code.
    """

    name: str
    hours: float
    seconds: float
    cpu: float
    peak: float
    growth: float
    code: int


def hit(rng: np.random.Generator, point: int) -> np.ndarray:
    """Return the samples from one hit to the next, shape (CHANNELS, EVERY)."""
    time_ = (np.arange(EVERY) - BEFORE) / RATE
    found = rng.normal(0.0, 0.02, (CHANNELS, EVERY))
    peak = rng.uniform(80.0, 120.0)
    width = 8e-4
    pulse = np.where((time_ > 0) & (time_ < width), np.sin(np.pi * time_ / width), 0.0)
    found[0] += peak * pulse
    for mode, (frequency, damping) in enumerate(MODES):
        omega = 2 * np.pi * frequency
        later = np.maximum(time_ - width / 2, 0.0)
        ring = np.exp(-damping * omega * later) * np.sin(omega * later)
        shape = np.cos((mode + 1) * np.pi * (np.arange(CHANNELS) + 0.3) / CHANNELS)
        struck = np.cos((mode + 1) * np.pi * (point + 0.5) / len(POINTS))
        found[1:] += 0.4 * peak * struck * np.outer(shape[1:], ring * (time_ > 0))
    return found.astype(np.float32)


def write_killed(path: Path, hours: float) -> None:
    """Write the file of a recording that was killed at its end."""
    rng = np.random.default_rng(2026)
    made = [[hit(rng, point) for _ in range(4)] for point in range(len(POINTS))]
    count = round(hours * 3600 * RATE / EVERY)
    log: list[str] = []
    channels = [("hammer", "force", "", "N")]
    channels += [(f"a{n}", "acceleration", POINTS[n - 1], "g") for n in (1, 2, 3)]
    meta = {
        "uuid": "b9",
        "created": "2026-11-23T12:00:00+00:00",
        "software": "jointbench",
        "source": "maker",
        "simulated": True,
        "sample_rate": float(RATE),
        "channels": [
            {
                "name": name,
                "quantity": quantity,
                "point": point,
                "direction": "+z",
                "unit": unit,
                "sensitivity": 1e-3,
                "range": 5e3,
            }
            for name, quantity, point, unit in channels
        ],
    }
    with h5py.File(path, "w", libver="latest") as file:
        file.attrs["schema"] = "jointbench-live/1"
        file.attrs["meta"] = json.dumps(meta)
        samples = file.create_dataset(
            "samples",
            shape=(CHANNELS, count * EVERY),
            maxshape=(CHANNELS, None),
            chunks=(CHANNELS, BLOCK),
            dtype=np.float32,
        )
        rows = []
        for number in range(count):
            condition = number // HITS
            point = condition % len(POINTS)
            first = number * EVERY
            if number % HITS == 0:
                name = f"point {POINTS[point]}, {condition // len(POINTS) + 1}"
                run = {"kind": "run", "name": name, "purpose": "measurement"}
                log.append(json.dumps({**run, "point": POINTS[point], "stored": first}))
            values = made[point][number % 4]
            samples[:, first : first + EVERY] = values
            for begin in range(0, EVERY, BLOCK):
                part = np.ascontiguousarray(values[:, begin : begin + BLOCK])
                rows.append((0, first + begin, BLOCK, zlib.crc32(part.tobytes())))
            log.append(json.dumps(hit_entry(number, point, first, values)))
        data = np.array(rows, dtype=np.int64).T
        file.create_dataset("blocks", data=data, maxshape=(4, None), chunks=(4, 256))
        text = "".join(f"{zlib.crc32(line.encode()):08x} {line}\n" for line in log)
        values8 = np.frombuffer(text.encode(), dtype=np.uint8)
        file.create_dataset("log", data=values8, maxshape=(None,), chunks=(4096,))


def hit_entry(
    number: int, point: int, first: int, values: np.ndarray
) -> dict[str, object]:
    """Return the log entry of a hit."""
    return {
        "kind": "hit",
        "number": number,
        "start": first,
        "trigger": first + BEFORE,
        "stop": first + LENGTH,
        "point": POINTS[point],
        "peak_force": float(values[0].max()),
        "verdict": "ok",
        "measure": 1.0,
        "reason": "made",
        "stored": first + LENGTH,
    }


def memory(process: int) -> tuple[float, float]:
    """Return memory [MB] and CPU time [s] of a process; 0 where it is gone."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except (OSError, IndexError):
        return 0.0, 0.0
    ticks = int(fields[11]) + int(fields[12])
    cpu = ticks / os.sysconf("SC_CLK_TCK")
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6, cpu


def slope(seen: list[tuple[float, float]]) -> float:
    """Return the growth over the second half [MB a minute]; below 10 s, 0."""
    half = [s for s in seen if s[0] >= seen[-1][0] / 2]
    if len(half) < 10 or seen[-1][0] < 10.0:
        return 0.0
    x, y = np.array(half).T
    return float(60.0 * np.polyfit(x, y, 1)[0])


def run_step(name: str, hours: float, arguments: list[str]) -> Step:
    """Run a command and look at its memory."""
    begin = time.monotonic()
    process = subprocess.Popen(
        [sys.executable, "-c", RUN, *arguments], stdout=subprocess.DEVNULL
    )
    seen, cpu = [], 0.0
    while process.poll() is None:
        megabytes, used = memory(process.pid)
        if megabytes:
            seen.append((time.monotonic() - begin, megabytes))
            cpu = max(cpu, used)
        time.sleep(LOOK)
    return Step(
        name,
        hours,
        time.monotonic() - begin,
        cpu,
        max(m for _, m in seen),
        slope(seen),
        process.returncode,
    )


def of_signal(step: Step) -> float:
    """Return the growth of a step per minute of signal [MB a minute]."""
    return step.growth * step.seconds / 3600.0 / step.hours


def row(step: Step) -> str:
    """Return a step as a line of the table."""
    return (
        f"| {step.name} | {step.hours:g} | {step.seconds:.0f} | {step.cpu:.0f} | "
        f"{step.peak:.0f} | {step.growth:+.1f} | {of_signal(step):+.2f} | "
        f"{step.code} |"
    )


def page(steps: list[Step]) -> str:
    """Return the page of all steps."""
    return "\n".join(
        [
            "# Memory of a long session",
            "`python benchmarks/acquisition/memory.py --hours 4`; this command writes "
            "this page.",
            "",
            "The file of a killed recording of 4 channels at 51.2 kS/s is written at "
            "the speed of the disk; it holds a hit every two seconds. Each command "
            "runs in a process of its own, whose memory is read twice a second. The "
            "growth is that of a straight line over the second half of its time, a "
            "minute of that time and a minute of the signal that was read in it.",
            "",
            "| step | signal [h] | time [s] | CPU [s] | largest memory [MB] | growth "
            "[MB/min] | growth [MB/min of signal] | exit code |",
            "|---|---|---|---|---|---|---|---|",
            *(row(step) for step in steps),
            "",
        ]
    )


def note(step: Step) -> None:
    """Put a step in the place of an earlier run of it, and write the page."""
    known = [Step(**s) for s in json.loads(RUNS.read_text())] if RUNS.exists() else []
    others = [s for s in known if (s.hours, s.name) != (step.hours, step.name)]
    names = list(COMMANDS)
    steps = sorted([*others, step], key=lambda s: (-s.hours, names.index(s.name)))
    RUNS.write_text(json.dumps([asdict(s) for s in steps], indent=1) + "\n")
    PAGE.write_text(page(steps), encoding="utf-8")


def main() -> None:
    """Run the steps, and write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--hours", type=float, default=4.0)
    parser.add_argument("--folder", type=Path, default=Path("/tmp/jointbench-memory"))
    parser.add_argument("--steps", default="recover,verify,modal,process,export-netcdf")
    parser.add_argument("--keep", action="store_true", help="keep the folder")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    live = options.folder / "live.h5"
    done = options.folder / "session.h5"
    wanted = options.steps.split(",")
    places = {"live": live, "done": done, "modal": options.folder / "modal.json"}
    try:
        if not done.exists():
            write_killed(live, options.hours)
        for name in wanted:
            arguments = [part.format_map(places) for part in COMMANDS[name].split()]
            step = run_step(name, options.hours, arguments)
            print(row(step), flush=True)
            if name == "recover":
                live.unlink()
            note(step)
    finally:
        if not options.keep:
            shutil.rmtree(options.folder)


if __name__ == "__main__":
    main()
