# SPDX-License-Identifier: MIT
"""The results file of a recipe, layout 2: one file for all results of a session.

::

    /             key, input_sha256, recipe (JSON), software, session, when and where
    /quantities   every number of the result, a row each: what archives read
    /hits         hits as judged now, and what the stored verdict was
    /modal/<n>    frf, synthesis, stabilisation, modes of each preload, as in layout 1
    /surfaces/<n> structure function of each surface
    /environment  build, versions and kind of computer, as attributes
    /sensors      calibration of the sensors, where the session states it
    /pages        contact, joint and gap as JSON, rows of 4096 characters
    /stages       names and keys of the stages
    /remarks      what could not be done

Everything but `/environment` and the attributes `created` and `seconds` depends on
input, recipe and version alone: two runs on one computer write the same.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.file_access.content_digest import new_signed_file
from jointbench.acquisition.file_access.netcdf_encodings import write_flags, write_texts
from jointbench.acquisition.file_access.netcdf_write import (
    write_attributes,
    write_variable,
)
from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.records.recordings import Recording, Verdict
from jointbench.acquisition.records.session import Session, software_version
from jointbench.acquisition.session_file.record_groups import free_name
from jointbench.station.files.session_facts import session_facts
from jointbench.station.pipeline.judge_again import NOT_THERE, VerdictChange
from jointbench.station.pipeline.process_session import PreloadModes, ProcessedSession
from jointbench.station.pipeline.surface_stages import SurfaceChain
from jointbench.station.results.quantities import quantities_of
from jointbench.station.results.result_rows import (
    OF_EACH_ROW,
    PROCESSED_SCHEMA,
    ResultQuantity,
)
from jointbench.station.results.results_file import write_environment, write_modal
from jointbench.station.schemas.recipe import Recipe, recipe_content

SENSOR_FACTS = ("name", "quantity", "serial", "certificate", "calibrated", "due")
LINE = 4096
"""Characters of a line of JSON: a table of texts is as wide as its longest."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a result comes from.

    Attributes:
        path: of the session file.
        sha256: of it.
        key: of the result: input, recipe and version.
        seconds: that the work took [s].
    """

    path: Path
    sha256: str
    key: str
    seconds: float = 0.0


def processed_path(session: Path, recipe: Recipe) -> Path:
    """Return where the result of a session under a recipe goes: beside it."""
    return session.with_suffix(f".{recipe.name}.results.h5")


def write_processed(
    path: Path, result: ProcessedSession, recipe: Recipe, origin: Origin
) -> None:
    """Write a result whole or not at all, replacing an earlier one.

    Raises:
        UsageError: it cannot be written there.
    """
    title = "jointbench: a recorded session read again under a recipe"
    with new_signed_file(path, schema=PROCESSED_SCHEMA, title=title) as file:
        _write_origin(file, result, recipe, origin)
        write_environment(file)
        _write_sensors(file, result.session)
        _write_quantities(file.create_group("quantities"), quantities_of(result))
        if any(result.hits):
            _write_hits(file.create_group("hits"), result)
        for number, modes in enumerate(result.modal):
            _write_modes(file.create_group(f"modal/{number}"), modes)
        for chain in result.surfaces:
            surfaces = file.require_group("surfaces")
            name = free_name(chain.surface.name, surfaces)
            _write_surface(surfaces.create_group(name), chain)
        _write_pages(file, result)
        _write_stages(file, result)


def _write_origin(
    file: h5py.File, result: ProcessedSession, recipe: Recipe, origin: Origin
) -> None:
    write_attributes(
        file,
        {
            "key": origin.key,
            "input_file": visible(origin.path.name),
            "input_sha256": origin.sha256,
            "recipe_name": recipe.name,
            "software": software_version(),
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "seconds": origin.seconds,
            **session_facts(result.session, origin.path),
        },
    )
    text = json.dumps(recipe_content(recipe), sort_keys=True)
    _write_lines(file.create_group("recipe"), "text", text, "recipe as JSON")


def _write_quantities(group: h5py.Group, rows: Sequence[ResultQuantity]) -> None:
    for name, words in (
        ("part", "part of the result"),
        ("item", "of which mode, surface or link"),
        ("name", "name of the quantity"),
        ("unit", "unit of value and sd"),
        ("word", "verdict, in place of a number"),
    ):
        texts = [getattr(row, name) for row in rows]
        write_texts(group, name, texts, "quantity", long_name=words)
    for name, units, words in (
        ("value", OF_EACH_ROW, "value in its unit, NaN for a word"),
        ("sd", OF_EACH_ROW, "standard deviation, NaN where not known"),
        ("preload", "N", "preload, NaN where not known"),
    ):
        values = [getattr(row, name) for row in rows]
        write_variable(group, name, values, ("quantity",), units=units, long_name=words)


def _write_sensors(file: h5py.File, session: Session) -> None:
    """Write what the plan of the session says of its sensors, if it does."""
    found = [dict(s.detail) for s in session.provenance if s.name == "sensor"]
    if not found:
        return
    group = file.create_group("sensors")
    for name in SENSOR_FACTS:
        texts = [str(one.get(name, "")) for one in found]
        write_texts(group, name, texts, "sensor", long_name=f"{name} of the sensor")
    write_variable(
        group,
        "sensitivity_sd",
        [float(one.get("sensitivity_sd", np.nan)) for one in found],
        ("sensor",),
        units="1",
        long_name="relative standard uncertainty of the sensitivity, NaN if not stated",
    )


def _write_hits(group: h5py.Group, result: ProcessedSession) -> None:
    pairs = [
        (recording, hit)
        for recording, own in zip(result.session.recordings, result.hits, strict=True)
        for hit in own
    ]
    before = _before(result.session.recordings, result.changes)
    verdicts = list(Verdict)
    write_flags(
        group,
        "verdict",
        [verdicts.index(hit.verdict) for _, hit in pairs],
        ("hit",),
        meanings=[verdict.value for verdict in verdicts],
        long_name="what became of the hit under the recipe",
    )
    times = [r.start_time + hit.trigger / r.sample_rate for r, hit in pairs]
    write_variable(group, "time", times, ("hit",), units="s", long_name="of trigger")
    peaks = [hit.peak_force for _, hit in pairs]
    write_variable(group, "peak_force", peaks, ("hit",), units="N", long_name="peak")
    stored = [
        before.get((r.name, time), hit.verdict.value if r.hits else NOT_THERE)
        for (r, hit), time in zip(pairs, times, strict=True)
    ]
    for name, words, texts in (
        ("recording", "name of the recording", [r.name for r, _ in pairs]),
        ("point", "where the hammer struck", [hit.point for _, hit in pairs]),
        ("reason", "rule met or broken", [hit.reason for _, hit in pairs]),
        ("stored_verdict", "when it was recorded, - for none", stored),
    ):
        write_texts(group, name, texts, "hit", long_name=words)


def _before(
    recordings: Sequence[Recording], changes: Sequence[VerdictChange]
) -> dict[tuple[str, float], str]:
    return {(change.recording, change.time): change.before for change in changes}


def _write_modes(group: h5py.Group, modes: PreloadModes) -> None:
    write_attributes(
        group,
        {"preload": modes.preload, "recordings": "\n".join(modes.recordings)},
    )
    write_modal(group, modes.chain)


def _write_surface(group: h5py.Group, chain: SurfaceChain) -> None:
    write_attributes(
        group,
        {
            "name": chain.surface.name,
            "verdict": chain.fit.verdict.value,
            "reason": chain.fit.reason,
        },
    )
    for name, values, units, words in (
        ("lag", chain.structure.lag, "m", "distance of two points"),
        ("structure_function", chain.structure.value, "m2", "mean square difference"),
    ):
        write_variable(group, name, values, ("lag",), units=units, long_name=words)


def _write_pages(file: h5py.File, result: ProcessedSession) -> None:
    for name, page in _pages(result):
        if page is not None:
            text = json.dumps(page, sort_keys=True)
            group = file.require_group("pages").create_group(name)
            _write_lines(group, "text", text, f"{name} as JSON")
    if result.remarks:
        group = file.create_group("remarks")
        words = "what could not be done, and why"
        write_texts(group, "text", result.remarks, "remark", long_name=words)


def _pages(
    result: ProcessedSession,
) -> Iterator[tuple[str, dict[str, Any] | None]]:
    """Yield the documents; links at several preloads are one document with a list."""
    yield "contact", result.contact
    joints = [{"preload_n": preload} | page for preload, page in result.joints]
    if joints:
        yield "joint", joints[0] if len(joints) == 1 else {"preloads": joints}
    yield "gap", result.gap


def _write_stages(file: h5py.File, result: ProcessedSession) -> None:
    group = file.create_group("stages")
    keys = result.stages.keys
    named = sorted(name for name in keys if not name.startswith("kalman"))
    write_texts(group, "stage_name", named, "stage", long_name="name of the stage")
    write_texts(
        group, "key", [keys[n] for n in named], "stage", long_name="what it depends on"
    )


def _write_lines(group: h5py.Group, name: str, text: str, words: str) -> None:
    lines = [text[i : i + LINE] for i in range(0, len(text), LINE)]
    write_texts(group, name, lines, "line", long_name=words)
