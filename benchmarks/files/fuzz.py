# SPDX-License-Identifier: MIT
"""Mutated files over all readers: read rightly or refused, and nothing else.

    python benchmarks/files/fuzz.py --files 5000 > docs/files-fuzz.md

Every reader gets sound files, written here, with bytes changed, cut, repeated or
swapped. A child process with a cap on its memory and a clock reads them; whatever is
not a refusal in one line (a traceback, a crash, a hang, too much memory) is counted
and shown. "Read" counts files that a reader took, mutated in samples or in nothing
that matters.
"""

import argparse
import multiprocessing
import random
import resource
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

import h5py
import numpy as np
import scipy.io
from scipy.io import wavfile

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.formats.samples.hit_tables import read_recording
from jointbench.acquisition.formats.samples.mat_recording import read_mat_recordings
from jointbench.acquisition.formats.samples.rattlesnake import read_rattlesnake
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.formats.samples.tdms import read_tdms
from jointbench.acquisition.formats.samples.universal import read_universal
from jointbench.acquisition.formats.samples.wave import read_wave
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.records.surfaces import Profile, SurfaceInstrument
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.station.archive.process_file import Task, process_task
from jointbench.station.files.universal_samples import write_universal_samples
from jointbench.station.results.results_read import read_result
from jointbench.station.schemas.recipe import Recipe

MEMORY = 3 * 2**30
"""Address space of a child beyond what it starts with [bytes]."""
RATE = 2048
CLOCK = 20.0
"""Longest time for a file [s]."""
MAT = "time.t:s,force.F:N,acceleration.a1:m/s^2"
TABLE = "time:s,force:N,acceleration:m/s^2"
WAVE = "force:N,acceleration:m/s^2"
Reader = Callable[[Path], object]
READERS: dict[str, tuple[str, Reader]] = {
    "session": ("s.h5", read_session),
    "results": ("r.results.h5", read_result),
    "universal": ("u.uff", lambda p: read_universal(p, columns=None, point="1")),
    "TDMS": ("t.tdms", lambda p: read_tdms(p, columns=None, point="1")),
    "MAT": ("m.mat", lambda p: read_mat_recordings(p, SampleOptions(MAT))),
    "WAV": ("w.wav", lambda p: read_wave(p, columns=WAVE, point="1", full_scale=9)),
    "Rattlesnake": ("n.nc4", lambda p: read_rattlesnake(p, columns=None, point="1")),
    "hits as CSV": ("c.csv", lambda p: read_recording(p, columns=TABLE)),
    "hits as .npy": ("h.npy", lambda p: read_recording(p, columns=TABLE)),
    "surface as CSV": ("f.csv", lambda p: read_surface(p, columns="x:um,z:um")),
}


def recording() -> Recording:
    """Return two hits on two modes, a second each."""
    time_ = np.arange(2 * RATE) / RATE
    force, rings = np.random.default_rng(1).normal(0.0, 1e-3, (2, time_.size))
    omega = 2.0 * np.pi * np.array([[150.0], [420.0]])
    for begin in (0.1, 1.1):
        since = time_ - begin
        on = (since >= 0.0) & (since < 0.003)
        force[on] += 50.0 * np.sin(np.pi * since[on] / 0.003)
        late = np.maximum(since - 0.0015, 0.0)
        decay = np.exp(-0.011 * omega * late) * (since > 0.0015)
        rings += np.sum(decay * np.sin(omega * late), axis=0)
    channels = (
        Channel("force", Quantity.FORCE, "1", unit="N"),
        Channel("a1", Quantity.ACCELERATION, "2", "+z", unit="g"),
    )
    return Recording("r", np.array([force, rings]), float(RATE), channels)


def sound_files(folder: Path) -> None:
    """Write one sound file for each reader."""
    one = recording()
    heights = np.random.default_rng(2).normal(size=400).cumsum() * 1e-7
    face = Profile(
        name="p",
        heights=heights,
        spacing=1e-6,
        valid=np.ones(400, bool),
        instrument=SurfaceInstrument("stylus"),
        provenance=(),
    )
    session = Session(
        *("u", "2025-01-01T00:00:00+00:00", "jointbench", True),
        recordings=(one,),
        surfaces=(face,),
    )
    write_session(session, folder / "s.h5")
    task = Task(folder / "s.h5", folder / "r.results.h5")
    outcome = process_task(task, Recipe(name="r"))
    assert outcome.result.exists(), outcome.reason
    write_universal_samples(folder / "u.uff", session)
    time_ = np.arange(2 * RATE) / RATE
    rows = np.array([time_, *one.samples])
    names = {"t": rows[0], "F": rows[1], "a1": rows[2]}
    scipy.io.savemat(folder / "m.mat", names, do_compression=True)
    counts = np.round(one.samples.T / 60.0 * 32767).astype(np.int16)
    wavfile.write(folder / "w.wav", RATE, counts)
    np.savetxt(folder / "c.csv", rows.T, fmt="%.9g", delimiter=",")
    np.save(folder / "h.npy", rows)
    x = np.arange(400.0)
    np.savetxt(folder / "f.csv", np.c_[x, heights * 1e6], fmt="%.7g", delimiter=",")
    write_rattlesnake(folder / "n.nc4", one)
    write_tdms(folder / "t.tdms", one)


def write_rattlesnake(path: Path, one: Recording) -> None:
    """Write a stream as the controller does."""
    with h5py.File(path, "w") as file:
        file.attrs["sample_rate"] = one.sample_rate
        file.create_dataset("time_data", data=one.samples, chunks=(1, 512))
        table = file.create_group("channels")
        for name, texts in (
            ("node_number", ["1", "2"]),
            ("node_direction", ["Z+", "Z+"]),
            ("unit", ["N", "m/s^2"]),
        ):
            kind = h5py.string_dtype()
            table.create_dataset(name, data=np.array(texts, dtype=object), dtype=kind)


def write_tdms(path: Path, one: Recording) -> None:
    """Write a TDMS file with units and rate."""
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as writer:
        for channel, row, unit in zip(
            one.channels, one.samples, ("N", "m/s^2"), strict=True
        ):
            about = {"unit_string": unit, "wf_increment": 1 / one.sample_rate}
            writer.write_segment([ChannelObject("hits", channel.name, row, about)])


def mutate(data: bytes, draw: random.Random) -> bytes:
    """Return sound bytes with something wrong."""
    changed = bytearray(data)
    kind = draw.randrange(6)
    # Headers are short and samples long: most changes go to the front.
    span = len(changed) if draw.random() < 0.5 else min(len(changed), 2048)
    at = draw.randrange(span)
    length = draw.choice((1, 2, 4, 8, 64))
    if kind == 0:
        for _ in range(draw.choice((1, 3, 20))):
            changed[draw.randrange(span)] = draw.randrange(256)
    elif kind == 1:
        changed = changed[:at]
    elif kind == 2:
        changed[at : at + length] = b"\xff" * length
    elif kind == 3:
        changed[at:at] = changed[at : at + length * 8]
    elif kind == 4:
        del changed[at : at + length]
    else:
        changed[at : at + length] = draw.randbytes(length)
    return bytes(changed)


def read_all(pipe: Connection) -> None:
    """Read files under a memory limit until stopped; send the outcome of each."""
    warnings.simplefilter("ignore")
    with Path("/proc/self/statm").open(encoding="ascii") as file:
        now = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (now + MEMORY, now + MEMORY))
    while True:
        try:
            reader, path = pipe.recv()
        except EOFError:
            return
        try:
            READERS[reader][1](path)
            outcome = ("read", "")
        except JointbenchError as error:
            lines = len(str(error).splitlines())
            outcome = ("refused", "") if lines == 1 else ("many lines", str(error))
        except MemoryError:
            outcome = ("memory", traceback.format_exc(limit=-3))
        except Exception:  # noqa: BLE001 - what is sought
            outcome = ("traceback", traceback.format_exc(limit=-4))
        pipe.send(outcome)


def start() -> tuple[multiprocessing.Process, Connection]:
    """Start a child that reads."""
    ours, theirs = multiprocessing.Pipe()
    context = multiprocessing.get_context("fork")
    child = context.Process(target=read_all, args=(theirs,), daemon=True)
    child.start()
    theirs.close()
    return child, ours  # type: ignore[return-value]


def fuzz(
    files: int, seed: int, folder: Path, make: Callable[[Path], None] = sound_files
) -> tuple[Counter, list[str], float]:
    """Read mutated files; return what became of them, and what must not be."""
    draw = random.Random(seed)
    make(folder)
    sound = {name: (folder / file).read_bytes() for name, (file, _) in READERS.items()}
    found: Counter = Counter()
    wrong: list[str] = []
    slowest = 0.0
    child, pipe = start()
    for number in range(files):
        name = list(READERS)[number % len(READERS)]
        path = folder / f"x-{READERS[name][0]}"
        path.write_bytes(mutate(sound[name], draw))
        begun = time.monotonic()
        pipe.send((name, path))
        try:
            outcome = pipe.recv() if pipe.poll(CLOCK) else ("hang", "")
        except (EOFError, OSError):
            outcome = ("crash", "")
        slowest = max(slowest, time.monotonic() - begun)
        found[name, outcome[0]] += 1
        if outcome[0] not in {"read", "refused"}:
            wrong.append(f"{name}, file {number}: {outcome[0]} {outcome[1]}")
            kept = folder.parent / f"fuzz-{number}-{path.name}"
            kept.write_bytes(path.read_bytes())
            if outcome[0] in {"crash", "hang"}:
                child.kill()
                child.join()
                child, pipe = start()
    pipe.close()
    child.join(5)
    return found, wrong, slowest


def main() -> None:
    """Print a page of figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--files", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        found, wrong, slowest = fuzz(options.files, options.seed, Path(name))
    print("# Mutated files and all readers\n")
    print(f"{options.files} files, seed {options.seed}; each child process may use")
    print(f"3 GiB of additional memory and {CLOCK:g} s per file.\n")
    print("| reader | read | refused in one line | other outcome |")
    print("|---|---|---|---|")
    for reader in READERS:
        row = {kind: n for (who, kind), n in found.items() if who == reader}
        other = sum(n for kind, n in row.items() if kind not in {"read", "refused"})
        print(
            f"| {reader} | {row.get('read', 0)} | {row.get('refused', 0)} | {other} |"
        )
    print(f"\nThe slowest file took {slowest:.1f} s.")
    for line in wrong[:20]:
        print(f"\nNOT: {line}")


if __name__ == "__main__":
    main()
