"""The same archive in a pool and on a LocalCluster over TCP, a worker killed midway.

python benchmarks/files/cluster.py --sessions 400 > docs/reprocessing-cluster.md
"""

import argparse
import os
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path

from archive import make_archive
from kills import arguments, timed
from runs import contents, load_words, write_recipe


def kill_later(cluster: object, results: Path, stop: int, killed: list[float]) -> None:
    """Kill one worker process once so many results are there."""
    while len(list(results.rglob("*.results.h5"))) < stop:
        time.sleep(0.05)
    worker = next(iter(cluster.workers.values()))  # type: ignore[attr-defined]
    os.kill(worker.pid, signal.SIGKILL)
    killed.append(time.monotonic())


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
        idle, _ = timed(arguments(archive, recipe, folder / "pool", 2))
        with LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            protocol="tcp://",
            dashboard_address=None,
        ) as cluster:
            results = folder / "cluster"
            args = [*arguments(archive, recipe, results, 2), "--scheduler"]
            args += [cluster.scheduler_address, "--batch", str(options.batch)]
            killed: list[float] = []
            watch = threading.Thread(
                target=kill_later, args=(cluster, results, total // 2, killed)
            )
            watch.start()
            dask, dask_code = timed(args)
            watch.join()
            again, _ = timed(args)
            whole = [*arguments(archive, recipe, folder / "calm", 2), "--scheduler"]
            whole += [cluster.scheduler_address, "--batch", str(options.batch)]
            calm, _ = timed(whole)
        first, second = contents(folder / "pool"), contents(results)
        sys.stderr.write(f"{len(first)} {len(second)}\n")
    same = sum(second.get(path) == digest for path, digest in first.items())
    print("# Reprocessing on a cluster\n")
    print(f"{total} simulated sessions, 8 poisoned; two workers of one thread each,")
    print(f"batches of {options.batch}, LocalCluster over TCP; {load_words()}.\n")
    print(f"- pool: {pool:.0f} s, exit {code}; with all done {idle:.1f} s")
    print(f"- cluster, a worker killed midway ({len(killed)} kill): {dask:.0f} s,")
    print(f"  exit {dask_code}; with all done {again:.1f} s")
    print(f"- cluster unharmed, after that: {calm:.0f} s,")
    print(f"  {1e3 * (calm - pool) / total:+.0f} ms a file beside the pool")
    print("- overhead where there is nothing to do:")
    print(f"  {1e3 * (again - idle) / total:+.1f} ms a file beside the pool")
    print(f"- results equal to the pool's: {same} of {len(first)};")
    print(f"  only one of the two has: {len(set(first) ^ set(second))}")


if __name__ == "__main__":
    main()
