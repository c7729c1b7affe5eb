"""How long a hit takes from its last sample to what two more hits would buy.

    python benchmarks/acquisition/after_hit.py

The whole of `measure` at one point, 200 hits at 4 x 51.2 kS/s, the chassis without a
clock; `docs/bench-after-hit.md` is written. In a second session a coherence is asked
for that is never reached, so that after every hit each hit is left out in turn.
"""

import argparse
import os
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.bench_view.text_screen import TextScreen
from jointbench.station.measure import points
from jointbench.station.measure.bench_session import measure
from jointbench.station.measure.chassis import open_chassis
from jointbench.station.measure.plan import read_plan
from jointbench.station.screen.terminal import console

EXAMPLE = Path(__file__).parents[2] / "examples" / "plates.toml"
PAGE = Path(__file__).parents[2] / "docs" / "bench-after-hit.md"
AT = (3, 10, 50, 100, 200)
NEAR = 2  # hits on each side of one of these


@dataclass(frozen=True, slots=True)
class Took:
    """Time of one hit.

    Attributes:
        cpu: of the thread [s].
        wall: [s].
    """

    cpu: float
    wall: float


class Quiet(TextScreen):
    """Print nothing."""

    def __init__(self) -> None:
        super().__init__(console("-"))

    def _print(self, line: str) -> None:
        return


def plan_text(hits: int, coherence: float) -> str:
    """Return the example's plan with one point and many hits."""
    text = EXAMPLE.read_text(encoding="utf-8").replace("25.6 kHz", "51.2 kHz")
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    table = (
        f'[hits]\npoints = ["1"]\ntorques = ["20 N m"]\nrepeats = {hits}\n'
        f"most_repeats = {hits}\ntrial_hits = 0\nmost_rejected = {hits}\n"
        f'length = "0.5 s"\ncoherence = {coherence}\n\n[joint]'
    )
    return head + table + tail


def session(folder: Path, hits: int, coherence: float) -> list[Took]:
    """Measure, and return what each hit took."""
    path, out = folder / "plan.toml", folder / f"{coherence}.h5"
    path.write_text(plan_text(hits, coherence), encoding="utf-8")
    found: list[Took] = []
    take = points.Points.take

    def timed(self: points.Points, cut: CutHit) -> None:
        cpu, wall = time.thread_time(), time.perf_counter()
        take(self, cut)
        found.append(Took(time.thread_time() - cpu, time.perf_counter() - wall))

    points.Points.take = timed  # type: ignore[method-assign]
    try:
        with open_chassis("sim:plates?seed=1") as opened:
            measure(read_plan(path), opened, out, Quiet())
    finally:
        points.Points.take = take  # type: ignore[method-assign]
    log = read_log(out)[0]
    forecasts = [e for e in log if e["kind"] == "gain"]
    if len(forecasts) < hits // 2:
        raise SystemExit(f"only {len(forecasts)} forecasts")
    return found


def rows(name: str, found: list[Took]) -> list[str]:
    """Return the lines of the table of one session."""
    lines = []
    for at in AT:
        near = found[max(0, at - NEAR - 1) : at + NEAR]
        if not near:
            continue
        cpu, wall = ([1e3 * getattr(t, k) for t in near] for k in ("cpu", "wall"))
        lines.append(
            f"| {name} | {at} | {np.median(cpu):.0f} | {max(cpu):.0f} | "
            f"{np.median(wall):.0f} | {max(wall):.0f} |"
        )
    lines.append(
        f"| {name} | all {len(found)} | {1e3 * np.median([t.cpu for t in found]):.0f} "
        f"| {1e3 * max(t.cpu for t in found):.0f} "
        f"| {1e3 * np.median([t.wall for t in found]):.0f} "
        f"| {1e3 * max(t.wall for t in found):.0f} |"
    )
    return lines


def main() -> None:
    """Measure twice, and write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--hits", type=int, default=200)
    parser.add_argument("--page", type=Path, default=PAGE)
    options = parser.parse_args()
    lines = [
        "# After each hit",
        "`python benchmarks/acquisition/after_hit.py`; this command writes this page.",
        "",
        f"`jointbench measure` at one point, {options.hits} hits of 0.5 s at 4 x 51.2 "
        "kS/s. Between the last sample of a hit and the request for the next one are "
        "verdict, averages, FRFs, coherence, the search for a hit that spoils the "
        "average, and what two more hits would buy. CPU time is that of the measuring "
        f"thread; around a hit it is taken over {2 * NEAR + 1} hits. In one "
        "session the coherence that the plan asks for is never reached, so that each "
        "hit is left out in turn, every time. Load of the computer at the end (1 min, "
        "two cores): {load}.",
        "",
        "| session | hits in the average | CPU, median [ms] | CPU, largest [ms] | "
        "time, median [ms] | time, largest [ms] |",
        "|---|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as name:
        for words, coherence in (("coherence not reached", 1 - 1e-12), ("usual", 0.9)):
            new = rows(words, session(Path(name), options.hits, coherence))
            lines += new
            text = "\n".join([*lines, ""])
            text = text.replace("{load}", f"{os.getloadavg()[0]:.1f}")
            options.page.write_text(text, encoding="utf-8")
            print("\n".join(new), flush=True)


if __name__ == "__main__":
    main()
