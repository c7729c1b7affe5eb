# SPDX-License-Identifier: MIT
"""What is known of the joint: identification and diagnosis beside a session."""

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.memory_room import require_short_json
from jointbench.station.desk.desk_subject import DeskSubject
from jointbench.station.results.result_tables import result_texts

_LARGEST = 5_000_000
"""Of a JSON file that is looked at [bytes]."""
_MOST_FILES = 200
_IS_JOINT = ("parameters", "verdict")
_IS_GAP = ("effects", "gap_before", "gap_after", "verdict")


@dataclass(frozen=True, slots=True)
class Findings:
    """One identification or diagnosis.

    Attributes:
        kind: ``"joint"`` or ``"gap"``.
        source: name of its file.
        own: whether the name of the file begins like the session's.
        content: as ``identify --json`` or ``gap --json`` write it.
    """

    kind: str
    source: str
    own: bool
    content: Mapping[str, Any]


def findings_beside(subject: DeskSubject) -> tuple[Findings, ...]:
    """Return what lies beside a session: JSON of `identify` and `gap`, and results.

    Args:
        subject: on the desk; its first file gives the folder.

    Returns:
        Newest first; those named like the session before all others. A file that is
        something else, or is damaged, is left out.
    """
    first = subject.files[0]
    paths = sorted(
        (p for p in first.parent.iterdir() if _is_candidate(p, first)),
        key=lambda p: p.stat().st_mtime_ns,
        reverse=True,
    )
    found = [one for path in paths[:_MOST_FILES] for one in _of_file(path, first.stem)]
    return tuple(sorted(found, key=lambda one: not one.own))


def _is_candidate(path: Path, first: Path) -> bool:
    if path.name.endswith(".json"):
        return path.is_file() and path.stat().st_size <= _LARGEST
    return path.name.startswith(f"{first.stem}.") and path.name.endswith(".results.h5")


def _of_file(path: Path, stem: str) -> Iterator[Findings]:
    own = path.name.startswith(stem)
    try:
        if path.suffix == ".json":
            text = path.read_text(encoding="utf-8")
            texts = [text]
        else:
            texts = list(result_texts(path).values())
        for text in texts:
            require_short_json(text)
            content = json.loads(
                text, parse_constant=lambda _: None, parse_float=_finite
            )
            kind = _kind(content)
            if kind:
                yield Findings(kind, path.name, own, content)
    except (BadData, OSError, ValueError):
        return


def _finite(text: str) -> float | None:
    """Return a number of a file; None for one that JSON cannot hold."""
    value = float(text)
    return value if math.isfinite(value) else None


def _kind(content: object) -> str:
    """Return what a file is; ``""`` for another one, or one with other types."""
    if not isinstance(content, dict):
        return ""
    if all(name in content for name in _IS_GAP):
        effects = content["effects"]
        whole = isinstance(effects, list) and all(
            isinstance(one, dict) and _is_table(one.get("parameters"))
            for one in effects
        )
        return "gap" if whole else ""
    if all(name in content for name in _IS_JOINT):
        return "joint" if _is_table(content["parameters"]) else ""
    return ""


def _is_table(value: object) -> bool:
    return isinstance(value, dict) and all(isinstance(v, dict) for v in value.values())
