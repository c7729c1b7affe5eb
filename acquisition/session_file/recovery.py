# SPDX-License-Identifier: MIT
"""Build a session from the file of a recording: runs, hits, gaps and losses.

The log holds the start of each run, the verdict on each hit, and errors. A run becomes
one recording, cut where samples are missing, so that every recording is continuous.
"""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.records.provenance import Provenance, Step, step
from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.acquisition.records.session import JointSetup, Session
from jointbench.acquisition.session_file.live_read import (
    LiveContent,
    LiveSpan,
    read_pieces,
)

_SESSION_TEXTS = ("uuid", "created", "software", "operator", "notes", "source")
_NO_STEPS = {
    *("hit", "verdict", "run", "ask", "condition", "message", "session", "average"),
    "gain",
    *("command", "pause", "seen", "reopened", "tighten", None),
}
"""Entries that are part of the recordings, or of the log alone."""
_NUMBERS = (str, int, float, bool)


@dataclass(frozen=True, slots=True, eq=False)
class _Stretch:
    """Samples without a gap, all of one run."""

    run: dict[str, Any]
    span: LiveSpan


def session_from_live(file: h5py.File, content: LiveContent) -> Session:
    """Return the session of a recording.

    Args:
        file: of the recording, open for reading.
        content: of it, complete or after a crash.

    Raises:
        FormatError: the head of the recording is not that of `LiveSession`.
    """
    outline, spans = outline_live(content)
    recordings = (
        replace(recording, samples=_samples(file, span, len(recording.channels)))
        for recording, span in zip(outline.recordings, spans, strict=True)
    )
    return replace(outline, recordings=tuple(recordings))


def outline_live(content: LiveContent) -> tuple[Session, tuple[LiveSpan, ...]]:
    """Return the session of a recording without its samples.

    Args:
        content: of its file, complete or after a crash.

    Returns:
        The session, its recordings without a sample, and where in the file those of
        each recording are.

    Raises:
        FormatError: the head of the recording is not what `LiveSession` writes.
    """
    meta = content.meta
    try:
        channels = tuple(_channel(row) for row in meta["channels"])
        rate = float(meta["sample_rate"])
        texts: dict[str, Any] = {
            name: str(meta.get(name, "")) for name in _SESSION_TEXTS
        }
        simulated = bool(meta["simulated"])
    except (KeyError, TypeError, ValueError) as error:
        raise FormatError(f"the head of the recording is damaged ({error})") from error
    hits = _hits(content.log)
    measured = _measured_preloads(content.log)
    recordings, spans = [], []
    names: dict[str, int] = {}
    for stretch in _stretches(content):
        name = str(stretch.run.get("name", "stream"))
        names[name] = names.get(name, 0) + 1
        if names[name] > 1:
            name = f"{name} ({names[name]})"
        own = _recording(name, stretch, channels, rate, hits)
        begun = int(stretch.run.get("stored", 0))
        if begun in measured:
            preload, deviation = measured[begun]
            own = replace(own, preload=preload, preload_sd=deviation)
        recordings.append(own)
        spans.append(stretch.span)
    session = Session(
        **texts,
        simulated=simulated,
        joint=_joint(recordings, meta),
        recordings=tuple(recordings),
        provenance=_provenance(content),
    )
    return session, tuple(spans)


def _samples(file: h5py.File, span: LiveSpan, channels: int) -> FloatArray:
    samples = np.empty((channels, span.count))
    done = 0
    for piece in read_pieces(file, span.stored, span.count):
        samples[:, done : done + piece.shape[1]] = piece
        done += piece.shape[1]
    return samples


def lost_samples(log: Sequence[dict[str, Any]]) -> int:
    """Return the samples per channel that the driver reported as overwritten."""
    return sum(int(e.get("samples", 0)) for e in log if e.get("kind") == "gap")


def is_finished(content: LiveContent) -> bool:
    """Return whether the recording was ended regularly."""
    return any(entry.get("kind") == "end" for entry in content.log)


def _stretches(content: LiveContent) -> Iterator[_Stretch]:
    """Yield the spans, cut at the start of runs; of runs at one sample use the last."""
    before: dict[str, Any] = {"name": "quiet", "purpose": "noise of the hammer"}
    begins: dict[int, dict[str, Any]] = {0: before}
    for entry in content.log:
        if entry.get("kind") == "run":
            begins[int(entry["stored"])] = entry
    starts = sorted(begins)
    for span in content.spans:
        inside = [start for start in starts if span.stored < start < span.past]
        for first, past in pairwise([span.stored, *inside, span.past]):
            run = begins[starts[bisect_right(starts, first) - 1]]
            yield _Stretch(run, span.cut(first, past))


def _recording(
    name: str,
    stretch: _Stretch,
    channels: tuple[Channel, ...],
    rate: float,
    hits: Sequence[tuple[int, Hit]],
) -> Recording:
    run, span = stretch.run, stretch.span
    own = [
        _moved(hit, span.stored)
        for _, hit in hits
        if span.stored <= hit.start and hit.stop <= span.past
    ]
    point = str(run.get("point", ""))
    preload = run.get("preload")
    return Recording(
        name=name,
        samples=np.empty((len(channels), 0)),
        sample_rate=rate,
        channels=tuple(_at(channel, point) for channel in channels),
        start_time=_start_time(stretch, rate),
        hits=tuple(own),
        provenance=(
            step(
                "record",
                segment=span.segment,
                first_sample=span.first,
                **_plain(run, ("torque", "level", "purpose")),
            ),
        ),
        preload=None if preload is None else float(preload),
    )


def _start_time(stretch: _Stretch, rate: float) -> float:
    """Return the time of the first sample [s]: that of its run, if stated."""
    begun = stretch.run.get("start_time")
    if begun is None:
        return stretch.span.stored / rate
    return float(begun) + (stretch.span.stored - int(stretch.run["stored"])) / rate


def _at(channel: Channel, point: str) -> Channel:
    """Return a channel, the hammer at the point of its run."""
    if channel.quantity is not Quantity.FORCE or not point:
        return channel
    return Channel(
        channel.name,
        channel.quantity,
        point,
        channel.direction,
        channel.unit,
        channel.sensitivity,
        channel.range,
    )


def _hits(log: Sequence[dict[str, Any]]) -> list[tuple[int, Hit]]:
    """Return the hits by their number, each with its latest verdict."""
    found: dict[int, Hit] = {}
    for entry in log:
        if entry.get("kind") not in {"hit", "verdict"}:
            continue
        number = int(entry["number"])
        found[number] = Hit(
            start=int(entry["start"]),
            trigger=int(entry["trigger"]),
            stop=int(entry["stop"]),
            point=str(entry["point"]),
            peak_force=float(entry["peak_force"]),
            verdict=Verdict(entry["verdict"]),
            measure=float(entry["measure"]),
            reason=str(entry["reason"]),
            temperature=entry.get("temperature"),
        )
    return sorted(found.items())


def _measured_preloads(
    log: Sequence[dict[str, Any]],
) -> dict[int, tuple[float, float]]:
    """Return preload and its sd [N] of the runs at which the bolts were measured.

    From one tightening to the next the joint has one preload: the mean of what was
    measured, whose uncertainty includes how much it changed meanwhile.

    Returns:
        By the index of the first sample of a run.
    """
    found: dict[int, tuple[float, float]] = {}
    runs: list[int] = []
    readings: list[tuple[float, float]] = []
    torque: object = None
    for entry in (*log, {"kind": "run"}):
        if entry.get("kind") == "preload":
            readings.append((float(entry["preload"]), float(entry["preload_sd"])))
        if entry.get("kind") != "run" or entry.get("purpose") == "pause":
            continue
        if entry.get("torque") != torque or "stored" not in entry:
            if readings:
                values, deviations = np.array(readings).T
                sd = np.sqrt(np.mean(deviations**2) + np.var(values))
                found |= dict.fromkeys(runs, (float(np.mean(values)), float(sd)))
            runs, readings, torque = [], [], entry.get("torque")
        runs.append(int(entry.get("stored", 0)))
    return found


def _moved(hit: Hit, first: int) -> Hit:
    return replace(
        hit,
        start=hit.start - first,
        trigger=hit.trigger - first,
        stop=hit.stop - first,
    )


def _joint(recordings: Sequence[Recording], meta: dict[str, Any]) -> JointSetup | None:
    preloads = {recording.preload for recording in recordings}
    torque = meta.get("torque")
    preload = preloads.pop() if len(preloads) == 1 else None
    if preload is None and torque is None:
        return None
    return JointSetup(preload=preload, torque=None if torque is None else float(torque))


def _provenance(content: LiveContent) -> Provenance:
    """Return the log of the bench: sensors, notes, gaps, settings, continuity."""
    steps = [
        Step(str(entry["kind"]), tuple(_plain(entry, tuple(entry)).items()))
        for entry in content.log
        if entry.get("kind") not in _NO_STEPS
    ]
    if not is_finished(content):
        steps.append(
            step("recovered", samples=content.samples, damaged_blocks=content.damaged)
        )
    return tuple(steps)


def _plain(
    entry: dict[str, Any], names: Sequence[str]
) -> dict[str, str | float | int | bool]:
    return {
        name: entry[name]
        for name in names
        if name != "kind" and isinstance(entry.get(name), _NUMBERS)
    }


def _channel(row: dict[str, Any]) -> Channel:
    return Channel(
        name=str(row["name"]),
        quantity=Quantity(row["quantity"]),
        point=str(row["point"]),
        direction=str(row["direction"]),
        unit=str(row["unit"]),
        sensitivity=row["sensitivity"],
        range=row["range"],
    )


def recovered_path(path: Path) -> Path:
    """Return the path for the session recovered from a file."""
    return path.with_name(f"{path.stem}.recovered{path.suffix}")
