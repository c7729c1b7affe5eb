# SPDX-License-Identifier: MIT
"""From the file of a recording to a session: runs, hits, gaps, and what was lost.

The log says where each run begins, what became of each hit, and what went wrong; a run
becomes one recording, cut where samples are missing, so that no recording pretends to
be continuous where it is not.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.errors import FormatError
from jointbench.acquisition.records import (
    Channel,
    Hit,
    Provenance,
    Quantity,
    Recording,
    Step,
    Verdict,
    step,
)
from jointbench.acquisition.session import JointSetup, Session
from jointbench.acquisition.session_live_read import LiveBlock, LiveContent

_SESSION_TEXTS = ("uuid", "created", "software", "operator", "notes", "source")
_NUMBERS = (str, int, float, bool)


@dataclass(frozen=True, slots=True, eq=False)
class _Stretch:
    """Blocks without a gap, all of one run."""

    run: dict[str, Any]
    blocks: tuple[LiveBlock, ...]

    @property
    def first(self) -> int:
        return self.blocks[0].stored

    @property
    def past(self) -> int:
        return self.blocks[-1].stored + int(self.blocks[-1].samples.shape[1])


def session_from_live(content: LiveContent) -> Session:
    """Make the session that a recording amounts to.

    Args:
        content: of its file, whole or what a crash left of it.

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
    recordings = []
    names: dict[str, int] = {}
    for stretch in _stretches(content):
        name = str(stretch.run.get("name", "stream"))
        names[name] = names.get(name, 0) + 1
        if names[name] > 1:
            name = f"{name} ({names[name]})"
        recordings.append(_recording(name, stretch, channels, rate, hits))
    return Session(
        **texts,
        simulated=simulated,
        joint=_joint(recordings, meta),
        recordings=tuple(recordings),
        provenance=_provenance(content),
    )


def lost_samples(log: Sequence[dict[str, Any]]) -> int:
    """Return how many samples per channel the driver reported as overwritten."""
    return sum(int(e.get("samples", 0)) for e in log if e.get("kind") == "gap")


def is_finished(content: LiveContent) -> bool:
    """Tell whether the recording came to its end by itself."""
    return any(entry.get("kind") == "end" for entry in content.log)


def _stretches(content: LiveContent) -> Iterator[_Stretch]:
    runs = [entry for entry in content.log if entry.get("kind") == "run"]
    waiting: list[LiveBlock] = []
    before: dict[str, Any] = {"name": "quiet", "purpose": "noise of the hammer"}
    current = before
    for block in content.blocks:
        begun = [run for run in runs if int(run["stored"]) <= block.stored]
        run = begun[-1] if begun else before
        if waiting and (run is not current or not _follows(waiting[-1], block)):
            yield _Stretch(current, tuple(waiting))
            waiting = []
        current = run
        waiting.append(block)
    if waiting:
        yield _Stretch(current, tuple(waiting))


def _follows(one: LiveBlock, other: LiveBlock) -> bool:
    count = one.samples.shape[1]
    return (
        other.segment == one.segment
        and other.first == one.first + count
        and other.stored == one.stored + count
    )


def _recording(
    name: str,
    stretch: _Stretch,
    channels: tuple[Channel, ...],
    rate: float,
    hits: Sequence[tuple[int, Hit]],
) -> Recording:
    run = stretch.run
    own = [
        _moved(hit, stretch.first)
        for _, hit in hits
        if stretch.first <= hit.start and hit.stop <= stretch.past
    ]
    point = str(run.get("point", ""))
    preload = run.get("preload")
    return Recording(
        name=name,
        samples=np.concatenate([b.samples for b in stretch.blocks], axis=1).astype(
            float
        ),
        sample_rate=rate,
        channels=tuple(_at(channel, point) for channel in channels),
        start_time=_start_time(stretch, rate),
        hits=tuple(own),
        provenance=(
            step(
                "record",
                segment=stretch.blocks[0].segment,
                first_sample=stretch.blocks[0].first,
                **_plain(run, ("torque", "level", "purpose")),
            ),
        ),
        preload=None if preload is None else float(preload),
    )


def _start_time(stretch: _Stretch, rate: float) -> float:
    """Return the time of the first sample [s]: by its run's own, if that says so."""
    begun = stretch.run.get("start_time")
    if begun is None:
        return stretch.first / rate
    return float(begun) + (stretch.first - int(stretch.run["stored"])) / rate


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
        )
    return sorted(found.items())


def _moved(hit: Hit, first: int) -> Hit:
    return Hit(
        hit.start - first,
        hit.trigger - first,
        hit.stop - first,
        hit.point,
        hit.peak_force,
        hit.verdict,
        hit.measure,
        hit.reason,
    )


def _joint(recordings: Sequence[Recording], meta: dict[str, Any]) -> JointSetup | None:
    preloads = {recording.preload for recording in recordings}
    torque = meta.get("torque")
    preload = preloads.pop() if len(preloads) == 1 else None
    if preload is None and torque is None:
        return None
    return JointSetup(preload=preload, torque=None if torque is None else float(torque))


def _provenance(content: LiveContent) -> Provenance:
    """Return the bench's own account: sensors, notes, gaps, settings, continuity."""
    steps = [
        Step(str(entry["kind"]), tuple(_plain(entry, tuple(entry)).items()))
        for entry in content.log
        if entry.get("kind") not in {"hit", "verdict", "run", None}
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
    """Return where `recover` puts what it saves of a file."""
    return path.with_name(f"{path.stem}.recovered{path.suffix}")
