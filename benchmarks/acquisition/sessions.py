"""Whole sessions on the simulated chassis: hits of every kind, drops, and modes.

    python benchmarks/acquisition/sessions.py > docs/bench-sessions.md

Two hundred hits, thirty of them double, twenty overloaded, twenty weak, in random
order, and the trigger at the very edge of each; a server that goes away ten times; and
three torques x five points x three hits from `measure` to the modes, against the
specimen's own natural frequencies.
"""

import argparse
import math
import random
import re
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.records.recordings import Quantity, Verdict
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import read_session
from jointbench.signal.hits.live_hits import HitCutter
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis
from jointbench.simulators.measuring.operator import Fate, SimulatedOperator
from jointbench.simulators.plates.plates import PlatesDesign, natural_frequencies
from jointbench.simulators.plates.plates_bench import PlatesBench
from jointbench.station.bench_view.text_screen import TextScreen
from jointbench.station.measure.bench_session import Measured, measure
from jointbench.station.measure.chassis import (
    OpenChassis,
    OperatorOfSimulation,
    open_chassis,
)
from jointbench.station.measure.plan import read_plan
from jointbench.station.pipeline.chain import run_chain
from jointbench.station.pipeline.recordings_by_preload import by_preload
from jointbench.station.screen.terminal import console

EXAMPLE = Path(__file__).parents[2] / "examples" / "plates.toml"
VERDICTS = {
    Fate.GOOD: Verdict.OK,
    Fate.DOUBLE: Verdict.DOUBLE,
    Fate.OVERLOAD: Verdict.OVERLOAD,
    Fate.WEAK: Verdict.WEAK,
}


class Quiet(TextScreen):
    """Print nothing."""

    def __init__(self) -> None:
        super().__init__(console("-"))

    def _print(self, line: str) -> None:
        return


def plan_text(hits: str) -> str:
    """Return the example with another [hits] table."""
    text = EXAMPLE.read_text(encoding="utf-8")
    return re.sub(r"\[hits\].*?\[joint\]", f"[hits]\n{hits}\n[joint]", text, flags=re.S)


def fates(seed: int) -> tuple[Fate, ...]:
    """Return two hundred fates in random order, a good one last."""
    bad = [Fate.DOUBLE] * 30 + [Fate.OVERLOAD] * 20 + [Fate.WEAK] * 20
    drawn = bad + [Fate.GOOD] * 129
    random.Random(seed).shuffle(drawn)
    return (*drawn, Fate.GOOD)


def many_hits(folder: Path, seed: int) -> None:
    """Print how two hundred hits were judged."""
    path = folder / "hits.toml"
    hits = (
        'points = ["1", "2", "3", "4", "5"]\ntorques = ["20 N m", "50 N m"]\n'
        'levels = ["150 N"]\nrepeats = 13\nmost_repeats = 13\ntrial_hits = 0\n'
        'most_rejected = 100\nlength = "0.5 s"'
    )
    path.write_text(plan_text(hits).replace("25.6 kHz", "12.8 kHz"), encoding="utf-8")
    bench = PlatesBench(
        operator=SimulatedOperator(seed=seed, fates=fates(seed)), seed=seed
    )
    with SimulatedChassis(ChassisSetup(bench=bench, speed=math.inf)) as server:
        chassis = Chassis(server.address)
        opened = OpenChassis(chassis, "sim:", True, OperatorOfSimulation(chassis))
        out = folder / "hits.h5"
        measured = measure(read_plan(path), opened, out, Quiet())
        chassis.close()
        wanted = [VERDICTS[stroke.fate] for stroke in server.history]
    found = [hit.verdict for hit in measured.record.hits]
    wrong = sum(a is not b for a, b in zip(wanted, found, strict=True))
    session = read_session(out)
    stored = [h for r in session.recordings for h in r.hits]
    averaged = sum(
        hit.verdict is Verdict.OK and want is not Verdict.OK
        for hit, want in zip(stored, wanted, strict=True)
    )
    counts = Counter(word.value for word in found)
    print(f"- strokes {len(wanted)}, hits found {len(found)}: {dict(counts)}")
    print(f"- wrong verdicts: {wrong}; bad hits in an average: {averaged}")
    edges(session)


def edges(session: Session) -> None:
    """Print whether a sample exactly at the level fires, and one a rounding below."""
    at, below, count = 0, 0, 0
    for recording in session.recordings:
        force = recording.samples[recording.row(Quantity.FORCE)]
        for hit in recording.hits:
            edge = float(force[hit.trigger])
            cut = force[hit.start : hit.stop]
            at += _fires(cut, edge) == hit.trigger - hit.start
            next_level = float(np.nextafter(edge, np.inf))
            below += _fires(cut, next_level) == hit.trigger - hit.start
            count += 1
    print(
        f"- trigger level equal to the sample at the edge of each hit: {at} of {count} "
        f"trigger at that sample; one rounding step above it: {below} trigger there"
    )


def _fires(force: FloatArray, level: float) -> int | None:
    """Return the sample at which the program's trigger fires."""
    cutter = HitCutter(row=0, level=level, before=force.size, after=1)
    hit = cutter.feed(force[None])
    return None if hit is None else hit.start + hit.trigger


def drops(folder: Path) -> None:
    """Print what ten drops of the server did."""
    faults = ",".join(f"drop@{20_000 + 21_000 * n}:0.3" for n in range(10))
    path = folder / "drops.toml"
    hits = (
        'points = ["1", "2", "3", "4", "5"]\ntorques = ["20 N m"]\n'
        'repeats = 3\ntrial_hits = 1\nlength = "0.5 s"'
    )
    path.write_text(plan_text(hits).replace("25.6 kHz", "12.8 kHz"), encoding="utf-8")
    out = folder / "drops.h5"
    with open_chassis(f"sim:plates?seed=3&faults={faults}") as opened:
        measured = measure(read_plan(path), opened, out, Quiet())
    session = read_session(out)
    noted = [dict(s.detail) for s in session.provenance if s.name == "gap"]
    back = [gap for gap in noted if gap["what"] == "back"]
    print(f"- plan measured completely: {measured.whole}")
    print(f"- losses recorded in the file: {sum(g['what'] == 'lost' for g in noted)}")
    print(
        f"- reconnections recorded: {len(back)}, "
        f"after {min(g['seconds'] for g in back):.2f} to "
        f"{max(g['seconds'] for g in back):.2f} s"
    )


def modes(folder: Path) -> None:
    """Print modes against the specimen's own."""
    out = folder / "modes.h5"
    with open_chassis("sim:plates?seed=1") as opened:
        measured: Measured = measure(read_plan(EXAMPLE), opened, out, Quiet())
    print(
        f"- hits {len(measured.record.hits)}, conditions {measured.record.done}, lost "
        f"samples {measured.counters.lost}\n"
    )
    print("| torque [N m] | true modes in band | found | largest error [%] |")
    print("|---|---|---|---|")
    for preload, recordings in by_preload(read_session(out).recordings):
        torque = (preload or 0.0) * 0.2 * 0.016 / 4
        result = run_chain(recordings).result
        found = result.model.natural_frequency
        own = natural_frequencies(PlatesDesign(), torque)
        own = own[(own > max(100.0, result.band[0])) & (own < result.band[1])]
        nearest = found[np.argmin(np.abs(found[:, None] - own), axis=0)]
        error = np.abs(nearest / own - 1)
        print(
            f"| {torque:g} | {own.size} | {np.count_nonzero(error < 2e-3)} | "
            f"{100 * error.max():.4f} |"
        )


def main() -> None:
    """Print a page of figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print("# Sessions on the simulated chassis\n\n## Two hundred hits\n")
        many_hits(folder, options.seed)
        print("\n## A server that is lost ten times\n")
        drops(folder)
        print("\n## From measure to modes: 3 torques x 5 points x 3 hits\n")
        modes(folder)


if __name__ == "__main__":
    main()
