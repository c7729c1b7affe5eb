# SPDX-License-Identifier: MIT
"""Time from a choice at the modal desk to the fitted modes.

Usage: python benchmarks/screen/desk.py [--repeats 10] [--page PAGE.md]

The case is that of `benchmarks/modal`: eight modes with a 0.8 % pair, 40 outputs, 2
inputs, 4096 lines at 40 dB. Times are CPU seconds of one thread and seconds by the
clock, after one warm-up; each choice is made as the browser asks for it.
"""

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "modal"))
from case import benchmark_case

from jointbench.station.desk.desk_choice import ChoiceAction
from jointbench.station.desk.desk_results import save_choices
from jointbench.station.desk.desk_state import (
    DeskState,
    decided,
    desk_state,
    evidence,
    made_choice,
)
from jointbench.station.desk.desk_subject import DeskSubject
from jointbench.station.pipeline.chain import ChainSettings

Row = tuple[str, float, float, float]


def timed(name: str, work: Callable[[], object], repeats: int) -> Row:
    """Return median CPU seconds, the largest, and the median by the clock."""
    work()
    cpu, clock = [], []
    for _ in range(repeats):
        begun, now = time.process_time(), time.perf_counter()
        work()
        cpu.append(time.process_time() - begun)
        clock.append(time.perf_counter() - now)
    return name, float(np.median(cpu)), max(cpu), float(np.median(clock))


def rows(state: DeskState, repeats: int) -> list[Row]:
    """Time every kind of choice from a state with all eight modes."""

    def after(action: ChoiceAction, of: DeskState = state, **what: float) -> DeskState:
        return decided(of, made_choice(action, "benchmark", **what))

    bare = after(ChoiceAction.CLEAR, frequency=450.0, second=457.0)
    table = state.automatic.result.stabilisation
    near = int(np.argmin(np.abs(table.frequency - 310.7)))
    kinds: dict[str, Callable[[], object]] = {
        "choose a pole beside its close neighbour": lambda: after(
            ChoiceAction.CHOOSE, bare, frequency=455.0, order=40
        ),
        "clear one of the close pair": lambda: after(
            ChoiceAction.CLEAR, frequency=450.0, second=457.0
        ),
        "clear a strong mode": lambda: after(
            ChoiceAction.CLEAR, frequency=230.0, second=250.0
        ),
        "merge the close pair": lambda: after(
            ChoiceAction.MERGE, frequency=455.0, second=458.5
        ),
        "pin a pole": lambda: after(ChoiceAction.PIN, frequency=310.7, order=40),
        "undo": lambda: after(ChoiceAction.UNDO, bare),
        "uncertainty and MPC of a pole under the pointer": lambda: evidence(
            state, near
        ),
        "write the results": lambda: save_choices(bare),
    }
    return [timed(name, work, repeats) for name, work in kinds.items()]


def main() -> None:
    """Print the figures, or write them as a page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=10)
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    frf = benchmark_case().noisy(40.0, 1)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "case.txt")
        source.write_text("benchmark", encoding="utf-8")
        results = source.with_name("case-txt.results.h5")
        subject = DeskSubject("case", (source,), results, ChainSettings(), frf=frf)
        found = rows(desk_state(subject), given.repeats)
        found.append(timed("open the desk", lambda: desk_state(subject), 3))
    lines = [
        f"| {name} | {cpu:.3f} | {largest:.3f} | {clock:.3f} |"
        for name, cpu, largest, clock in found
    ]
    load = os.getloadavg()[0]
    text = _PAGE.format(rows="\n".join(lines), repeats=given.repeats, load=load)
    if given.page is None:
        print(text)
    else:
        given.page.write_text(text, encoding="utf-8")


_PAGE = """# The modal desk: time of a refit
Written by `python benchmarks/screen/desk.py --page docs/screen-desk-refit.md`.
40 outputs, 2 inputs, 4096 lines, eight modes with a 0.8 % pair at 40 dB, {repeats}
repetitions of each choice on one thread. The bar of a live refit is one second.

| choice | CPU, median [s] | CPU, largest [s] | by the clock, median [s] |
|---|---|---|---|
{rows}

The computer had other work (load average {load:.1f} on two cores), which the times by
the clock include. A choice in the browser is a refit, the results file and a few
milliseconds of transfer. The refit is one refinement on the weights of the automatic
fit ([record](decisions/0332-refit-on-the-weights-of-the-automatic-fit.md)).
"""

if __name__ == "__main__":
    main()
