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
from jointbench.signal.hits.windows import choose_window, quiet_mean

# The force window keeps ten pulse lengths; the pulse itself is over after two.
_PULSE_OVER = 0.2
# Hits whose record is shorter than this share of the usual one are left out.
_SHORT = 0.5


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
    much shorter than that of the others; all are cut to the shortest that is left.

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
    return RingDowns(
        samples=np.array([_decay(r, hit, starts[id(r)], size) for r, hit in kept]),
        sample_rate=kept[0][0].sample_rate,
        derivatives=KIND_OF_RESPONSE[quantity].derivatives,
        unit=_UNITS[quantity],
        labels=usual,
        points=tuple(hit.point for _, hit in kept),
        impulse=np.array([_impulse(r, hit, starts[id(r)]) for r, hit in kept]),
    )


def _labels(recording: Recording) -> tuple[str, ...]:
    channels = (recording.channels[row] for row in response_rows(recording))
    return tuple(f"{c.name}@{c.point}" for c in channels)


def _pulse_over(recording: Recording) -> int:
    """Return the samples from the trigger after which no force acts any more."""
    width = choose_window(recording).force_width or 0.0
    return int(np.ceil(_PULSE_OVER * width * recording.sample_rate))


def _decay(recording: Recording, hit: Hit, start: int, size: int) -> FloatArray:
    rows = list(response_rows(recording))
    first = hit.trigger + start
    return recording.samples[rows, first : first + size]


def _impulse(recording: Recording, hit: Hit, start: int) -> float:
    force = recording.samples[recording.row(Quantity.FORCE)]
    offset = quiet_mean(force[hit.start : hit.stop], hit.trigger - hit.start)
    pulse = force[hit.trigger : hit.trigger + start] - offset
    return float(pulse.sum() / recording.sample_rate)
