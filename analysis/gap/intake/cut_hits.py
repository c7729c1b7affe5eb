# SPDX-License-Identifier: MIT
"""Cut the accepted hits of recordings into records of one length, from rest to rest.

The model is integrated from rest under the measured force. Each record therefore begins
with a quiet stretch, and a hit during the response to the previous one is left out: the
remaining response would appear as a missing effect.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import (
    BadData,
    ChannelMissing,
    NoHitFound,
    SamplingError,
)
from jointbench.acquisition.records.recordings import Hit, Quantity, Recording, Verdict
from jointbench.analysis.gap.intake.intake_settings import INTAKE
from jointbench.analysis.gap.residuals.noise_models import high_band_sigma

PRETRIGGER = INTAKE.pretrigger_samples
QUIET = INTAKE.quiet_samples
SHORTEST = INTAKE.shortest_record


@dataclass(frozen=True, slots=True, eq=False)
class CutHits:
    """Hits as records of one length.

    Attributes:
        force: [N], shape (n_hits, n_samples).
        response: [SI], shape (n_hits, n_channels, n_samples).
        recording: index of the recording of each hit, shape (n_hits,).
        hits: in the order of the recordings.
        sample_rate: [Hz].
        left_out: one line with the reason for each accepted hit that was not cut.
    """

    force: FloatArray
    response: FloatArray
    recording: IntArray
    hits: tuple[Hit, ...]
    sample_rate: float
    left_out: tuple[str, ...]

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "force", "response", "recording")


@dataclass(frozen=True, slots=True, eq=False)
class _Strike:
    """One accepted hit with the samples around it."""

    recording: int
    name: str
    hit: Hit
    samples: FloatArray
    previous: int
    room: int

    @property
    def first(self) -> int:
        return self.hit.trigger - PRETRIGGER

    @property
    def quiet_from(self) -> int:
        return max(self.first + QUIET - INTAKE.look_back_samples, self.previous + 1, 0)

    @property
    def words(self) -> str:
        return f"hit of {self.hit.peak_force:.4g} N in recording {self.name!r}"


def cut_hits(recordings: Sequence[Recording], channels: Sequence[str]) -> CutHits:
    """Cut every accepted hit, with a quiet pre-trigger and enough of its response.

    Args:
        recordings: with judged hits, all at one sample rate.
        channels: names of the response channels, in the order of the result.

    Returns:
        The records, without offsets that are significant in the quiet stretches.

    Raises:
        SamplingError: the sample rates differ.
        ChannelMissing: a recording lacks a channel.
        NoHitFound: no hit was accepted.
        BadData: half of the accepted hits or more cannot be cut.
    """
    rate = _common_rate(recordings)
    strikes = [
        strike
        for number, recording in enumerate(recordings)
        for strike in _strikes(number, recording, channels)
    ]
    if not strikes:
        raise NoHitFound(_nothing_accepted(recordings))
    problems = [_problem(strike, rate) for strike in strikes]
    good = [s for s, problem in zip(strikes, problems, strict=True) if not problem]
    left_out = tuple(problem for problem in problems if problem)
    if len(left_out) >= max(len(good), 1):
        raise BadData(
            f"{len(left_out)} of {len(strikes)} hits cannot be cut from rest to rest: "
            f"{left_out[0]}"
        )
    length = _length(good)
    cut = np.stack([s.samples[:, s.first : s.first + length] for s in good])
    cut -= _offsets(good)[:, :, None]
    return CutHits(
        force=cut[:, 0],
        response=cut[:, 1:],
        recording=np.array([s.recording for s in good], dtype=np.int64),
        hits=tuple(s.hit for s in good),
        sample_rate=rate,
        left_out=left_out,
    )


def _common_rate(recordings: Sequence[Recording]) -> float:
    rates = sorted({recording.sample_rate for recording in recordings})
    if len(rates) != 1:
        shown = ", ".join(f"{rate:g}" for rate in rates) or "none"
        raise SamplingError(
            f"the recordings have the sample rates {shown} Hz, one is needed; give "
            "only those of one rate"
        )
    return rates[0]


def _strikes(
    number: int, recording: Recording, channels: Sequence[str]
) -> list[_Strike]:
    """Return the accepted hits of a recording."""
    names = [channel.name for channel in recording.channels]
    missing = [name for name in channels if name not in names]
    if missing:
        raise ChannelMissing(
            f"recording {recording.name!r} has no channel {missing[0]!r}, which the "
            f"model names; its channels are {', '.join(names)}"
        )
    rows = [recording.row(Quantity.FORCE), *(names.index(name) for name in channels)]
    samples = recording.samples[rows]
    triggers = [hit.trigger for hit in recording.hits]
    found = []
    for hit in recording.hits:
        if hit.verdict is not Verdict.OK:
            continue
        later = [t - QUIET for t in triggers if t > hit.trigger]
        end = min([samples.shape[1], *later])
        before = max((t for t in triggers if t < hit.trigger), default=-1)
        room = end - hit.trigger + PRETRIGGER
        found.append(_Strike(number, recording.name, hit, samples, before, room))
    return found


def _nothing_accepted(recordings: Sequence[Recording]) -> str:
    verdicts = [hit.verdict.value for r in recordings for hit in r.hits]
    counts = ", ".join(f"{verdicts.count(w)} {w}" for w in dict.fromkeys(verdicts))
    return f"no hit was accepted ({counts or 'none found'}); hit again"


def _problem(strike: _Strike, rate: float) -> str:
    """Return the reason why a hit cannot be cut, with advice, or an empty text."""
    if strike.first < 0:
        return (
            f"the {strike.words} has {strike.hit.trigger} samples before it, "
            f"{PRETRIGGER} are needed ({1e3 * PRETRIGGER / rate:.3g} ms); record with "
            "a longer pre-trigger"
        )
    if strike.room < SHORTEST:
        return (
            f"only {1e3 * (strike.room - PRETRIGGER) / rate:.3g} ms follow the "
            f"{strike.words}, {1e3 * SHORTEST / rate:.3g} ms are needed; record longer "
            "or wait longer between hits"
        )
    for row, channel in enumerate(strike.samples):
        unrest = _unrest(strike, channel, rate, "force" if row == 0 else "response")
        if unrest:
            return unrest
    return ""


def _unrest(strike: _Strike, channel: FloatArray, rate: float, what: str) -> str:
    """Return the signal on a channel before the hit as text, empty if quiet."""
    end = strike.first + QUIET
    piece = channel[strike.quiet_from : end]
    if piece.size < QUIET:
        return (
            f"the {strike.words} follows another pulse after "
            f"{1e3 * (strike.hit.trigger - strike.previous) / rate:.3g} ms; wait until "
            "the response has decayed"
        )
    after = channel[strike.hit.trigger : strike.first + strike.room]
    rms, peak = float(np.std(piece)), float(np.abs(after - piece.mean()).max())
    noise = float(high_band_sigma(piece - piece.mean()))
    if (
        strike.previous >= 0
        and rms > INTAKE.ringing_ratio * noise
        and _decays(strike, channel)
    ):
        wait = (strike.hit.trigger - strike.previous) / rate
        return (
            f"the {strike.words} comes {wait:.3g} s after the one before, while that "
            f"{what} has not decayed; wait longer between hits"
        )
    if rms > INTAKE.steady_share * peak and rms > INTAKE.ringing_ratio * noise:
        return (
            f"before the {strike.words} its {what} is not quiet: {rms:.3g} rms against "
            f"a peak of {peak:.3g}; hit only when the bench is at rest"
        )
    return ""


def _decays(strike: _Strike, channel: FloatArray) -> bool:
    """Return whether the signal since the last hit still decays."""
    end = strike.first + QUIET
    quarter = (end - strike.previous) // 4
    if quarter < 8:
        return True
    last, third = (
        channel[end - quarter : end],
        channel[end - 2 * quarter : end][:quarter],
    )
    return bool(np.std(last) < INTAKE.decaying_ratio * np.std(third))


def _length(strikes: Sequence[_Strike]) -> int:
    """Return the number of samples of each record."""
    most = int(
        np.clip(
            INTAKE.channel_samples // len(strikes), 2 * SHORTEST, INTAKE.longest_record
        )
    )
    wanted = max(_needed(strike, most) for strike in strikes)
    return max(SHORTEST, min(wanted, min(strike.room for strike in strikes)))


def _needed(strike: _Strike, most: int) -> int:
    """Return the number of samples after which the response to a hit has decayed."""
    room = min(strike.room, most)
    if room < 2 * INTAKE.decay_block + PRETRIGGER:
        return room
    span = strike.samples[1:, strike.first : strike.first + room]
    blocks = room // INTAKE.decay_block
    cut = span[:, : blocks * INTAKE.decay_block].reshape(
        span.shape[0], blocks, INTAKE.decay_block
    )
    rms = cut.std(axis=2)
    strong = np.flatnonzero(
        (rms > INTAKE.decayed_share * rms.max(axis=1, keepdims=True)).any(axis=0)
    )
    return min(int(strong[-1] + 2) * INTAKE.decay_block, room)


def _offsets(strikes: Sequence[_Strike]) -> FloatArray:
    """Return the offset to subtract from each channel, shape (n_hits, n_channels).

    The offset of a measuring chain is constant during a session, so it is the mean of
    all quiet stretches if that is significant; a hit has its own offset only if its
    stretch is white noise about another mean.
    """
    quiet = [_quiet(strike) for strike in strikes]
    means = np.stack([piece.mean(axis=1) for piece in quiet])
    common = means.mean(axis=0)
    doubt = means.std(axis=0) / np.sqrt(max(len(strikes) - 1, 1))
    common = np.where(np.abs(common) > INTAKE.offset_sd * doubt, common, 0.0)
    offsets = np.tile(common, (len(strikes), 1))
    for row, piece in enumerate(quiet):
        rms = piece.std(axis=1)
        noise = high_band_sigma(piece - means[row][:, None])
        apart = np.abs(means[row] - common) > INTAKE.offset_sd * rms / np.sqrt(
            piece.shape[1]
        )
        own = apart & (rms <= INTAKE.ringing_ratio * noise)
        offsets[row, own] = means[row, own]
    return offsets


def _quiet(strike: _Strike) -> FloatArray:
    """Return the quiet stretch before a hit, shape (n_channels, n)."""
    return strike.samples[:, strike.quiet_from : strike.first + QUIET]
