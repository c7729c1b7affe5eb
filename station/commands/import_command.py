# SPDX-License-Identifier: MIT
"""``jointbench import``: foreign files into one session file."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.formats.heights.height_facts import cautions
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.recordings import Channel, Recording
from jointbench.acquisition.records.session import JointSetup, Session, new_session
from jointbench.acquisition.records.surfaces import Surface
from jointbench.acquisition.session_file.overwrite_guard import require_replaceable
from jointbench.acquisition.session_file.store import write_session
from jointbench.signal.hits.plausibility import plausibility_words
from jointbench.station.files.input_files import (
    read_foreign,
    refuse_twice,
)
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.typed_values import parse_preload
from jointbench.station.pipeline.roughness_words import caution_lines
from jointbench.station.screen.terminal import console, table, working, write_json


@dataclass(frozen=True, slots=True)
class ImportRequest:
    """What is asked of an import.

    Attributes:
        options: what the user says about the files.
        preload: on the joint during the recording, with unit; None if not given.
        overwrite: replace an existing session.
        json_target: where the JSON goes, or None.
    """

    options: SampleOptions = field(default_factory=SampleOptions)
    preload: str | None = None
    overwrite: bool = False
    json_target: str | None = None


def run_import(files: Sequence[Path], out: Path, request: ImportRequest) -> Session:
    """Import `files` into the session file `out` and list the records.

    Args:
        files: hits and surfaces.
        out: session file.
        request: what is asked.

    Raises:
        UsageError: the session exists, is being recorded, or the existing file is not
            a session; the same data are given twice.
        BadData: a file cannot be read; then nothing is written.
    """
    preload, json_target = request.preload, request.json_target
    check_outputs([*files, out], [json_target])
    if out.exists() and request.overwrite:
        require_replaceable(out)
    else:
        check_outputs(files, [] if out.exists() else [out])
    if out.resolve() in {path.resolve() for path in files}:
        raise UsageError(f"'{out}' is an input file; write the session to another file")
    refuse_twice(files)
    joint = None if preload is None else JointSetup(preload=parse_preload(preload))
    recordings: list[Recording] = []
    surfaces: list[Surface] = []
    for path in files:
        with working(f"reading {path.name}"):
            records = read_foreign(path, request.options)
        for record in records:
            if isinstance(record, Recording):
                name = _free(record.name, [r.name for r in recordings])
                recordings.append(replace(record, name=name))
            else:
                name = _free(record.name, [s.name for s in surfaces])
                surfaces.append(replace(record, name=name))
    session = new_session(
        source="import",
        simulated=False,
        recordings=recordings,
        surfaces=surfaces,
        joint=joint,
    )
    write_session(session, out, overwrite=request.overwrite)
    _show(session, out, plausibility_words(recordings), json_target)
    return session


def _free(name: str, taken: list[str]) -> str:
    """Return `name`, numbered where it is taken by a file of another folder."""
    wanted, number = name, 2
    while name in taken:
        name, number = f"{wanted}-{number}", number + 1
    return name


def _show(
    session: Session, out: Path, warnings: Sequence[str], json_target: str | None
) -> None:
    records = _records(session)
    screen = console(json_target)
    screen.print(table(f"{out}", ("record", "content"), list(records.items())))
    for words in warnings:
        screen.print(f"warning: {words}")
    channels = [
        _channel(recording.name, channel)
        for recording in session.recordings
        for channel in recording.channels
    ]
    noted = {s.name: list(cautions(s.provenance)) for s in session.surfaces}
    for name, texts in noted.items():
        for line in caution_lines(name, texts):
            screen.print(f"  {line}", markup=False)
    content = {"session": str(out), "channels": channels, "records": records}
    write_json(json_target, content | {"cautions": noted, "warnings": list(warnings)})


def _channel(recording: str, channel: Channel) -> dict[str, object]:
    return {
        "recording": recording,
        "name": channel.name,
        "quantity": channel.quantity.value,
        "unit": channel.unit,
        "point": channel.point,
    }


def _records(session: Session) -> dict[str, str]:
    """Return one line for each record of a session, by its name."""
    recordings = {
        r.name: (
            f"{len(r.channels)} channels, {r.samples.shape[1]} samples at "
            f"{r.sample_rate:g} Hz"
        )
        for r in session.recordings
    }
    surfaces = {
        s.name: f"{' x '.join(map(str, s.heights.shape))} heights"
        for s in session.surfaces
    }
    return recordings | surfaces
