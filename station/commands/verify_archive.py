# SPDX-License-Identifier: MIT
"""``jointbench verify`` over many files: sessions, results, campaigns and more.

A results file is intact if its content matches its digest, corrupted if it does not. A
campaign and a file of an early version have no digest. Digests detect accidental
changes; a deliberate change can replace the digest as well.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import JointbenchError, UsageError
from jointbench.acquisition.file_access.content_digest import Seal, seal_of
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.file_access.quoting import shown, visible
from jointbench.acquisition.session_file.session_limits import SESSION_LIMITS
from jointbench.acquisition.session_file.store import damage_named
from jointbench.analysis.gap.intake import read_campaign
from jointbench.station.archive.archive_table import TABLE_SCHEMA
from jointbench.station.archive.ledger import ledger_seal
from jointbench.station.archive.session_problems import problems_of
from jointbench.station.commands.verify_command import run_verify
from jointbench.station.files.archive_patterns import archive_files
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.results.result_tables import result_tables
from jointbench.station.results.results_read import is_results, read_result
from jointbench.station.screen.terminal import console, table, working, write_json

_LEDGER, TABLE = ".ledger.jsonl", ".nc"
DAMAGED = "damaged"
MOST_SHOWN = 20
CORRUPTED = (
    "the content does not match its digest; compute it again with `jointbench "
    "process`, `reprocess` or `modal`, or use another copy"
)
_STATE_WORDS = {"whole": "intact", "unsigned": "no digest", "rotten": "corrupted"}
"""The states of files as the terminal shows them; JSON has the stored words."""


@dataclass(frozen=True, slots=True)
class Checked:
    """The result of the check of one file.

    Attributes:
        path: of the file.
        kind: session, results, campaign, table or ledger.
        state: as in JSON, one of `whole`, `unsigned`, `rotten`, `damaged`.
        problems: one line each; empty for a file without fault.
    """

    path: Path
    kind: str
    state: str
    problems: tuple[str, ...] = ()


def verify_all(patterns: Sequence[str], *, json_target: str | None) -> bool:
    """Check all files of the patterns; a single session is shown in detail.

    Args:
        patterns: files, folders (with all subfolders) or quoted patterns.
        json_target: where the JSON goes.

    Returns:
        True if no file has a fault; a missing digest is no fault.

    Raises:
        UsageError: a pattern matches no file.
        BadData: the only file is a session that cannot be read at all.
    """
    paths = archive_files(patterns, (TABLE, _LEDGER))
    if len(paths) == 1 and _kind(paths[0]) == "session":
        return run_verify(paths[0], json_target=json_target)
    check_outputs(paths, [json_target])
    with working(f"verifying {len(paths)} files"):
        found = [check_file(path) for path in paths]
    _show(found, json_target)
    faults = [one for one in found if one.problems]
    write_json(
        json_target,
        {
            "whole": not faults,
            "problems": [
                f"{one.path}: {word}" for one in faults for word in one.problems
            ],
            "counts": dict(Counter(one.state for one in found)),
            "files": [
                {
                    "file": str(one.path),
                    "kind": one.kind,
                    "state": one.state,
                    "problems": list(one.problems),
                }
                for one in found
            ],
        },
    )
    return not faults


def check_file(path: Path) -> Checked:
    """Read a file of an archive completely; errors become problems."""
    kind = _kind(path)
    checks: dict[str, Callable[[Path], Checked]] = {
        "results": _results,
        "campaign": _campaign,
        "table": _table,
        "ledger": _ledger,
    }
    try:
        return checks.get(kind, _session)(path)
    except JointbenchError as error:
        return Checked(path, kind, DAMAGED, (str(error),))


def _kind(path: Path) -> str:
    """Return the kind of a file from its content, else from its name."""
    if path.name.endswith(_LEDGER):
        return "ledger"
    try:
        if is_results(path):
            return "results"
        if _has_schema(path, read_campaign.SCHEMA):
            return "campaign"
    except JointbenchError:
        pass
    if path.suffix == TABLE:
        return "table"
    return "results" if path.name.endswith(".results.h5") else "session"


def _session(path: Path) -> Checked:
    problems = tuple(problems_of(path))
    return Checked(path, "session", DAMAGED if problems else Seal.WHOLE, problems)


def _results(path: Path) -> Checked:
    seal = _seal(path)
    if seal is Seal.CORRUPTED:
        return Checked(path, "results", seal, (CORRUPTED,))
    read_result(path)
    result_tables(path)
    return Checked(path, "results", seal)


def _campaign(path: Path) -> Checked:
    read_campaign.read_campaign(path)
    return Checked(path, "campaign", Seal.UNSIGNED)


def _table(path: Path) -> Checked:
    if not _has_schema(path, TABLE_SCHEMA):
        raise UsageError(f"{shown(path.name)} is not a table of `jointbench archive`")
    seal = _seal(path)
    problems = (CORRUPTED.replace("process`, `reprocess` or `modal", "archive"),)
    return Checked(path, "table", seal, problems if seal is Seal.CORRUPTED else ())


def _has_schema(path: Path, schema: str) -> bool:
    with open_guarded(path, limits=SESSION_LIMITS) as file, damage_named(path):
        return bool(read_attribute(file, "schema") == schema)


def _seal(path: Path) -> Seal:
    with open_guarded(path) as file, damage_named(path):
        return seal_of(file)


def _ledger(path: Path) -> Checked:
    seal, count = ledger_seal(path)
    words = f"{count} lines do not match their digests; they are ignored"
    return Checked(path, "ledger", seal, (words,) if count else ())


def _show(found: Sequence[Checked], json_target: str | None) -> None:
    screen = console(json_target)
    states = [*(seal.value for seal in Seal), DAMAGED]
    kinds = list(dict.fromkeys(one.kind for one in found))
    counts = Counter((one.kind, str(one.state)) for one in found)
    rows = [(kind, *(str(counts[kind, state]) for state in states)) for kind in kinds]
    heads = [_STATE_WORDS.get(state, state) for state in states]
    screen.print(table("Checked files", ("kind", *heads), rows))
    faults = [one for one in found if one.problems]
    for one in faults[:MOST_SHOWN]:
        for word in one.problems:
            name = visible(str(one.path))
            line = word if name in word else f"{name}: {word}"
            screen.print(
                f"{_STATE_WORDS.get(one.state, one.state)}: {line}", soft_wrap=True
            )
    if len(faults) > MOST_SHOWN:
        screen.print(f"and {len(faults) - MOST_SHOWN} more; use --json for all")
    if any(one.state == Seal.UNSIGNED for one in found):
        screen.print(
            "no digest: campaigns and files of an early version carry none; changes "
            "cannot be detected",
        )
