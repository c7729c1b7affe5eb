# SPDX-License-Identifier: MIT
"""Hits of sessions as raw records of one length, for a model of bolted bodies."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, ChannelMissing
from jointbench.acquisition.records.recordings import (
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.analysis.gap.intake.filter_hits import RawHit, RawHits, filter_hits
from jointbench.analysis.gap.intake.intake_settings import HITS
from jointbench.analysis.gap.intake.session_campaign import nominal_levels
from jointbench.analysis.gap.structure_response.hit_campaign import (
    HitRecords,
    RejectedHit,
)

# Longest quiet start that is kept [samples]: offset and hum come from it.
_LONGEST_QUIET = 1024


@dataclass(frozen=True, slots=True, eq=False)
class _OwnHit:
    """A hit with its recording and the samples around it that belong to it.

    Attributes:
        name: of the record.
        recording: that holds it.
        hit: judged.
        before: samples before the trigger.
        after: samples from the trigger on.
    """

    name: str
    recording: Recording
    hit: Hit
    before: int
    after: int


def recorded_hits(
    recordings: Sequence[Recording],
    channels: Sequence[str],
    points: Sequence[str],
    band: float,
) -> HitRecords:
    """Cut the accepted hits of recordings to one length, and filter them.

    Args:
        recordings: with judged hits.
        channels: of the model, in order.
        points: hammer points of the model, in order.
        band: frequency up to which hits are compared [Hz].

    Raises:
        BadData: hits cannot be used, or no hit can.
        ChannelMissing: a recording lacks a channel.
    """
    strikes = [one for recording in recordings for one in _strikes(recording)]
    good = [one for one in strikes if one.hit.verdict is Verdict.OK]
    if not good:
        raise BadData("no hit was accepted; see `jointbench inspect`, and hit again")
    rates = {one.recording.sample_rate for one in good}
    if len(rates) > 1:
        shown = ", ".join(f"{rate:g}" for rate in sorted(rates))
        raise BadData(f"sample rates are {shown} Hz; give sessions of one rate")
    quiet = min(min(one.before for one in good), _LONGEST_QUIET)
    after = min(one.after for one in good)
    if quiet < HITS.least_pretrigger or quiet + after < HITS.least_samples:
        raise BadData(
            f"records have {quiet} samples before and {after} after the trigger; "
            f"{HITS.least_pretrigger} quiet ones and {HITS.least_samples} in all are "
            "required: record with a longer pre-trigger, wait longer between hits"
        )
    levels = nominal_levels(np.array([one.hit.peak_force for one in good]))
    preload = _preloads(good)
    raw = RawHits(
        where="the session",
        sample_rate=rates.pop(),
        full_scale=1.0,
        quiet=quiet,
        volts=_shares(good, channels),
        units=np.ones(1 + len(channels)),
        hits=tuple(
            RawHit(
                one.name,
                _samples(one, channels, quiet, after),
                _point(one, points),
                torque,
                float(level),
            )
            for one, torque, level in zip(good, preload, levels, strict=True)
        ),
    )
    found = filter_hits(raw, band)
    bad = tuple(
        RejectedHit(one.name, f"{one.hit.verdict.value}: {one.hit.reason}")
        for one in strikes
        if one.hit.verdict is not Verdict.OK
    )
    return replace(found, rejected=(*bad, *found.rejected), clamped_by="preload")


def _strikes(recording: Recording) -> list[_OwnHit]:
    """Return the hits of a recording, each with the samples that are its own."""
    found = []
    ends = [0, *(hit.stop for hit in recording.hits)]
    starts = [*(hit.start for hit in recording.hits[1:]), recording.samples.shape[1]]
    for number, hit in enumerate(recording.hits):
        name = (
            recording.name
            if len(recording.hits) == 1
            else f"{recording.name}/{number + 1}"
        )
        before, after = hit.trigger - ends[number], starts[number] - hit.trigger
        found.append(_OwnHit(name, recording, hit, before, after))
    return found


def _preloads(strikes: Sequence[_OwnHit]) -> list[float]:
    """Return the preload of each hit [N]; 1 where none is known."""
    known = [one.recording.preload for one in strikes]
    if all(value is None for value in known):
        return [1.0] * len(strikes)
    for one in strikes:
        if one.recording.preload is None:
            raise BadData(
                f"recording {one.recording.name!r} has no preload, others have; give "
                "it with --preload '4 kN'"
            )
    return [float(value) for value in known if value is not None]


def _rows(strike: _OwnHit, channels: Sequence[str]) -> list[int]:
    """Return the rows of force and channels."""
    recording = strike.recording
    names = [channel.name for channel in recording.channels]
    rows = [recording.row(Quantity.FORCE)]
    for name in channels:
        if name not in names:
            raise ChannelMissing(
                f"recording {recording.name!r} has no channel {name!r}, which the "
                f"model names; its channels are {', '.join(names)}"
            )
        row = names.index(name)
        quantity = recording.channels[row].quantity
        if quantity is not Quantity.ACCELERATION:
            raise BadData(
                f"channel {name!r} of recording {recording.name!r} measures "
                f"{quantity.value}; bolted bodies are compared by acceleration"
            )
        rows.append(row)
    return rows


def _shares(strikes: Sequence[_OwnHit], channels: Sequence[str]) -> FloatArray:
    """Return 1 over the range of force and channels; 0 where it is not known."""
    first = strikes[0]
    full = [first.recording.channels[row].range for row in _rows(first, channels)]
    return np.array([0.0 if one is None else 1.0 / one for one in full])


def _samples(
    strike: _OwnHit, channels: Sequence[str], quiet: int, after: int
) -> FloatArray:
    trigger = strike.hit.trigger
    # HitSettings allow for a contact that begins some samples before the trigger.
    rows = _rows(strike, channels)
    return np.asarray(
        strike.recording.samples[rows][:, trigger - quiet : trigger + after]
    )


def _point(strike: _OwnHit, points: Sequence[str]) -> int:
    if strike.hit.point not in points:
        raise BadData(
            f"recording {strike.recording.name!r} was hit at point "
            f"{strike.hit.point!r}; the model has {', '.join(points)}: add it to [hits]"
        )
    return list(points).index(strike.hit.point)
