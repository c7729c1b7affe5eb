# SPDX-License-Identifier: MIT
"""Report peaks of an FRF above the fitted band, and the force spectrum there.

The default band ends where the force has fallen by 20 dB. A structure may have its
highest peaks above it; with good coherence they can be fitted too.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.frf.frf import Frf

_ALIAS_FREE = 2.0 / 2.56
"""Share of the lines that anti-alias filters of usual converters leave [-]."""
_STANDS_OUT = 3.0
"""Least height of a reported peak over the adjacent minima [-]."""
_SMOOTH = 9
"""Lines of the running median of the level."""
_LEAST_HEIGHT = 0.01
"""Least height of a reported peak over the highest peak of the band [-]."""
_LEAST_COHERENCE = 0.8
_AROUND, _APART = 50, 200
"""Shares of the lines: neighbourhood of a peak, and least distance of two peaks."""
_MOST = 5


@dataclass(frozen=True, slots=True)
class Peak:
    """One peak above the band.

    Attributes:
        frequency: [Hz].
        height: over the highest line of the band [-].
        coherence: mean over pairs there [-], or None for single hits.
        force_drop: force spectrum below its highest [dB], or None without one.
    """

    frequency: float
    height: float
    coherence: float | None
    force_drop: float | None


@dataclass(frozen=True, slots=True)
class Beyond:
    """Peaks and force above a band.

    Attributes:
        begin: of the band [Hz].
        end: of the band [Hz].
        force_drop: of the force as recorded, at the end of the band [dB], or None
            without a force.
        reach: upper limit without aliasing [Hz].
        peaks: the highest ones, by ascending frequency.
    """

    begin: float
    end: float
    force_drop: float | None
    reach: float
    peaks: tuple[Peak, ...]

    def words(self) -> str:
        """Return one sentence on the peaks above the band; empty if it is complete."""
        if self.end >= self.reach:
            return ""
        end = f"the band ends at {_hertz(self.end)}{self._force_words()}; above it"
        if not self.peaks:
            return f"{end} no peak stands out up to {_hertz(self.reach)}"
        highest = max(self.peaks, key=lambda p: p.height)
        top = min(self.reach, _round_up(1.05 * self.peaks[-1].frequency))
        return (
            f"{end} peaks stand out, the highest at {_hertz(highest.frequency)}, "
            f"{highest.height:.2g} times as high as the highest within; to fit them "
            f"too: --band {self.begin:.3g}:{top:g}"
        )

    def _force_words(self) -> str:
        """State how far the force has fallen where the band ends."""
        if self.force_drop is None:
            return ""
        down = max(0.0, -self.force_drop)
        return f", where the recorded force spectrum has fallen by {down:.0f} dB"


def look_beyond(
    frf: Frf, band: tuple[float, float], force_power: FloatArray | None
) -> Beyond:
    """Find peaks above a band.

    Args:
        frf: of all lines.
        band: lowest and highest line that was fitted [Hz].
        force_power: mean of |F|^2 over the accepted hits [N^2 s^2], shape (n_lines,);
            None for FRFs from files, which may be fitted up to their last line.

    Returns:
        Up to five peaks, those three times as high as the adjacent minima, with a
        coherence above 0.8 where there is one.
    """
    frequency = frf.frequency
    level = np.sqrt(np.mean(np.abs(frf.response) ** 2, axis=(0, 1)))
    reach = float(frequency[-1]) * (1.0 if force_power is None else _ALIAS_FREE)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    drop = None if force_power is None else _force_drop(force_power)
    coherence = None if frf.coherence is None else frf.coherence.mean(axis=(0, 1))
    highest = float(level[inside].max())
    peaks = [
        Peak(
            frequency=float(frequency[i]),
            height=float(level[i]) / highest,
            coherence=None if coherence is None else float(coherence[i]),
            force_drop=None if drop is None else float(drop[i]),
        )
        for i in _standing_out(level)
        if band[1] < frequency[i] <= reach
        and level[i] >= _LEAST_HEIGHT * highest
        and (coherence is None or coherence[i] >= _LEAST_COHERENCE)
    ]
    tallest = sorted(peaks, key=lambda p: -p.height)[:_MOST]
    return Beyond(
        begin=band[0],
        end=band[1],
        force_drop=(
            None if drop is None else float(np.interp(band[1], frequency, drop))
        ),
        reach=reach,
        peaks=tuple(sorted(tallest, key=lambda p: p.frequency)),
    )


def _force_drop(power: FloatArray) -> FloatArray:
    """Return the force spectrum over its highest [dB], smoothed, shape (n_lines,)."""
    smooth = uniform_filter1d(power, max(3, power.size // _AROUND), mode="nearest")
    floor = np.finfo(float).tiny
    return np.asarray(
        10.0 * np.log10(np.maximum(smooth, floor) / max(smooth.max(), floor))
    )


def _standing_out(level: FloatArray) -> Sequence[int]:
    """Return the lines of peaks that exceed their neighbourhood.

    Noise of a single hit is rough from line to line; the median of a few is not.
    """
    from scipy.signal import find_peaks  # slow to import

    smooth = median_filter(level, _SMOOTH, mode="nearest")
    floor = max(float(smooth.max()), 1.0) * np.finfo(float).eps
    found, _ = find_peaks(
        np.log(np.maximum(smooth, floor)),
        prominence=float(np.log(_STANDS_OUT)),
        distance=max(1, level.size // _APART),
    )
    return [
        max(0, i - _SMOOTH) + int(np.argmax(level[max(0, i - _SMOOTH) : i + _SMOOTH]))
        for i in found.tolist()
    ]


def _round_up(frequency: float) -> float:
    """Return the next number of two digits [Hz]."""
    step = 10.0 ** (np.floor(np.log10(frequency)) - 1)
    return float(np.ceil(frequency / step) * step)


def _hertz(frequency: float) -> str:
    return f"{frequency:.0f} Hz" if frequency >= 100.0 else f"{frequency:.3g} Hz"
