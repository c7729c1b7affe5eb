# SPDX-License-Identifier: MIT
"""Ring-downs: what the responses do after the force pulse, all hits of all levels."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import (
    Hit,
    Quantity,
    Recording,
    common_response,
    response_rows,
)
from jointbench.signal.frf.frf import KIND_OF_RESPONSE
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.hits.windows import choose_window, force_offset

# The force window keeps ten pulse lengths; the pulse itself is over after two.
_PULSE_OVER = 0.2
# Hits whose record is shorter than this share of the usual one are left out.
_SHORT = 0.5
# Samples of all decays that are held at a time, and hits that are kept of more.
_MOST_SAMPLES, _LEAST_HITS = 25_000_000, 24


@dataclass(frozen=True, slots=True, eq=False)
class RingDowns:
    """Free decays after hammer hits.

    Attributes:
        samples: [unit of the response], shape (n_hits, n_channels, n_samples), from
            the end of the force pulse on.
        sample_rate: [Hz].
        derivatives: 0 for displacement, 1 for velocity, 2 for acceleration.
        unit: of the response.
        labels: channel@point of each channel.
        points: where the hammer struck, one a hit.
        impulse: of the force pulse [N s], shape (n_hits,).
    """

    samples: FloatArray
    sample_rate: float
    derivatives: int
    unit: str
    labels: tuple[str, ...]
    points: tuple[str, ...]
    impulse: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "samples", "impulse")

    def later(self, delay: float) -> "RingDowns":
        """Return the same decays from a later start.

        Args:
            delay: by which they start later [s].
        """
        skipped = round(delay * self.sample_rate)
        return replace(self, samples=self.samples[:, :, skipped:])


_UNITS = {
    Quantity.ACCELERATION: "m/s^2",
    Quantity.VELOCITY: "m/s",
    Quantity.DISPLACEMENT: "m",
}


def ring_downs(recordings: Sequence[Recording]) -> RingDowns:
    """Cut the ring-downs of all accepted hits out of recordings.

    Hits are kept that have the channels which most hits have and whose record is not
    much shorter than that of the others; all are cut to the shortest that is left. Of a
    session beyond 0.2 GB, hits spread over the levels and the strongest channels are
    kept.

    Args:
        recordings: with judged hits, samples as recorded (no smoother, no window).

    Returns:
        The decays, in order of recording and time.

    Raises:
        BadData: no hit was accepted.
        ChannelMissing: responses of different quantities.
    """
    chosen = [(r, hit) for r in recordings for hit in accepted_hits(r)]
    if not chosen:
        raise BadData("no accepted hit, so no ring-down; look at the verdicts")
    quantity = common_response([c for r, _ in chosen for c in r.channels])
    usual = Counter(_labels(r) for r, _ in chosen).most_common(1)[0][0]
    chosen = [(r, hit) for r, hit in chosen if _labels(r) == usual]
    starts = {id(r): _pulse_over(r) for r, _ in chosen}
    lengths = np.array([hit.stop - hit.trigger - starts[id(r)] for r, hit in chosen])
    long = lengths >= _SHORT * np.median(lengths)
    size = int(lengths[long].min())
    kept = [pair for pair, good in zip(chosen, long, strict=True) if good]
    kept, rows = _within_memory(kept, size)
    usual = tuple(usual[row] for row in rows)
    samples = np.empty((len(kept), len(rows), size))
    for number, (recording, hit) in enumerate(kept):
        start = starts[id(recording)]
        samples[number] = _decay(recording, hit, start, size, rows)
    samples.flags.writeable = False  # or the record would copy them
    return RingDowns(
        samples=samples,
        sample_rate=kept[0][0].sample_rate,
        derivatives=KIND_OF_RESPONSE[quantity].derivatives,
        unit=_UNITS[quantity],
        labels=usual,
        points=tuple(hit.point for _, hit in kept),
        impulse=np.array([_impulse(r, hit, starts[id(r)]) for r, hit in kept]),
    )


def _within_memory(
    chosen: list[tuple[Recording, Hit]], size: int
) -> tuple[list[tuple[Recording, Hit]], list[int]]:
    """Return hits spread over all levels, and channels, that fit into memory.

    Args:
        chosen: hits with equal channels.
        size: samples of each decay.

    Returns:
        The hits in their order, and the numbers of the responses in theirs.
    """
    channels = len(response_rows(chosen[0][0]))
    if len(chosen) * channels * size <= _MOST_SAMPLES:
        return chosen, list(range(channels))
    by_level = np.argsort([hit.peak_force for _, hit in chosen], kind="stable")
    number = min(len(chosen), _LEAST_HITS)
    spread = np.linspace(0, len(chosen) - 1, number).round().astype(int)
    hits = [chosen[i] for i in sorted(by_level[spread].tolist())]
    recording, hardest = chosen[int(by_level[-1])]
    power = [
        float(np.mean(recording.samples[row, hardest.trigger : hardest.stop] ** 2))
        for row in response_rows(recording)
    ]
    fitting = max(1, _MOST_SAMPLES // (number * size))
    return hits, sorted(np.argsort(power)[::-1][:fitting].tolist())


def _labels(recording: Recording) -> tuple[str, ...]:
    channels = (recording.channels[row] for row in response_rows(recording))
    return tuple(f"{c.name}@{c.point}" for c in channels)


def _pulse_over(recording: Recording) -> int:
    """Return the samples from the trigger after which no force acts any more."""
    width = choose_window(recording).force_width or 0.0
    return int(np.ceil(_PULSE_OVER * width * recording.sample_rate))


def _decay(
    recording: Recording, hit: Hit, start: int, size: int, rows: Sequence[int]
) -> FloatArray:
    responses = response_rows(recording)
    first = hit.trigger + start
    return recording.samples[[responses[row] for row in rows], first : first + size]


def _impulse(recording: Recording, hit: Hit, start: int) -> float:
    trigger = hit.trigger - hit.start
    past = max(hit.stop, hit.trigger + start)
    force = recording.samples[recording.row(Quantity.FORCE), hit.start : past]
    pulse = force[trigger : trigger + start] - force_offset(recording, hit)
    return float(pulse.sum() / recording.sample_rate)
