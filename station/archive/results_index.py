# SPDX-License-Identifier: MIT
"""An index of results, kept on writing: an archive is read without opening its files.

Each folder with results has one file of JSON lines, hidden, a line a result: name, size
and time of the results file, its facts and its quantities, and a digest of the line.
A result whose file is as its line states is taken from there; any other is opened, and
noted for the next time. The index can be deleted at any time. Damage that leaves size
and time alone is found by ``jointbench verify``, which reads everything.
"""

import json
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from hashlib import sha256
from pathlib import Path
from typing import Any

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.text_files import file_size, read_bytes
from jointbench.station.archive.file_mark import mark_of
from jointbench.station.results.result_rows import ResultQuantity
from jointbench.station.results.results_read import FACTS, StoredResult, read_result

INDEX_NAME = ".jointbench-results.jsonl"
_MOST_BYTES = 2**28
"""Of an index; a longer one is not read."""
_CHECK = "check"
_Line = Mapping[str, Any]


def note_result(path: Path) -> None:
    """Note a result that was just written in the index of its folder.

    A folder that cannot be written to, or a result that cannot be read, is left alone:
    the index saves time, nothing rests on it.
    """
    with suppress(BadData, OSError):
        append_to_index(path, read_result(path, verify=False))


def read_indexed(
    paths: Sequence[Path],
) -> tuple[list[StoredResult], list[tuple[Path, str]]]:
    """Read results for a table, from the index where their files are as noted.

    Results from the index have no verdicts of hits, keys of stages and remarks.

    Returns:
        The results, and those that cannot be read with the reasons.
    """
    found: list[StoredResult] = []
    refused: list[tuple[Path, str]] = []
    noted: dict[Path, dict[str, _Line]] = {}
    for path in paths:
        if path.parent not in noted:
            noted[path.parent] = _lines(path.parent / INDEX_NAME)
        line = noted[path.parent].get(path.name)
        result = None if line is None else _as_noted(path, line)
        try:
            found.append(result or _read(path))
        except BadData as error:
            refused.append((path, str(error)))
    return found, refused


def _read(path: Path) -> StoredResult:
    result = read_result(path)
    with suppress(OSError):
        append_to_index(path, result)
    return result


def append_to_index(path: Path, result: StoredResult) -> None:
    """Append a line in one piece: several processes write to one index.

    Args:
        path: of the results file.
        result: what it holds.

    Raises:
        OSError: the folder cannot be written to.
    """
    line: dict[str, Any] = {
        "file": path.name,
        "mark": list(mark_of(path)),
        "key": result.key,
        "facts": dict(result.facts),
        "torque": result.torque,
        "preload": result.preload,
        "recipe": dict(result.recipe),
        "quantities": [list(asdict(one).values()) for one in result.quantities],
    }
    data = json.dumps(line | {_CHECK: _check(line)}).encode()
    handle = os.open(
        path.parent / INDEX_NAME, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644
    )
    try:
        # Begun on a line of its own, even where a crash cut the last one short.
        os.write(handle, b"\n" + data + b"\n")
    finally:
        os.close(handle)


def _check(line: _Line) -> str:
    plain = {key: value for key, value in line.items() if key != _CHECK}
    return sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()[:16]


def _lines(path: Path) -> dict[str, _Line]:
    """Return the last whole line on each file, by its name."""
    try:
        if not path.is_file() or file_size(path) > _MOST_BYTES:
            return {}
        data = read_bytes(path, limit=_MOST_BYTES)
    except (BadData, OSError):
        return {}
    found: dict[str, _Line] = {}
    for text in data.split(b"\n"):
        line = _parsed(text)
        if line is not None:
            found[str(line.get("file"))] = line
    return found


def _parsed(text: bytes) -> _Line | None:
    if not text:
        return None
    try:
        line = json.loads(text)
        return line if line[_CHECK] == _check(line) else None
    except (ValueError, KeyError, TypeError, RecursionError, AttributeError):
        return None


def _as_noted(path: Path, line: _Line) -> StoredResult | None:
    """Return what a line holds, None where the file is another one by now."""
    mark = mark_of(path)
    if not mark or list(mark) != line.get("mark"):
        return None
    try:
        return StoredResult(
            path=path,
            key=str(line["key"]),
            facts={name: str(line["facts"][name]) for name in FACTS},
            torque=_number(line["torque"]),
            preload=_number(line["preload"]),
            quantities=tuple(ResultQuantity(*row) for row in line["quantities"]),
            recipe=dict(line["recipe"]),
        )
    except (KeyError, TypeError, ValueError):
        return None


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None
