# SPDX-License-Identifier: MIT
"""Choose the band in which an FRF is fitted."""

import numpy as np
from scipy.ndimage import median_filter

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.frf.frf import Frf

# Lines at and next to DC hold offsets and drift, not the structure.
_DC_LINES = 2
_FLANK_LINES = 5
# The level rises once it is this far above its lowest value so far: 6 dB.
_RISEN = 2.0
_LEAST_COHERENCE = 0.5
_LEAST_LINES = 16


def choose_band(
    frf: Frf, band: tuple[float, float] | None = None
) -> tuple[BoolArray, str]:
    """Choose the lines to fit.

    The default is the excited band (see `Frf.usable_band`), without the lines around DC
    and without a flank from DC that is higher than any resonance. It ends where
    coherence is permanently lost.

    Args:
        frf: any kind.
        band: lowest and highest frequency [Hz], or None for the automatic choice.

    Returns:
        True for the lines to fit, shape (n_lines,), and the reason as text.

    Raises:
        BadData: fewer than 16 lines are left.
    """
    frequency = frf.frequency
    if band is not None:
        low, high, reason = *band, "as given"
    else:
        low, high = frf.usable_band or (float(frequency[0]), float(frequency[-1]))
        reason = "excited band" if frf.usable_band else "all lines"
        start, end = _above_drift(frf, high), _coherent_up_to(frf)
        if start > low:
            low, reason = start, f"{reason}, above drift at DC"
        if end < high:
            high, reason = end, f"{reason}, while coherent"
    keep: BoolArray = (frequency >= low) & (frequency <= high)
    keep &= frequency > _DC_LINES * float(np.median(np.diff(frequency)))
    if np.count_nonzero(keep) < _LEAST_LINES:
        raise BadData(
            f"the band {low:g} to {high:g} Hz holds {np.count_nonzero(keep)} lines of "
            f"this FRF ({frequency[0]:g} to {frequency[-1]:g} Hz), at least "
            f"{_LEAST_LINES} are needed; {_more_lines(frequency, low, high, band)}"
        )
    return keep, f"{low:g} to {high:g} Hz: {reason}"


def _more_lines(
    frequency: FloatArray,
    low: float,
    high: float,
    band: tuple[float, float] | None,
) -> str:
    """Return the advice for too few lines: a longer record or a wider band."""
    now = 1.0 / float(np.median(np.diff(frequency)))
    width = min(high, float(frequency[-1])) - max(low, float(frequency[0]))
    needed = (_LEAST_LINES + _DC_LINES + 1) / width if width > 0.0 else 0.0
    longer = f"record {needed:.3g} s after each hit instead of {now:.3g} s"
    if band is None and needed > now:
        return longer
    return f"give a wider --band or {longer}" if needed > now else "give a wider --band"


def _above_drift(frf: Frf, high: float) -> float:
    """Return the first frequency above a drift flank higher than all resonances [Hz].

    Double integration turns offsets into a flank that falls from DC. It ends where the
    level first rises again; only its lines higher than all later lines are left out. A
    static compliance does not fall, so a low first mode is kept.
    """
    first = _DC_LINES + 1
    level = _mean_level(frf)[first : np.count_nonzero(frf.frequency <= high)]
    if level.size == 0:
        return float(frf.frequency[0])
    level = median_filter(level, _FLANK_LINES, mode="nearest")
    lowest = np.minimum.accumulate(level)
    rising = np.flatnonzero(level > _RISEN * lowest)
    turn = int(np.argmin(level[: rising[0]])) if rising.size else 0
    towering = np.flatnonzero(level[:turn] > level[turn:].max())
    return float(frf.frequency[first + towering[-1] + 1] if towering.size else 0.0)


def _mean_level(frf: Frf) -> FloatArray:
    """Return |FRF| averaged over pairs, each scaled by its own median."""
    level = np.abs(frf.response)
    scale = np.median(level, axis=2, keepdims=True)
    return np.asarray(np.mean(level / np.where(scale > 0, scale, 1.0), axis=(0, 1)))


def _coherent_up_to(frf: Frf) -> float:
    """Return the last frequency with an acceptable local median coherence [Hz]."""
    if frf.coherence is None or frf.averages < 3:
        return float(frf.frequency[-1])
    mean = np.mean(frf.coherence, axis=(0, 1))
    around = median_filter(mean, max(3, mean.size // 50), mode="nearest")
    fair = np.flatnonzero(around > _LEAST_COHERENCE)
    return float(frf.frequency[fair[-1]]) if fair.size else float(frf.frequency[-1])
