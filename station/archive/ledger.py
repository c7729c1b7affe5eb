# SPDX-License-Identifier: MIT
"""The ledger of a reprocessing run: one JSON line a file, and the quarantine list.

Resuming relies on the result files themselves. The ledger shows people what
happened, and remembers what each file was when it was last met, so that it is not read
again while size and time stay the same. Each line ends with a digest of itself; one
that does not match, or that a crash cut short, is passed over.
"""

import csv
import errno
import io
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from hashlib import sha256
from io import RawIOBase
from pathlib import Path
from typing import Any

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.content_digest import Seal
from jointbench.acquisition.file_access.file_lock import drop_lock, hold_lock
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import file_size, read_bytes
from jointbench.acquisition.records.session import software_version
from jointbench.station.archive.process_file import Outcome, State
from jointbench.station.archive.process_outcome import outcome_json
from jointbench.station.files.output_paths import write_text
from jointbench.station.files.spreadsheet_text import escaped

LEDGER_SCHEMA = "jointbench-ledger/1"
_MOST_BYTES = 2**28
_MOST_LINES = 500_000
"""Each becomes a record of about 500 bytes in memory; a longer ledger is none."""
_CHECK = "check"
"""Key of a line's digest: the first 16 characters of the SHA-256 of the rest."""


@dataclass(slots=True)
class Ledger:
    """An open ledger.

    Attributes:
        path: of its file.
        refused: key and reason of files that were refused for their content, by path.
        last: last line of each file, by its path.
    """

    path: Path
    refused: dict[str, tuple[str, str]] = field(default_factory=dict)
    last: dict[str, Mapping[str, Any]] = field(default_factory=dict)
    file: RawIOBase | None = None

    def write(self, line: dict[str, object]) -> None:
        """Append a line.

        Raises:
            UsageError: it cannot be written.
        """
        assert self.file is not None
        data = (json.dumps(line | {_CHECK: _check(line)}) + "\n").encode()
        try:
            whole = self.file.write(data) == len(data)
        except OSError as error:
            raise _unwritable(self.path, error.strerror) from error
        if not whole:
            raise _unwritable(self.path, os.strerror(errno.ENOSPC))

    def outcome(self, outcome: Outcome) -> None:
        """Append what became of a file."""
        self.write({"kind": "file", "time": now(), **outcome_json(outcome)})


def now() -> str:
    """Return the time in UTC, ISO 8601."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


@contextmanager
def open_ledger(path: Path, run: Mapping[str, object]) -> Iterator[Ledger]:
    """Open a ledger to append to; no other process writes to it meanwhile.

    Args:
        path: of the file; made where it is not there.
        run: what this run is about.

    Yields:
        The ledger, with what earlier runs refused.

    Raises:
        UsageError: another run holds it, it is no ledger, or cannot be written.
    """
    try:
        lock = hold_lock(path)
    except UsageError as error:
        if not (path.parent.is_dir() and os.access(path.parent, os.W_OK)):
            raise _unwritable(path, "its folder takes no files") from error
        raise UsageError(
            f"{named(path)} is in use by another run; wait until that has finished, or "
            "give --ledger another name"
        ) from error
    try:
        last = _last(read_ledger(path))
        ledger = Ledger(path, _refused(last), last)
        # Unbuffered: what a full disk refused is not tried again on closing.
        with path.open("ab", buffering=0) as file:
            ledger.file = file
            if _cut_short(path):
                file.write(b"\n")
            begin = {"kind": "run", "schema": LEDGER_SCHEMA, "time": now()}
            ledger.write(begin | {"software": software_version()} | dict(run))
            yield ledger
            os.fsync(file.fileno())
    finally:
        drop_lock(path, lock)


def _unwritable(path: Path, reason: str | None) -> UsageError:
    return UsageError(
        f"{named(path)} cannot be written: {reason}; make room, or give --ledger "
        "another place"
    )


def read_ledger(path: Path) -> list[dict[str, Any]]:
    """Return the lines of a ledger that are whole; none where there is no file.

    Raises:
        UsageError: the file is no ledger.
    """
    return [line for line in _lines(path) if _is_whole(line)]


def _is_whole(line: Mapping[str, Any]) -> bool:
    """Return whether a line matches its digest; one without a digest is accepted."""
    return _CHECK not in line or line[_CHECK] == _check(line)


def ledger_seal(path: Path) -> tuple[Seal, int]:
    """Return the entries of a ledger that match their digest, and the corrupted lines.

    Raises:
        UsageError: the file is no ledger.
    """
    lines = _lines(path)
    corrupted = sum(not _is_whole(line) for line in lines)
    if corrupted:
        return Seal.CORRUPTED, corrupted
    signed = all(_CHECK in line for line in lines)
    return (Seal.WHOLE if signed else Seal.UNSIGNED), 0


def _check(line: Mapping[str, Any]) -> str:
    rest = {key: value for key, value in line.items() if key != _CHECK}
    return sha256(json.dumps(rest, sort_keys=True).encode()).hexdigest()[:16]


def _lines(path: Path) -> list[dict[str, Any]]:
    """Return all lines that are JSON objects.

    Raises:
        UsageError: the file is no ledger.
    """
    if not path.exists():
        return []
    lines = []
    data = read_bytes(path, limit=_MOST_BYTES) if file_size(path) else b""
    brackets = data.count(b"[") + data.count(b"{")
    if data.count(b"\n") > _MOST_LINES or brackets > 10 * _MOST_LINES:
        raise UsageError(
            f"{named(path)} has more than {_MOST_LINES} lines, or more values in them "
            "than a ledger; give --ledger another name"
        )
    for text in data.decode("utf-8", errors="replace").split("\n"):
        try:
            line = json.loads(text)
        except (ValueError, RecursionError):
            continue
        if isinstance(line, dict):
            lines.append(line)
    if data and not (
        lines and str(lines[0].get("schema", "")).startswith("jointbench-ledger/")
    ):
        raise UsageError(f"{named(path)} is no ledger; give --ledger another name")
    return lines


def _last(lines: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """Return the last line of each file, by its path."""
    return {str(one.get("file")): one for one in lines if one.get("kind") == "file"}


def _refused(last: Mapping[str, Mapping[str, Any]]) -> dict[str, tuple[str, str]]:
    """Return the files whose last line says that their content was refused."""
    return {
        name: (str(line.get("key", "")), str(line.get("reason", "")))
        for name, line in last.items()
        if line.get("state") == State.FAILED and line.get("lasting")
    }


def _cut_short(path: Path) -> bool:
    """Return whether a crash cut the last line."""
    with path.open("rb") as file:
        if file.seek(0, os.SEEK_END) == 0:
            return False
        file.seek(-1, os.SEEK_END)
        return file.read(1) != b"\n"


def write_quarantine(path: Path, failed: Sequence[Outcome]) -> None:
    """Write the files that could not be processed, each with its reason, as CSV.

    The files themselves stay where they are. Cells that a spreadsheet would run as a
    formula are escaped.
    """
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(("file", "reason", "comes again"))
    for outcome in sorted(failed, key=lambda o: o.path):
        again = "yes" if outcome.lasting else "perhaps not: run again"
        writer.writerow([escaped(str(outcome.path)), escaped(outcome.reason), again])
    write_text(path, buffer.getvalue())
