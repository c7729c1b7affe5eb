# SPDX-License-Identifier: MIT
"""The same archive in a pool and on a LocalCluster over TCP, a worker killed midway.

python benchmarks/files/cluster.py --sessions 400 > docs/reprocessing-cluster.md
"""

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from archive import make_archive
from kills import arguments, timed
from runs import contents, load_words, write_recipe

TIMES = 20
"""Names of each session where nothing is to be done."""


def timed_import() -> float:
    """Return how long Python takes to import Dask's client by itself [s]."""
    begun = time.monotonic()
    subprocess.run([sys.executable, "-c", "import distributed"], check=True)
    return time.monotonic() - begun


def kill_later(cluster: object, results: Path, stop: int, killed: list[float]) -> None:
    """Kill one worker process once so many results are there."""
    while len(list(results.rglob("*.results.h5"))) < stop:
        time.sleep(0.05)
    worker = next(iter(cluster.workers.values()))  # type: ignore[attr-defined]
    os.kill(worker.pid, signal.SIGKILL)
    killed.append(time.monotonic())


def multiplied(folder: Path, archive: Path, results: Path, times: int) -> Path:
    """Give every session with a result so many further names, and its result, too."""
    for result in sorted(results.rglob("*.results.h5")):
        place = result.relative_to(results).parent
        stem = result.name.split(".")[0]
        for number in range(times):
            for source, below, ending in (
                (archive / place / f"{stem}.h5", "many", "h5"),
                (result, "many-results", result.name.partition(".")[2]),
            ):
                target = folder / below / place / f"{stem}-{number}.{ending}"
                target.parent.mkdir(parents=True, exist_ok=True)
                target.hardlink_to(source)
    return folder / "many"


def idle_words(folder: Path, archive: Path, recipe: Path, way: list[str]) -> str:
    """Report the cost of a file and of a start without work, for pool and cluster."""
    many = multiplied(folder, archive, folder / "pool", TIMES)
    few = min(many.iterdir())
    counts = [len(list(place.rglob("*.h5"))) for place in (few, many)]
    times = []
    for kind in ([], way):
        for place in (few, many):
            done = folder / "many-results" / place.relative_to(many)
            times.append(timed([*arguments(place, recipe, done, 2), *kind])[0])
    span = 1e-3 * (counts[1] - counts[0])
    pool, cluster = ((times[i + 1] - times[i]) / span for i in (0, 2))
    return (
        f"- where there is nothing to do, {counts[0]} and {counts[1]} files: pool\n"
        f"  {times[0]:.1f} and {times[1]:.1f} s, cluster {times[2]:.1f} and "
        f"{times[3]:.1f} s: a file costs {pool:.1f} ms\n  in the pool and "
        f"{cluster:.1f} ms on the cluster; the rest is start, of which\n"
        f"  {timed_import():.1f} s are the import of Dask"
    )


def main() -> None:
    """Print a page of figures."""
    from distributed import LocalCluster

    parser = argparse.ArgumentParser()
    parser.add_argument("--sessions", type=int, default=400)
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--archive", type=Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        archive = (options.archive or folder / "archive").absolute()
        if options.archive is None:
            make_archive(archive, sessions=options.sessions, poisoned=8)
        recipe = write_recipe(folder)
        total = len(list(archive.rglob("visit-????.h5")))
        pool, code = timed(arguments(archive, recipe, folder / "pool", 2))
        with LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            protocol="tcp://",
            dashboard_address=None,
        ) as cluster:
            results = folder / "cluster"
            way = ["--scheduler", cluster.scheduler_address]
            way += ["--batch", str(options.batch)]
            args = [*arguments(archive, recipe, results, 2), *way]
            killed: list[float] = []
            watch = threading.Thread(
                target=kill_later, args=(cluster, results, total // 2, killed)
            )
            watch.start()
            dask, dask_code = timed(args)
            watch.join()
            calm, _ = timed([*arguments(archive, recipe, folder / "calm", 2), *way])
            idle = idle_words(folder, archive, recipe, way)
        first, second = contents(folder / "pool"), contents(results)
        sys.stderr.write(f"{len(first)} {len(second)}\n")
    same = sum(second.get(path) == digest for path, digest in first.items())
    print("# Reprocessing on a cluster\n")
    print(f"{total} simulated sessions, 8 poisoned; two workers of one thread each,")
    print(f"batches of {options.batch}, LocalCluster over TCP; {load_words()}.\n")
    print(f"- pool: {pool:.0f} s, exit {code}")
    print(f"- cluster, a worker killed midway ({len(killed)} kill): {dask:.0f} s,")
    print(f"  exit {dask_code}")
    print(f"- cluster unharmed, after that: {calm:.0f} s,")
    print(f"  {1e3 * (calm - pool) / total:+.0f} ms a file beside the pool")
    print(idle)
    print(f"- results equal to the pool's: {same} of {len(first)};")
    print(f"  only one of the two has: {len(set(first) ^ set(second))}\n")
    print("A start is Python, the imports of the command and of every fresh worker")
    print("(scipy, numba, h5py), and the way to the scheduler: once a run or once a")
    print(
        "worker, not once a file. The killed run has the start of three workers in it."
    )


if __name__ == "__main__":
    main()
