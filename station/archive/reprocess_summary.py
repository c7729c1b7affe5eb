# SPDX-License-Identifier: MIT
"""What a run of ``jointbench reprocess`` writes to, and what it has come to."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console

from jointbench.acquisition.file_access.quoting import named, visible
from jointbench.station.archive.process_file import Outcome, State
from jointbench.station.archive.process_outcome import outcome_json
from jointbench.station.archive.reprocess_progress import time_words
from jointbench.station.schemas.recipe import Recipe
from jointbench.station.screen.terminal import console, table

MOST_SHOWN = 10


@dataclass(frozen=True, slots=True)
class Places:
    """Where a run writes.

    Attributes:
        results: folder of the results, None for beside the sessions.
        ledger: of the run.
        stages: folder of kept stages, or None to keep none.
        stages_bytes: that kept stages may take [bytes].
    """

    results: Path | None
    ledger: Path
    stages: Path | None
    stages_bytes: int

    @property
    def quarantine(self) -> Path:
        """List of the files that could not be processed."""
        return self.ledger.with_suffix(".quarantine.csv")


@dataclass(slots=True)
class RunSummary:
    """What a run has come to.

    Attributes:
        outcomes: one a file, as they came in.
        interrupted: whether it was stopped.
        unwritable: why results could not be written, or empty.
        lost: why what ran the files is gone, or empty.
        seconds: that it took [s].
    """

    outcomes: list[Outcome] = field(default_factory=list)
    interrupted: bool = False
    unwritable: str = ""
    lost: str = ""
    seconds: float = 0.0

    @property
    def counts(self) -> dict[State, int]:
        """Number of files by what became of them."""
        counts = dict.fromkeys(State, 0)
        for outcome in self.outcomes:
            counts[outcome.state] += 1
        return counts

    @property
    def failed(self) -> list[Outcome]:
        """Those that go into the quarantine list."""
        return [one for one in self.outcomes if one.state is State.FAILED]

    @property
    def corrupted(self) -> list[Outcome]:
        """Those whose result was corrupted and was made again."""
        return [one for one in self.outcomes if one.corrupted]


def show_summary(
    summary: RunSummary, total: int, places: Places, json_target: str | None
) -> None:
    """Print what became of a run."""
    screen = console(json_target)
    rows = [(state.value, str(count)) for state, count in summary.counts.items()]
    rows += [("of", str(total)), ("time", time_words(summary.seconds))]
    changes = sum(outcome.changes for outcome in summary.outcomes)
    rows.append(("verdicts changed", str(changes)))
    screen.print(table("Reprocessed", ("files", "number"), rows))
    _show_corrupted(screen, summary.corrupted)
    failed = summary.failed
    for outcome in failed[:MOST_SHOWN]:
        screen.print(f"quarantined: {_reason(outcome)}", soft_wrap=True)
    if len(failed) > MOST_SHOWN:
        screen.print(f"and {len(failed) - MOST_SHOWN} more, see the quarantine list")
    screen.print(f"\nledger: {places.ledger}", soft_wrap=True)
    if failed:
        screen.print(f"quarantine: {places.quarantine}", soft_wrap=True)
    if summary.interrupted:
        screen.print("interrupted; the same command continues where it stopped")


def _show_corrupted(screen: Console, corrupted: Sequence[Outcome]) -> None:
    for outcome in corrupted[:MOST_SHOWN]:
        screen.print(f"made again: {outcome.corrupted}", soft_wrap=True)
    if len(corrupted) > MOST_SHOWN:
        screen.print(f"and {len(corrupted) - MOST_SHOWN} more, see the ledger")


def _reason(outcome: Outcome) -> str:
    """Return why a file failed; most reasons begin with its name."""
    if named(outcome.path) in outcome.reason:
        return outcome.reason
    return f"{visible(str(outcome.path))}: {outcome.reason}"


def summary_json(
    summary: RunSummary, total: int, recipe: Recipe, places: Places
) -> dict[str, object]:
    """Return what became of a run as plain data."""
    return {
        "recipe": recipe.name,
        "files": total,
        **{state.value: count for state, count in summary.counts.items()},
        "interrupted": summary.interrupted,
        "lost": summary.lost,
        "rotten": [str(outcome.result) for outcome in summary.corrupted],
        "seconds": summary.seconds,
        "ledger": [outcome_json(outcome) for outcome in summary.outcomes],
        "ledger_file": str(places.ledger),
        "quarantine_file": str(places.quarantine),
    }
