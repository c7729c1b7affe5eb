"""Kill recordings at random times and check the files that remain.

    python benchmarks/acquisition/kills.py --kills 60 --ends 20

Each child measures, or records, the same seeded plan on the simulated chassis; samples
depend on their index only, so the session of a child that is not killed has every
sample that a killed one may contain. Killed are in turn the program, its recording
process, and both; a quarter of the kills occur while the file is finished. SIGTERM and
SIGHUP go to the program. Rows are kept in `kills.json` beside this script;
`docs/bench-kills.md` is written from that file.
"""

import argparse
import json
import multiprocessing
import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.basics.errors import BadData, JointbenchError
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.bench_view.text_screen import TextScreen
from jointbench.station.continuous.record_plan import read_record_plan
from jointbench.station.continuous.record_runs import RunsRecord, record_plan
from jointbench.station.measure.bench_session import measure
from jointbench.station.measure.chassis import open_chassis
from jointbench.station.measure.plan import read_plan
from jointbench.station.screen.interrupt import interruptible
from jointbench.station.screen.terminal import console
from jointbench.station.session_events.event_codec import Stamped
from jointbench.station.session_events.view_events import SessionBegun

EXAMPLES = Path(__file__).parents[2] / "examples"
RUNS = Path(__file__).with_name("kills.json")
PAGE = Path(__file__).parents[2] / "docs" / "bench-kills.md"
SOURCES = {"measure": "sim:plates?seed=5", "record": "sim:spindle?seed=1&rpm=3000"}
VICTIMS = ("program", "recording process", "both")
LATE = 60.0  # [s] in which a recording process that was left alone has finished


@dataclass(frozen=True, slots=True)
class Row:
    """What kills of one kind came to.

    Attributes:
        command: that was killed.
        signal: name of the signal.
        victim: that got it.
        times: how often.
        opened: files that could be read at once.
        finished: files that were finished sessions in the end.
        wrong: files with a sample that differs.
        most_lost: samples that the program had seen and the file has not.
        block: samples of a block.
        whole: files that lost nothing.
    """

    command: str
    signal: str
    victim: str
    times: int
    opened: int
    finished: int
    wrong: int
    most_lost: int
    block: int
    whole: int


@dataclass(frozen=True, slots=True)
class Found:
    """What one kill left."""

    opened: bool
    finished: bool
    wrong: bool
    lost: int


class Reporting(TextScreen):
    """Report to the parent how many samples were passed on."""

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

    def _print(self, line: str) -> None:
        return


def plan_file(command: str, folder: Path) -> Path:
    """Write a short plan."""
    path = folder / f"{command}.toml"
    if command == "measure":
        text = (EXAMPLES / "plates.toml").read_text(encoding="utf-8")
        text = text.replace('["1", "2", "3", "4", "5"]', '["1", "2"]')
        text = text.replace('["20 N m", "50 N m", "80 N m"]', '["20 N m"]')
        text = text.replace("repeats = 3", "repeats = 2\ntrial_hits = 1")
    else:
        text = (EXAMPLES / "operating.toml").read_text(encoding="utf-8")
        text = text.replace('block = "0.25 s"', 'block = "0.05 s"')
        text = text.replace('"120 s"', '"20 s"')
    path.write_text(text, encoding="utf-8")
    return path


def child(command: str, plan: Path, out: Path, parent: Connection) -> None:
    """Measure or record until killed."""
    with (
        suppress(JointbenchError, KeyboardInterrupt),
        interruptible(),
        open_chassis(SOURCES[command]) as opened,
    ):
        view = Reporting(parent)
        if command == "measure":
            measure(read_plan(plan), opened, out, view)
        else:
            record_plan(read_record_plan(plan), opened, out, view, RunsRecord())
    parent.send(-1)


def stream(session: Session) -> np.ndarray:
    """Return all samples of a session in their order."""
    if not session.recordings:
        return np.empty((0, 0))
    return np.concatenate([r.samples for r in session.recordings], axis=1)


def recorder_of(program: int) -> int | None:
    """Return the number of the recording process: a child of a child."""
    parents = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
            parents[int(folder.name)] = int(fields[1])
    children = {n for n, parent in parents.items() if parent == program}
    return next((n for n, parent in parents.items() if parent in children), None)


def kill(program: BaseProcess, number: signal.Signals, victim: str) -> None:
    """Send a signal."""
    recorder = recorder_of(program.pid) if victim != "program" else None
    victims = (recorder, program.pid if victim != "recording process" else None)
    for one in victims:
        if one is not None:
            with suppress(ProcessLookupError):
                os.kill(one, number)


def counts(here: Connection) -> Iterator[int]:
    """Yield what the child reports, until its last word."""
    with suppress(EOFError):
        while (count := here.recv()) >= 0:
            yield count


def run(
    command: str,
    plan: Path,
    out: Path,
    stop_at: int,
    act: Callable[[BaseProcess], None],
) -> int:
    """Start a child, act on it at a count; return the last count that it reported."""
    here, there = multiprocessing.Pipe(duplex=False)
    context = multiprocessing.get_context("fork")
    process = context.Process(target=child, args=(command, plan, out, there))
    process.start()
    there.close()
    reported, acted = 0, False
    for count in counts(here):
        reported = count
        if not acted and reported >= stop_at:
            acted = True
            act(process)
    process.join()
    return reported


def examine(out: Path, truth: np.ndarray, reported: int) -> Found:
    """Read a file at once, and again when it is at rest."""
    try:
        at_once = stream(read_session(out))
    except BadData as error:
        print(f"NOT OPENED: {error}", file=sys.stderr)
        return Found(opened=False, finished=False, wrong=False, lost=reported)
    until = time.monotonic() + LATE
    while is_held(out) and time.monotonic() < until:
        time.sleep(0.2)
    found = stream(read_session(out))
    wrong = any(
        s.size and not np.array_equal(s, truth[:, : s.shape[1]])
        for s in (at_once, found)
    )
    with h5py.File(out, "r", libver="latest", swmr=True) as file:
        finished = "live" not in str(file.attrs["schema"])
    return Found(
        opened=True,
        finished=finished,
        wrong=wrong,
        lost=max(0, reported - min(at_once.shape[1], found.shape[1])),
    )


def series(
    command: str, number: signal.Signals, victim: str, times: int, folder: Path
) -> Row:
    """Send a signal so many times and count what it left."""
    draw = random.Random(f"{command} {number} {victim}")
    plan = plan_file(command, folder)
    if command == "measure":
        acquisition = read_plan(plan).acquisition
    else:
        acquisition = read_record_plan(plan).table.acquisition
    block = round(acquisition.block * acquisition.sample_rate)
    whole = folder / f"{command}-whole.h5"
    if not whole.exists():
        run(command, plan, whole, sys.maxsize, lambda process: None)
    truth = stream(read_session(whole))
    found = []
    for position in range(times):
        late = position % 4 == 3
        stop = truth.shape[1] if late else draw.randrange(1, truth.shape[1])
        delay = draw.uniform(0.0, 0.6 if late else 0.05)

        def act(process: BaseProcess, delay: float = delay) -> None:
            time.sleep(delay)
            kill(process, number, victim)

        out = folder / "killed.h5"
        reported = run(command, plan, out, stop, act)
        found.append(examine(out, truth, reported))
        for left in folder.glob("killed.h5*"):
            left.unlink()
    return Row(
        command,
        number.name,
        victim,
        times,
        sum(f.opened for f in found),
        sum(f.finished for f in found),
        sum(f.wrong for f in found),
        max(f.lost for f in found),
        block,
        sum(f.lost == 0 for f in found),
    )


def page(rows: list[Row]) -> str:
    """Return the page of all rows."""
    lines = [
        "# Killed while recording",
        "`python benchmarks/acquisition/kills.py --kills 60 --ends 20`; this command "
        "writes this page.",
        "",
        "A session of the simulated chassis is measured, or a run recorded, and killed "
        "at a random time: the program, its recording process, or both. A quarter of "
        "the kills comes after the last sample, while the file is finished. The file "
        "is read at once, and again when no process writes it any more; its samples "
        "are compared with those of a session without a kill. Lost are samples that "
        "the program had been given and that are not in the file.",
        "",
        "| command | signal | sent to | times | files that open | finished sessions | "
        "with a wrong sample | samples lost, at most | block | lost nothing |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| `{r.command}` | {r.signal} | {r.victim} | {r.times} | {r.opened} | "
        f"{r.finished} | {r.wrong} | {r.most_lost} | {r.block} | {r.whole} |"
        for r in rows
    ]
    lines += [
        "",
        "Where the program alone dies, the recording process finishes the file; where "
        "the recording process dies, the program does. Where both die, or the program "
        "while it finishes the file itself, the recording stays as it was written; "
        "every command opens it, and `recover` finishes it.",
        "",
    ]
    return "\n".join(lines)


def main() -> None:
    """Run what is missing, and write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=60, help="of each command")
    parser.add_argument("--ends", type=int, default=20, help="SIGTERM and SIGHUP each")
    options = parser.parse_args()
    kinds = [
        (command, signal.SIGKILL, victim, options.kills // len(VICTIMS))
        for command in SOURCES
        for victim in VICTIMS
    ]
    kinds += [
        (command, number, "program", options.ends // 2)
        for command in SOURCES
        for number in (signal.SIGTERM, signal.SIGHUP)
    ]
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as name:
        for command, number, victim, times in kinds:
            rows.append(series(command, number, victim, times, Path(name)))
            print(rows[-1], flush=True)
            RUNS.write_text(json.dumps([asdict(r) for r in rows], indent=1) + "\n")
            PAGE.write_text(page(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
