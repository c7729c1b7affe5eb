# SPDX-License-Identifier: MIT
"""Choose the band in which an FRF is fitted."""

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.frf.frf import Frf

# Power of the force over its low end below which a line is not excited, as in
# `excited_band`, and over the lower of both sides below which that is a null.
_NOT_EXCITED, _NULL = 1e-2, 0.1
# The power of a force is averaged over this many lines in search of nulls.
_POWER_LINES = 5
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


def force_nulls(frf: Frf, keep: BoolArray) -> BoolArray:
    """Return the lines at which the force has a null within a band.

    There the FRF is the ratio of two small numbers: leakage, an offset and the window
    make a peak of it that no mode has, and that hits may share, so that neither their
    scatter nor the noise of the channels shows it.

    Args:
        frf: any; the power of its force follows from the noise that it divides.
        keep: lines of the band, shape (n_lines,).

    Returns:
        True for the kept lines where the force of any input is 20 dB below its low end
        and 10 dB below its level within the band on either side, shape (n_lines,); none
        where the noise of force and response is not known.
    """
    null = np.zeros(keep.size, bool)
    for power in _force_power(frf):
        level = uniform_filter1d(power, _POWER_LINES, mode="nearest")
        lowest = _NOT_EXCITED * level[: level.size // 4 + 1].max()
        inside = level[keep]
        left = np.maximum.accumulate(inside)
        right = np.maximum.accumulate(inside[::-1])[::-1]
        dip = inside < np.minimum(lowest, _NULL * np.minimum(left, right))
        null[np.flatnonzero(keep)[dip]] = True
    return null


def null_words(frequency: FloatArray, null: BoolArray) -> tuple[str, ...]:
    """State which lines a null of the force cost, none where there is none.

    Args:
        frequency: of the lines [Hz].
        null: from `force_nulls`, same shape.
    """
    at = np.flatnonzero(null)
    if at.size == 0:
        return ()
    spans = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1)
    listed = ", ".join(
        f"{frequency[span[0]]:.4g} to {frequency[span[-1]]:.4g} Hz" for span in spans
    )
    return (
        f"the force has next to no power at {listed}: these lines are left out, and a "
        "mode there cannot be found; hit with a harder or softer tip",
    )


def _force_power(frf: Frf) -> FloatArray:
    """Return the power of the force of each input in any unit, (n_inputs, n_lines).

    The noise of a channel in an FRF is white noise over that power.
    """
    if frf.innovation_noise is not None:
        noise = np.max(frf.innovation_noise, axis=0)
    elif frf.force_noise is not None:
        square = np.abs(frf.response) ** 2
        share = frf.force_noise / np.where(square > 0.0, square, np.inf)
        noise = np.max(share, axis=0)
    else:
        return np.empty((0, frf.frequency.size))
    return np.asarray(1.0 / np.where(noise > 0.0, noise, np.inf))


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
