# SPDX-License-Identifier: MIT
"""Make an archive of simulated sessions, some of them poisoned.

    python benchmarks/files/archive.py FOLDER --sessions 2000 --poisoned 40

The first sessions are measurements of the simulated two-body bench, each with its own
seed, one of four specimens (a folder each) and one of five torques; the others are the
same measurements with fresh sensor noise added, so that no two files agree. A poisoned
file is unusable in one of ten ways; `poison.json` lists them, for the check of the
quarantine.
"""

import argparse
import json
import multiprocessing
import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import Session, new_session
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.station.sources.open_source import open_runs
from jointbench.station.sources.record_source import record_runs

SPECIMENS = 4
TORQUES = (20, 35, 50, 65, 80)
RATE = 6400.0
NOISE = 0.01
"""Standard deviation of the fresh noise, as of the sensors themselves [N, m/s^2]."""


def measurement(number: int) -> Session:
    """Return one simulated session."""
    torque = TORQUES[number // SPECIMENS % len(TORQUES)]
    url = (
        f"sim:two-body?seed={number + 1}&hits=4&interval=0.7&sample_rate={RATE:g}"
        f"&double_rate=0.05&overload_rate=0.05&torque={torque}"
    )
    return record_runs(open_runs(url))


def noisier(session: Session, number: int) -> Session:
    """Return a session with added noise, hits as judged before."""
    rng = np.random.default_rng(number)

    def louder(recording: Recording) -> Recording:
        noise = rng.normal(0.0, NOISE, recording.samples.shape)
        return replace(recording, samples=recording.samples + noise)

    return new_session(
        source=f"{session.source} and noise of seed {number}",
        simulated=True,
        recordings=[louder(recording) for recording in session.recordings],
        joint=session.joint,
    )


def truncated(path: Path) -> None:
    """Cut the last third off."""
    data = path.read_bytes()
    path.write_bytes(data[: 2 * len(data) // 3])


def empty(path: Path) -> None:
    """Leave nothing."""
    path.write_bytes(b"")


def text(path: Path) -> None:
    """Put a table under the name of a session."""
    path.write_text("time;force\n0;1\n", encoding="utf-8")


def external(path: Path) -> None:
    """Point at another file."""
    with h5py.File(path, "a") as file:
        file["stream/more"] = h5py.ExternalLink("/etc/hostname", "/")


def bomb(path: Path) -> None:
    """Unpack a few kilobytes into 2 GB."""
    with h5py.File(path, "a") as file:
        file.create_dataset(
            "stream/zeros", (2**28,), "f8", chunks=(2**20,), compression="gzip"
        )


def variable_length(path: Path) -> None:
    """Hold texts of any length."""
    with h5py.File(path, "a") as file:
        texts = np.array(["a", "bb"], dtype=object)
        file.create_dataset("stream/words", data=texts, dtype=h5py.string_dtype())


def wrong_units(path: Path) -> None:
    """Say that accelerations are stored in g."""
    with h5py.File(path, "a") as file:
        units = next(iter(file["stream"].values()))["si_unit"]
        units[1] = np.frombuffer(b"g".ljust(units.shape[1], b"\0"), "S1")


def later_layout(path: Path) -> None:
    """Claim a layout of the future."""
    with h5py.File(path, "a") as file:
        file.attrs["schema"] = np.bytes_("jointbench-session/9")


def rewritten(path: Path, change: Callable[[Recording], Recording]) -> None:
    """Write the session again with changed recordings."""
    session = read_session(path)
    recordings = tuple(change(recording) for recording in session.recordings)
    whole = new_session(
        source=session.source,
        simulated=True,
        recordings=recordings,
        joint=session.joint,
    )
    write_session(whole, path, overwrite=True)


def no_hits(path: Path) -> None:
    """Leave noise where the hits were."""

    def quiet(recording: Recording) -> Recording:
        rng = np.random.default_rng(1)
        noise = rng.normal(0.0, 1e-3, recording.samples.shape)
        return replace(recording, samples=noise, hits=())

    rewritten(path, quiet)


def no_response(path: Path) -> None:
    """Keep the hammer alone."""

    def alone(recording: Recording) -> Recording:
        force = Channel("force", Quantity.FORCE, "2")
        return replace(recording, samples=recording.samples[:1], channels=(force,))

    rewritten(path, alone)


# What is done to a file, and a word that a true reason for refusing it must hold.
POISONS: dict[str, tuple[Callable[[Path], None], tuple[str, ...]]] = {
    "truncated": (truncated, ("cut short", "damaged")),
    "empty": (empty, ("empty",)),
    "text": (text, ("no HDF5",)),
    "external link": (external, ("link to another file",)),
    "bomb": (bomb, ("bytes of values",)),
    "variable length": (variable_length, ("fixed length",)),
    "wrong units": (wrong_units, ("stored in 'g'",)),
    "later layout": (later_layout, ("layout",)),
    "no hits": (no_hits, ("no force sample", "stand out of the noise", "no hit")),
    "no response": (no_response, ("no response channel",)),
}


def make(task: tuple[Path, int, Path | None]) -> None:
    """Write one session: a new one, or an earlier one with other noise."""
    path, number, base = task
    path.parent.mkdir(parents=True, exist_ok=True)
    whole = measurement(number) if base is None else noisier(read_session(base), number)
    write_session(whole, path, overwrite=True)


def make_archive(
    folder: Path,
    *,
    sessions: int,
    poisoned: int,
    measurements: int = 250,
    jobs: int = 2,
    seed: int = 1,
) -> dict[str, str]:
    """Write an archive; return the kind of poison of each poisoned file."""
    draw = random.Random(seed)
    kinds = list(POISONS)
    paths = [
        folder / f"plate-{i % SPECIMENS}" / f"visit-{i:04d}.h5" for i in range(sessions)
    ]
    first = [(path, i, None) for i, path in enumerate(paths[:measurements])]
    rest = [
        (paths[i], i, paths[i % measurements]) for i in range(measurements, sessions)
    ]
    with multiprocessing.get_context("forkserver").Pool(jobs) as pool:
        for tasks in (first, rest):
            for _ in pool.imap_unordered(make, tasks, chunksize=4):
                pass
    named = {}
    for number, place in enumerate(sorted(draw.sample(range(sessions), poisoned))):
        kind = kinds[number % len(kinds)]
        POISONS[kind][0](paths[place])
        named[str(paths[place].absolute())] = kind
    (folder / "poison.json").write_text(json.dumps(named, indent=1), encoding="utf-8")
    return named


def main() -> None:
    """Write the archive."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--sessions", type=int, default=2000)
    parser.add_argument("--poisoned", type=int, default=40)
    parser.add_argument("--visits", type=int, default=250)
    options = parser.parse_args()
    named = make_archive(
        options.folder,
        sessions=options.sessions,
        poisoned=options.poisoned,
        measurements=options.visits,
    )
    print(f"{options.sessions} sessions, {len(named)} of them poisoned")


if __name__ == "__main__":
    main()
