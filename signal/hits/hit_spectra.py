# SPDX-License-Identifier: MIT
"""Spectra of hammer hits on one common block."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray, FloatArray
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
from jointbench.acquisition.records.stored_samples import remembered
from jointbench.signal.hits.block_length import choose_block
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.hits.hit_pairs import LabelledHits
from jointbench.signal.hits.windows import (
    HammerWindow,
    apply_window,
    force_offset,
    window_weights,
)

# A filtered constant still varies by this share of itself.
_ROUNDING = 1e-12
# A hit with fewer samples before its trigger does not cut those of the others.
_LEAST_BEFORE = 16


@dataclass(frozen=True, slots=True, eq=False)
class HitSpectra:
    """Spectra of all accepted hits of a measurement.

    Attributes:
        frequency: [Hz], shape (n_lines,).
        force: [N s], shape (n_hits, n_lines).
        response: [response unit s], shape (n_hits, n_responses, n_lines).
        labels: for each hit, the label of each of its responses.
        points: for each hit, where the hammer struck.
        quantity: of all responses.
        block: samples of the common block.
        block_reason: why this length.
    """

    frequency: FloatArray
    force: ComplexArray
    response: ComplexArray
    labels: tuple[tuple[str, ...], ...]
    points: tuple[str, ...]
    quantity: Quantity
    block: int
    block_reason: str

    def responses(self, hit: int) -> Iterator[ComplexArray]:
        """Yield the response spectra of a hit, shape (n_lines,) each."""
        yield from self.response[hit]


def hit_spectra(recordings: Sequence[Recording], window: HammerWindow) -> HitSpectra:
    """Window every accepted hit and transform it on a common block.

    Args:
        recordings: with hits found.
        window: applied to every hit.

    Returns:
        One row of spectra per hit.

    Raises:
        NoHitFound: no hit was accepted.
        SamplingError: the sample rates differ.
        ChannelMissing: no response, or responses of different quantities or numbers.
    """
    plan = plan_spectra(recordings)
    lines = plan.frequency.size
    rows = len(plan.labels[0])
    force = np.empty((len(plan.chosen), lines), complex)
    response = np.empty((len(plan.chosen), rows, lines), complex)
    for number, (recording, hit) in enumerate(plan.chosen):
        force[number] = force_spectrum(recording, hit, window, plan.block)
        others = response_spectra(recording, hit, window, plan.block)
        for row, other in enumerate(others):
            response[number, row] = other
    return HitSpectra(
        frequency=plan.frequency,
        force=force,
        response=response,
        labels=plan.labels,
        points=plan.points,
        quantity=plan.quantity,
        block=plan.block,
        block_reason=plan.block_reason,
    )


@dataclass(frozen=True, slots=True, eq=False)
class SpectraPlan:
    """Which hits are transformed, and on which block.

    Attributes:
        chosen: accepted hits with their recordings.
        labels: for each hit, the label of each of its responses.
        points: for each hit, where the hammer struck.
        rate: sample rate [Hz].
        frequency: of the lines [Hz], shape (n_lines,).
        quantity: what all responses measure.
        block: samples of the common block.
        block_reason: how it was chosen.
    """

    chosen: tuple[tuple[Recording, Hit], ...]
    labels: tuple[tuple[str, ...], ...]
    points: tuple[str, ...]
    rate: float
    frequency: FloatArray
    quantity: Quantity
    block: int
    block_reason: str


def plan_spectra(recordings: Sequence[Recording]) -> SpectraPlan:
    """Choose the hits of recordings and their common block; nothing is transformed.

    Args:
        recordings: with hits found.

    Raises:
        NoHitFound: no hit was accepted.
        SamplingError: the sample rates differ.
        ChannelMissing: no response, or responses of different quantities or numbers.
    """
    chosen = tuple((r, hit) for r in recordings for hit in accepted_hits(r))
    if not chosen:
        raise NoHitFound(_why_none(recordings))
    chosen = _aligned(chosen)
    rate = _common_rate(recordings)
    block, reason = choose_block([hit.stop - hit.start for _, hit in chosen])
    labels = tuple(_labels(r) for r, _ in chosen)
    _require_same_number(labels)
    return SpectraPlan(
        chosen=chosen,
        labels=labels,
        points=tuple(hit.point for _, hit in chosen),
        rate=rate,
        frequency=scipy.fft.rfftfreq(block, 1.0 / rate),
        quantity=common_response([c for r in recordings for c in r.channels]),
        block=block,
        block_reason=reason,
    )


def _aligned(
    chosen: tuple[tuple[Recording, Hit], ...],
) -> tuple[tuple[Recording, Hit], ...]:
    """Return the hits, all with as many samples before the trigger as the least has.

    The end of the record is in the model only where blocks begin alike.
    """
    least = min(hit.trigger - hit.start for _, hit in chosen)
    if least < _LEAST_BEFORE:
        return chosen
    return tuple((r, replace(hit, start=hit.trigger - least)) for r, hit in chosen)


@dataclass(frozen=True, slots=True, eq=False)
class HitForces:
    """Force spectra of all accepted hits; responses are transformed when asked for.

    Attributes:
        frequency: of the lines that were asked for [Hz], shape (n_lines,).
        force: [N s], shape (n_hits, n_lines).
        labels: for each hit, the label of each of its responses.
        points: for each hit, where the hammer struck.
        plan: hits and block.
        window: applied to every hit alike.
        lines: which of those of the block.
    """

    frequency: FloatArray
    force: ComplexArray
    labels: tuple[tuple[str, ...], ...]
    points: tuple[str, ...]
    plan: SpectraPlan
    window: HammerWindow
    lines: BoolArray

    def responses(self, hit: int) -> Iterator[ComplexArray]:
        """Transform the responses of a hit, shape (n_lines,) each."""
        recording, own = self.plan.chosen[hit]
        for row in response_spectra(recording, own, self.window, self.plan.block):
            yield row[self.lines]

    def whole(self) -> HitSpectra:
        """Return the spectra with all responses, read once."""
        plan = self.plan
        size = len(plan.chosen), len(plan.labels[0]), self.frequency.size
        response = np.empty(size, complex)
        for number in range(len(plan.chosen)):
            for row, other in enumerate(self.responses(number)):
                response[number, row] = other
        return HitSpectra(
            frequency=self.frequency,
            force=self.force,
            response=response,
            labels=plan.labels,
            points=plan.points,
            quantity=plan.quantity,
            block=plan.block,
            block_reason=plan.block_reason,
        )


def hit_forces(
    plan: SpectraPlan, window: HammerWindow, lines: BoolArray | None = None
) -> HitForces:
    """Transform the force of every accepted hit; see `hit_spectra`.

    The memory is that of one channel in place of all.

    Args:
        plan: of the hits.
        window: applied to every hit.
        lines: that are kept, shape (n_lines of the block,); None for all.
    """
    kept = np.ones(plan.frequency.size, bool) if lines is None else lines
    force = np.empty((len(plan.chosen), np.count_nonzero(kept)), complex)
    for number, (recording, hit) in enumerate(plan.chosen):
        force[number] = force_spectrum(recording, hit, window, plan.block)[kept]
    frequency = plan.frequency[kept]
    return HitForces(frequency, force, plan.labels, plan.points, plan, window, kept)


class ForcesOfHits(LabelledHits, Protocol):
    """What hits with known force spectra have in common."""

    @property
    def frequency(self) -> FloatArray:
        """[Hz], shape (n_lines,)."""

    @property
    def force(self) -> ComplexArray:
        """[N s], shape (n_hits, n_lines)."""

    def responses(self, hit: int) -> Iterator[ComplexArray]:
        """Yield the response spectra of a hit, shape (n_lines,) each."""


def join_spectra(parts: Sequence[HitSpectra]) -> HitSpectra:
    """Join the spectra of several measurements of the same channels.

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
    """Refuse a hit with a response channel without signal.

    Args:
        recording: holds the hit.
        hit: an accepted one.

    Raises:
        ChannelMissing: a response is constant throughout; the message names all such.
    """
    dead = dead_channels(recording, hit)
    if dead:
        names = ", ".join(f"{name!r} (always {value:.4g})" for name, value in dead)
        raise ChannelMissing(
            f"recording {recording.name!r}: no signal from {names} in the hit at "
            f"{hit.trigger / recording.sample_rate:.4g} s; check the cable and the "
            "sensor, or leave the channel out"
        )


@remembered
def dead_channels(recording: Recording, hit: Hit) -> tuple[tuple[str, float], ...]:
    """Return name and value of each response that is constant throughout a hit."""
    found = []
    for row in response_rows(recording):
        samples = recording.samples[row, hit.start : hit.stop]
        high, low = float(samples.max()), float(samples.min())
        if high - low <= _ROUNDING * max(abs(high), abs(low)):
            found.append((recording.channels[row].name, float(samples[0])))
    return tuple(found)


def force_spectrum(
    recording: Recording, hit: Hit, window: HammerWindow, block: int
) -> ComplexArray:
    """Return the spectrum of the windowed force [N s], see `windowed_hit`."""
    stop, weights = _weights(recording, hit, window, block)
    row = recording.row(Quantity.FORCE)
    force = recording.samples[row, hit.start : stop]
    force = (force - force_offset(recording, hit)) * weights[0]
    return np.asarray(scipy.fft.rfft(force, block) / recording.sample_rate)


def response_spectra(
    recording: Recording, hit: Hit, window: HammerWindow, block: int
) -> Iterator[ComplexArray]:
    """Yield the spectra of windowed responses, one channel at a time.

    Args:
        recording: holds the hit.
        hit: which.
        window: to apply.
        block: number of samples; a shorter hit is padded with zeros.
    """
    stop, weights = _weights(recording, hit, window, block)
    for row in response_rows(recording):
        one = recording.samples[row, hit.start : stop]
        one = (one - one.mean()) * weights[1]
        spectrum = scipy.fft.rfft(one, block, overwrite_x=True)
        spectrum /= recording.sample_rate
        yield spectrum


def _weights(
    recording: Recording, hit: Hit, window: HammerWindow, block: int
) -> tuple[int, tuple[FloatArray, FloatArray]]:
    """Return the end of the segment of a hit, and what its window multiplies."""
    stop = min(hit.stop, hit.start + block)
    count, trigger = stop - hit.start, hit.trigger - hit.start
    return stop, window_weights(window, count, trigger, recording.sample_rate)


def windowed_hit(
    recording: Recording, hit: Hit, window: HammerWindow, block: int
) -> tuple[FloatArray, FloatArray]:
    """Cut a hit out of its recording and window it.

    Args:
        recording: holds the hit.
        hit: which.
        window: to apply.
        block: number of samples; a shorter hit is padded with zeros.

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
        offset=force_offset(recording, hit),
    )
    missing = block - force.size
    return np.pad(force, (0, missing)), np.pad(response, ((0, 0), (0, missing)))


def _labels(recording: Recording) -> tuple[str, ...]:
    return tuple(_label(recording.channels[row]) for row in response_rows(recording))


def _label(channel: Channel) -> str:
    return f"{channel.name}@{channel.point}"


def _require_same_number(labels: Sequence[Sequence[str]]) -> None:
    """Raise `ChannelMissing` where hits have different numbers of responses."""
    numbers = {len(row) for row in labels}
    if len(numbers) != 1:
        raise ChannelMissing(
            f"the recordings have {sorted(numbers)} response channels; "
            "give recordings with equally many"
        )


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
