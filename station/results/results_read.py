# SPDX-License-Identifier: MIT
"""Reads results files of every layout that ever was, through the guards.

Layout 1 (`jointbench modal`): one FRF and its modes. Layout 2 (`process`): everything.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.content_digest import require_whole
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.hdf5_layout import find_group
from jointbench.acquisition.file_access.memory_room import require_short_json
from jointbench.acquisition.file_access.netcdf_read import (
    read_array,
    read_attribute,
    read_flags,
    read_texts,
    require_rows,
)
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.session_file.store import damage_named
from jointbench.station.pipeline.judge_again import VerdictChange
from jointbench.station.results.result_rows import (
    MODAL_SCHEMA,
    PROCESSED_SCHEMA,
    ResultQuantity,
)

_FAMILY = MODAL_SCHEMA.partition("/")[0] + "/"
FACTS = (
    "input_file",
    "input_sha256",
    "recipe_name",
    "software",
    "created",
    "session",
    "recorded",
    "operator",
    "specimen",
    "source",
)


@dataclass(frozen=True, slots=True)
class StoredResult:
    """What a results file says, its arrays left aside.

    Attributes:
        path: of the file.
        key: of input, recipe and version; empty in layout 1.
        facts: texts by name, see `FACTS`; empty where the layout has none.
        torque: on each bolt [N m], or None.
        preload: of the session [N], or None.
        quantities: every number.
        changes: hits whose verdict is another than the stored one.
        recipe: content of the recipe; empty in layout 1.
        stages: key of each stage by its name.
        remarks: what could not be done.
    """

    path: Path
    key: str
    facts: Mapping[str, str]
    torque: float | None
    preload: float | None
    quantities: tuple[ResultQuantity, ...]
    changes: tuple[VerdictChange, ...] = ()
    recipe: Mapping[str, Any] = field(default_factory=dict)
    stages: Mapping[str, str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()


def without_copies(
    results: Sequence[StoredResult],
) -> tuple[list[StoredResult], list[StoredResult]]:
    """Part results from those that say the same of the same content.

    A session kept under two names has two results; to count both would make one
    measurement two.

    Returns:
        The results, each once, and the copies that were left out.
    """
    kept: dict[str, StoredResult] = {}
    copies: list[StoredResult] = []
    for result in results:
        own = result.key or str(result.path)
        if kept.setdefault(own, result) is not result:
            copies.append(result)
    return list(kept.values()), copies


@contextmanager
def open_result(path: Path, *, verify: bool = True) -> Iterator[h5py.File]:
    """Open a results file through the guards, its content compared with its digest.

    Args:
        path: of the file.
        verify: compare it; False for a file that was just written.

    Raises:
        CorruptedFile: the content is not what the digest says.
        FormatError: it is damaged.
        HostileFile: it asks for more than a result would.
    """
    with open_guarded(path) as file, damage_named(path):
        if verify:
            require_whole(file, path)
        yield file


def is_results(path: Path) -> bool:
    """Return whether a file holds results of any layout, whatever its name.

    Raises:
        BadData: it is neither, or asks for more than a result would.
    """
    with open_guarded(path) as file, damage_named(path):
        return str(read_attribute(file, "schema")).startswith(_FAMILY)


def read_result(path: Path, *, verify: bool = True) -> StoredResult:
    """Read a results file of any layout.

    Args:
        path: of the file.
        verify: compare its content with its digest; False for one just written.

    Raises:
        CorruptedFile: its content is not what its digest says.
        FormatError: it is no results file, of a later layout, or damaged.
        HostileFile: it asks for more than a result would.
    """
    with open_result(path, verify=verify) as file:
        schema = read_attribute(file, "schema")
        if schema == PROCESSED_SCHEMA:
            return _processed(file, path)
        if schema == MODAL_SCHEMA:
            return _modal(file, path)
        later = isinstance(schema, str) and schema.startswith(_FAMILY)
        way = (
            "a later jointbench reads it" if later else "`jointbench inspect` shows it"
        )
        raise FormatError(
            f"{named(path)} has the layout {shown(schema)}, results have "
            f"{MODAL_SCHEMA!r} or {PROCESSED_SCHEMA!r}; {way}"
        )


def _facts(file: h5py.File) -> dict[str, str]:
    return {name: str(read_attribute(file, name) or "") for name in FACTS}


def _number(file: h5py.File, name: str) -> float | None:
    value = read_attribute(file, name)
    return float(value) if isinstance(value, int | float) else None


def _processed(file: h5py.File, path: Path) -> StoredResult:
    stages = file["stages"]
    recipe = "".join(read_texts(file["recipe/text"]))
    require_short_json(recipe)
    remarks = find_group(file, "remarks")
    return StoredResult(
        path=path,
        key=str(read_attribute(file, "key")),
        facts=_facts(file),
        torque=_number(file, "torque"),
        preload=_number(file, "preload"),
        quantities=tuple(_rows(file["quantities"])),
        changes=tuple(_changes(find_group(file, "hits"))),
        recipe=json.loads(recipe),
        stages=dict(
            zip(
                read_texts(stages["stage_name"]), read_texts(stages["key"]), strict=True
            )
        ),
        remarks=() if remarks is None else read_texts(remarks["text"]),
    )


def _rows(group: h5py.Group) -> Iterator[ResultQuantity]:
    require_rows(group["value"])
    texts = [read_texts(group[n]) for n in ("part", "item", "name", "unit")]
    numbers = [read_array(group[n]).tolist() for n in ("value", "sd")]
    words, preloads = read_texts(group["word"]), read_array(group["preload"]).tolist()
    for row in zip(*texts, *numbers, words, preloads, strict=True):
        yield ResultQuantity(*row)


def _changes(group: h5py.Group | None) -> Iterator[VerdictChange]:
    if group is None:
        return
    require_rows(group["time"])
    for row in zip(
        read_texts(group["recording"]),
        read_array(group["time"]).tolist(),
        read_texts(group["stored_verdict"]),
        read_flags(group["verdict"]),
        read_texts(group["reason"]),
        strict=True,
    ):
        if row[2] != row[3] and row[2] != "-":
            yield VerdictChange(*row)


def _modal(file: h5py.File, path: Path) -> StoredResult:
    modes = file["modes"]
    columns = {
        (name, unit): (read_array(modes[name]), read_array(modes[f"{name}_sd"]))
        for name, unit in (("natural_frequency", "Hz"), ("damping_ratio", "1"))
    }
    count = read_array(modes["natural_frequency"]).size
    rows = tuple(
        ResultQuantity("modes", str(i + 1), name, unit, float(value[i]), float(sd[i]))
        for i in range(count)
        for (name, unit), (value, sd) in columns.items()
    )
    facts = _facts(file)
    facts["input_file"] = str(read_attribute(file, "input_files") or "")
    return StoredResult(path, "", facts, None, None, rows)
