# SPDX-License-Identifier: MIT
"""Leakage of hammer hits: share of each line cut off by the end of the block.

A response that has decayed has no leakage. The part cut off is extrapolated from the
end of the block: where the energy around a line falls by r from the third quarter to
the fourth, the energy after the block is r / (1 - r) of the fourth quarter.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft
from scipy.ndimage import uniform_filter1d

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import NoHitFound
from jointbench.acquisition.records.recordings import Hit, Recording
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.hits.hit_spectra import windowed_hit
from jointbench.signal.hits.windows import HammerWindow

_QUARTERS = 4
# Lines over which energy is summed: a quarter of the block spreads a peak over a dozen
# lines.
_AROUND_LINES = 33
# Fourth quarters within this factor of the noise before the hit are not used.
_ABOVE_NOISE = 4.0
# Lines within 20 dB of the strongest.
_LOUD = 0.01
# Limit of the extrapolation where the energy hardly falls.
_SLOWEST = 0.98


@dataclass(frozen=True, slots=True, eq=False)
class Leakage:
    """Share of each line cut off by the end of the block.

    Attributes:
        frequency: [Hz], shape (n_lines,).
        share: amplitude cut off over amplitude measured, worst hit and response [-],
            shape (n_lines,); 0 where the end of the block is noise, too high on lines
            far below their neighbours.
        typical: of all lines, each weighted by its power [-].
        worst_frequency: where share times amplitude is largest [Hz].
        worst: the share there [-].
    """

    frequency: FloatArray
    share: FloatArray
    typical: float
    worst_frequency: float
    worst: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "share")


def estimate_leakage(
    recordings: Sequence[Recording], window: HammerWindow | None = None
) -> Leakage:
    """Estimate the leakage of all accepted hits, as windowed.

    Args:
        recordings: with hits found.
        window: as used for the FRF; an exponential window reduces leakage and adds
            damping that is subtracted again. None for no window.

    Returns:
        Worst over hits and responses, on the lines of the shortest hit.

    Raises:
        NoHitFound: no hit was accepted.
    """
    chosen = [(r, hit) for r in recordings for hit in accepted_hits(r)]
    if not chosen:
        raise NoHitFound("no hit was accepted: there is no leakage to estimate")
    block = min(hit.stop - hit.start for _, hit in chosen)
    rate = chosen[0][0].sample_rate
    parts = [_hit_share(r, hit, window or HammerWindow(), block) for r, hit in chosen]
    share = np.max([p[0] for p in parts], axis=0)
    power = np.mean([p[1] for p in parts], axis=0)
    # Side lobes of the cut quarters mask weak lines: only strong ones are judged.
    loud = power > _LOUD * power.max()
    worst = int(np.argmax(np.where(loud, share**2 * power, 0.0)))
    frequency = scipy.fft.rfftfreq(block, 1.0 / rate)
    typical = float(np.sqrt(np.sum((share**2 * power)[loud]) / np.sum(power)))
    return Leakage(
        frequency, share, typical, float(frequency[worst]), float(share[worst])
    )


def _hit_share(
    recording: Recording, hit: Hit, window: HammerWindow, block: int
) -> tuple[FloatArray, FloatArray]:
    """Return share and power of each line of a hit, worst and mean over responses.

    With energies around a line: beyond / measured = x^2 / (1 - x^2) of one mode, where
        x is the remaining share of its amplitude; its line then lacks x / (1 - x).
    """
    _, response = windowed_hit(recording, hit, window, block)
    trigger = hit.trigger - hit.start
    quarter = (block - trigger) // _QUARTERS
    quiet = response[:, : max(1, (3 * trigger) // 4)]
    noise = np.mean(quiet**2, axis=1, keepdims=True) * quarter
    third, fourth = (
        _energy(response[:, block - i * quarter : block - (i - 1) * quarter], block)
        for i in (2, 1)
    )
    heard = fourth > _ABOVE_NOISE * noise
    third, fourth = np.maximum(third - noise, 0.0), np.maximum(fourth - noise, 0.0)
    ratio = np.clip(fourth / np.where(third > 0.0, third, 1.0), 0.0, _SLOWEST)
    whole = _energy(response, block)
    beyond = fourth * ratio / (1.0 - ratio) / np.where(whole > 0.0, whole, 1.0)
    left = np.sqrt(beyond / (1.0 + beyond))
    share = np.where(heard, left / (1.0 - left), 0.0)
    return share.max(axis=0), whole.mean(axis=0)


def _energy(samples: FloatArray, points: int) -> FloatArray:
    """Return power around each line of the block, shape (n_responses, n_lines)."""
    spectrum = np.abs(scipy.fft.rfft(samples, points, axis=1)) ** 2
    return np.asarray(uniform_filter1d(spectrum, _AROUND_LINES, axis=1, mode="nearest"))
