"""Kill a measurement at random times and check the remaining file.

    python benchmarks/acquisition/kills.py --kills 60 > docs/bench-kills.md

Each child measures the same seeded plan on the simulated chassis; samples depend on
their index only, so the session of a child that is not killed has every sample that a
killed one may contain. A quarter of the kills occur while the file is finished.
"""

import argparse
import multiprocessing
import os
import random
import signal
import tempfile
import time
from collections.abc import Sequence
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.bench_view.text_screen import TextScreen
from jointbench.station.measure.bench_session import measure
from jointbench.station.measure.chassis import open_chassis
from jointbench.station.measure.plan import MeasurePlan, read_plan
from jointbench.station.screen.terminal import console
from jointbench.station.session_events.event_codec import Stamped
from jointbench.station.session_events.view_events import SessionBegun

PLAN = Path(__file__).parents[2] / "examples" / "plates.toml"
SOURCE = "sim:plates?seed=5"


class Reporting(TextScreen):
    """Report to the parent how many samples were passed to the store."""

    def __init__(self, parent: Connection) -> None:
        super().__init__(console("-"))
        self.parent, self.count = parent, 0

    def follow(self, events: Sequence[Stamped]) -> None:
        """Report the start of the recording."""
        if any(isinstance(one.event, SessionBegun) for one in events):
            self.parent.send(self.count)

    def level(self, samples: np.ndarray) -> None:
        """Report how many samples were passed on."""
        self.count += samples.shape[1]
        self.parent.send(self.count)


def short_plan(folder: Path) -> MeasurePlan:
    """Return the example's plan with one torque and two points."""
    text = PLAN.read_text(encoding="utf-8")
    text = text.replace('["1", "2", "3", "4", "5"]', '["1", "2"]')
    text = text.replace('["20 N m", "50 N m", "80 N m"]', '["20 N m"]')
    text = text.replace("repeats = 3", "repeats = 2\ntrial_hits = 1")
    path = folder / "plan.toml"
    path.write_text(text, encoding="utf-8")
    return read_plan(path)


def child(plan: MeasurePlan, out: Path, parent: Connection) -> None:
    """Measure until killed."""
    with open_chassis(SOURCE) as opened:
        measure(plan, opened, out, Reporting(parent))
    parent.send(-1)


def stream(session: Session) -> np.ndarray:
    """Return all samples of a session in their order."""
    return np.concatenate([r.samples for r in session.recordings], axis=1)


def one(plan: MeasurePlan, out: Path, stop_at: int | None, delay: float) -> int:
    """Start a child, kill it at a count and a delay; return the last reported count."""
    here, there = multiprocessing.Pipe(duplex=False)
    process = multiprocessing.get_context("fork").Process(
        target=child, args=(plan, out, there)
    )
    process.start()
    there.close()
    reported = 0
    while True:
        try:
            count = here.recv()
        except EOFError:
            break
        if count < 0:
            break
        reported = count
        if stop_at is not None and reported >= stop_at:
            time.sleep(delay)
            os.kill(process.pid, signal.SIGKILL)
            while here.poll(0.2):
                try:
                    reported = max(reported, here.recv())
                except EOFError:
                    break
            break
    process.join()
    return reported


def main() -> None:
    """Print a page of figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    draw = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plan = short_plan(folder)
        block = round(plan.acquisition.block * plan.acquisition.sample_rate)
        whole = folder / "whole.h5"
        total = one(plan, whole, None, 0.0)
        truth = stream(read_session(whole))
        assert truth.shape[1] == total
        opened = wrong = finished = 0
        lost: list[int] = []
        for number in range(options.kills):
            out = folder / f"{number}.h5"
            late = number % 4 == 3
            stop = total if late else draw.randrange(1, total)
            reported = one(plan, out, stop, draw.uniform(0.0, 0.6 if late else 0.05))
            try:
                session = read_session(out)
            except BadData as error:
                print(f"kill {number}: NOT OPENED: {error}")
                continue
            opened += 1
            if not session.recordings:
                lost.append(reported)
                continue
            found = stream(session)
            wrong += not np.array_equal(found, truth[:, : found.shape[1]])
            lost.append(max(0, reported - found.shape[1]))
            finished += any(s.name == "end" for s in session.provenance)
            out.unlink()
    print("# Killed while recording\n")
    print(f"- kills (`kill -9`): {options.kills}")
    print(f"- files that open: {opened}")
    print(f"- of these, recordings already logged as finished: {finished}")
    print(
        f"- files with a sample that differs from the session without a kill: {wrong}"
    )
    print(
        f"- samples passed to the store but not found: at most {max(lost)}, "
        f"that is {max(lost) / block:.2f} blocks of {block}"
    )
    print(f"- kills that lost nothing: {sum(n == 0 for n in lost)}")


if __name__ == "__main__":
    main()
