# SPDX-License-Identifier: MIT
"""Memory and time of `jointbench modal` on made sessions; writes docs/modal-memory.md.

Each run is a process of its own; peak memory is its ru_maxrss, time is CPU time. The
floor is a process that reads the same session and transforms every channel of every
hit once. Data are made with the seeds in `SIZES`: eight modes, one hit a recording.

    python benchmarks/modal/session_memory.py [--sizes 0,1] [--page PAGE.md]
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jointbench.acquisition.records.recordings import Recording

RATE, SECONDS = 51_200.0, 2.0
SIZES = ((8, 10, 1), (16, 20, 2), (16, 50, 3), (64, 20, 4), (64, 200, 5))
"""Channels, hits, seed."""
_MODES = np.linspace(150.0, 2600.0, 8)
_DAMPING = 0.006
_NOISE = 1e-3
_DISTINCT = 50
_MB = 1e6
_FIT = ("--band", "50:3000", "--order", "30")
_MODAL = "from jointbench.station.main import run; run()"
_FLOOR = """
import sys
import scipy.fft
from jointbench.acquisition.session_file.open_session import open_session
for recording in open_session(sys.argv[1], most_whole=0).recordings:
    for row in recording.samples:
        scipy.fft.rfft(row)
"""


@dataclass(frozen=True, slots=True)
class Cost:
    """What a process took.

    Attributes:
        peak: ru_maxrss [bytes].
        cpu: user and system time [s].
    """

    peak: float
    cpu: float


def make_session(path: Path, channels: int, hits: int, seed: int) -> None:
    """Write a session of one hit a recording, its force on channel 1.

    Samples are in single precision, as those of a converter; one recording is in memory
    at a time. Those beyond the first ones are copies: packing takes most of the time.
    """
    from jointbench.acquisition.file_access.create_netcdf import new_file
    from jointbench.acquisition.file_access.netcdf_write import write_attributes
    from jointbench.acquisition.records.session import new_session
    from jointbench.acquisition.session_file.store import (
        SESSION_SCHEMA,
        SESSION_TITLE,
        write_head,
    )
    from jointbench.acquisition.session_file.streams import write_recording
    from jointbench.acquisition.session_file.surfaces_and_setup import write_provenance

    session = new_session(source="made", simulated=True)
    number = min(hits, _DISTINCT)
    made = _recordings(channels, number, np.random.default_rng(seed))
    with new_file(
        path, schema=SESSION_SCHEMA, title=SESSION_TITLE, memory=False
    ) as file:
        write_head(file, session)
        for position, recording in enumerate(made):
            write_recording(file, recording, position)
            file.flush()
        for position in range(_DISTINCT, hits):
            name = f"hit{position}"
            file.copy(f"stream/hit{position % _DISTINCT}", file["stream"], name)
            write_attributes(file["stream"][name], {"name": name, "position": position})
        write_provenance(file, session)


def _recordings(
    channels: int, hits: int, rng: np.random.Generator
) -> Iterator["Recording"]:
    """Yield recordings of one hit each."""
    from jointbench.acquisition.records.recordings import Channel, Quantity, Recording

    count, trigger = round(RATE * SECONDS), 512
    time = np.arange(count - trigger) / RATE
    omega = 2.0 * np.pi * _MODES
    decay = np.exp(np.outer((-_DAMPING + 1j) * omega, time)).imag
    shapes = rng.standard_normal((channels - 1, _MODES.size))
    motion = shapes @ decay
    sensors = [Channel("force", Quantity.FORCE, point="1")] + [
        Channel(f"a{i}", Quantity.ACCELERATION, point=f"{i}")
        for i in range(1, channels)
    ]
    pulse = np.sin(np.pi * np.arange(1, 16) / 16.0)
    for number in range(hits):
        level = 200.0 * (1.0 + 0.3 * rng.random())
        samples = _NOISE * rng.standard_normal((channels, count))
        samples[0] *= 10.0
        samples[0, trigger : trigger + pulse.size] += level * pulse
        samples[1:, trigger + 8 :] += level / 200.0 * motion[:, : motion.shape[1] - 8]
        samples = samples.astype(np.float32).astype(np.float64)
        yield Recording(f"hit{number}", samples, RATE, tuple(sensors))


def cost_of(code: str, *arguments: str) -> Cost:
    """Run Python code in a process of its own; return what it took."""
    command = [sys.executable, "-c", code, *arguments]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as child:
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise RuntimeError(f"{command[3:]} ended with code {child.returncode}")
    return Cost(1024.0 * used.ru_maxrss, used.ru_utime + used.ru_stime)


def row_of(folder: Path, channels: int, hits: int, seed: int) -> str:
    """Return the row of one size, for the page."""
    path = folder / "made.h5"
    code = "import sys; sys.path.insert(0, sys.argv[1]); import session_memory as m; "
    code += "m.make_session(m.Path(sys.argv[2]), *map(int, sys.argv[3:]))"
    here = str(Path(__file__).parent)
    cost_of(code, here, str(path), str(channels), str(hits), str(seed))
    floor = cost_of(_FLOOR, str(path))
    results = str(folder / "made.results.h5")
    modal = cost_of(_MODAL, "modal", str(path), *_FIT, "--out", results)
    path.unlink()
    Path(results).unlink()
    samples = 8.0 * channels * hits * RATE * SECONDS
    sizes = (samples, floor.peak, modal.peak)
    words = " | ".join(f"{size / _MB:.0f}" for size in sizes)
    return (
        f"| {channels} x {hits} | {seed} | {words} "
        f"| {floor.cpu:.1f} | {modal.cpu:.1f} | {modal.cpu / floor.cpu:.1f} |"
    )


HEAD = (
    "| channels x hits | seed | samples as doubles [MB] | peak, read and FFT [MB] | "
    "peak, modal [MB] | CPU, read and FFT [s] | CPU, modal [s] | ratio |\n"
    "|---|---|---|---|---|---|---|---|"
)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure the sizes asked for, print and write their rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", default="0,1,2,3,4")
    parser.add_argument("--page", type=Path)
    given = parser.parse_args(arguments)
    rows = [HEAD]
    with tempfile.TemporaryDirectory() as name:
        for number in map(int, given.sizes.split(",")):
            rows.append(row_of(Path(name), *SIZES[number]))
            sys.stdout.write(f"{rows[-1]}\n")
            sys.stdout.flush()
    if given.page is not None:
        text = given.page.read_text(encoding="utf-8")
        begin, end = text.index("<!-- rows -->"), text.index("<!-- end -->")
        table = "<!-- rows -->\n" + "\n".join(rows) + "\n"
        given.page.write_text(text[:begin] + table + text[end:], encoding="utf-8")


if __name__ == "__main__":
    main()
