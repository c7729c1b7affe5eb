# SPDX-License-Identifier: MIT
"""Spectra of hammer hits on one common block."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import (
    ChannelMissing,
    NoHitFound,
    SamplingError,
)
from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    common_response,
    response_rows,
)
from jointbench.signal.hits.block_length import choose_block
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.hits.windows import HammerWindow, apply_window

# A constant that a filter went over still varies by this share of itself.
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class HitSpectra:
    """Spectra of all accepted hits of a measurement.

    Attributes:
        frequency: [Hz], shape (n_lines,).
        force: [N s], shape (n_hits, n_lines).
        response: [response unit s], shape (n_hits, n_responses, n_lines).
        labels: for each hit, the label of each of its responses.
        points: for each hit, where the hammer struck.
        quantity: what all responses measure.
        block: samples of the common block.
        block_reason: how it was chosen.
    """

    frequency: FloatArray
    force: ComplexArray
    response: ComplexArray
    labels: tuple[tuple[str, ...], ...]
    points: tuple[str, ...]
    quantity: Quantity
    block: int
    block_reason: str


def hit_spectra(recordings: Sequence[Recording], window: HammerWindow) -> HitSpectra:
    """Window every accepted hit and transform it on a common block.

    Args:
        recordings: with hits found.
        window: applied to every hit alike.

    Returns:
        One row of spectra a hit.

    Raises:
        NoHitFound: no hit was accepted.
        SamplingError: the sample rates differ.
        ChannelMissing: no response, or responses of different quantities or numbers.
    """
    chosen = [(r, hit) for r in recordings for hit in accepted_hits(r)]
    if not chosen:
        raise NoHitFound(_why_none(recordings))
    rate = _common_rate(recordings)
    block, reason = choose_block([hit.stop - hit.start for _, hit in chosen])
    windowed = [windowed_hit(r, hit, window, block) for r, hit in chosen]
    responses = _same_number([w[1] for w in windowed])
    channels = [c for r in recordings for c in r.channels]
    return HitSpectra(
        frequency=scipy.fft.rfftfreq(block, 1.0 / rate),
        force=scipy.fft.rfft([w[0] for w in windowed], block) / rate,
        response=scipy.fft.rfft(responses, block) / rate,
        labels=tuple(_labels(r) for r, _ in chosen),
        points=tuple(hit.point for _, hit in chosen),
        quantity=common_response(channels),
        block=block,
        block_reason=reason,
    )


def join_spectra(parts: Sequence[HitSpectra]) -> HitSpectra:
    """Return the spectra of several measurements of the same channels as one.

    Args:
        parts: at least one; all on the same block at the same sample rate.
    """
    first = parts[0]
    return replace(
        first,
        force=np.concatenate([part.force for part in parts]),
        response=np.concatenate([part.response for part in parts]),
        labels=tuple(row for part in parts for row in part.labels),
        points=tuple(point for part in parts for point in part.points),
    )


def require_alive(recording: Recording, hit: Hit) -> None:
    """Refuse a hit that a response channel did not see at all.

    Args:
        recording: holds the hit.
        hit: an accepted one.

    Raises:
        ChannelMissing: a response is constant throughout; the message names all such.
    """
    rows = list(response_rows(recording))
    samples = recording.samples[rows, hit.start : hit.stop]
    size = np.abs(samples).max(axis=1)
    dead = np.flatnonzero(np.ptp(samples, axis=1) <= _ROUNDING * size)
    if dead.size:
        names = ", ".join(
            f"{recording.channels[rows[i]].name!r} (always {samples[i, 0]:.4g})"
            for i in dead
        )
        raise ChannelMissing(
            f"recording {recording.name!r}: no signal from {names} in the hit at "
            f"{hit.trigger / recording.sample_rate:.4g} s; check the cable and the "
            "sensor, or leave the channel out"
        )


def windowed_hit(
    recording: Recording, hit: Hit, window: HammerWindow, block: int
) -> tuple[FloatArray, FloatArray]:
    """Cut a hit out of its recording and window it.

    Args:
        recording: holds the hit.
        hit: which.
        window: to apply.
        block: samples wanted; a shorter hit is padded with zeros.

    Returns:
        Force, shape (block,), and responses, shape (n_responses, block).
    """
    stop = min(hit.stop, hit.start + block)
    samples = recording.samples[:, hit.start : stop]
    force, response = apply_window(
        window,
        samples[recording.row(Quantity.FORCE)],
        samples[list(response_rows(recording))],
        trigger=hit.trigger - hit.start,
        sample_rate=recording.sample_rate,
    )
    missing = block - force.size
    return np.pad(force, (0, missing)), np.pad(response, ((0, 0), (0, missing)))


def _labels(recording: Recording) -> tuple[str, ...]:
    return tuple(_label(recording.channels[row]) for row in response_rows(recording))


def _label(channel: Channel) -> str:
    return f"{channel.name}@{channel.point}"


def _same_number(responses: Sequence[FloatArray]) -> FloatArray:
    """Return the responses as one array, shape (n_hits, n_responses, n)."""
    numbers = {r.shape[0] for r in responses}
    if len(numbers) != 1:
        raise ChannelMissing(
            f"the recordings have {sorted(numbers)} response channels; "
            "give recordings with equally many"
        )
    return np.array(responses)


def _common_rate(recordings: Sequence[Recording]) -> float:
    rates = sorted({r.sample_rate for r in recordings})
    if rates[-1] - rates[0] > 1e-6 * rates[0]:
        raise SamplingError(
            f"recordings are sampled at {rates[0]:g} and {rates[-1]:g} Hz; "
            "an average needs one sample rate, so resample or leave some out"
        )
    return rates[0]


def _why_none(recordings: Sequence[Recording]) -> str:
    if not recordings:
        return "no recording was given; name at least one"
    rejected = [hit for r in recordings for hit in r.hits]
    if not rejected:
        return "the recordings hold no hits; run find_hits on them first"
    return (
        f"none of {len(rejected)} hits was accepted; the first is "
        f"{rejected[0].verdict.value}: {rejected[0].reason}"
    )
