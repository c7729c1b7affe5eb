# SPDX-License-Identifier: MIT
"""What further hits would buy: frequency and damping of the peaks, and their scatter.

Around each peak of an average all responses are fitted by one pole and a residual term
each, H_r = (a_r + b_r s) / (s - p), with the variance of the average as weight. This
takes milliseconds, so it can be done after every hit; it does not replace the fit of
modes, which separates close ones.

Source:
    Sanathanan and Koerner, IEEE Trans. Autom. Control 8 (1963) 56 (iterated weights);
    Kay, Statistical Signal Processing 1 (1993), sec. 15.7 (bound of complex
    parameters).
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.frf.frf import Frf

_MOST_PEAKS = 6
_WIDTHS = 3.0
"""Half-power widths of a peak on each side that are fitted."""
_LEAST_LINES = 4
"""Lines on each side of a peak at least: five unknowns need more lines than that."""
_STAND_OUT = 10.0
"""Power of a peak over the median of the band [-]; less is no resonance to fit."""
_ROUNDS = 4


@dataclass(frozen=True, slots=True)
class PeakForecast:
    """One resonance, as hits so far and some more determine it.

    Attributes:
        frequency: [Hz].
        damping: damping ratio [-], without that of the window.
        frequency_sd: standard deviation now [Hz].
        damping_sd: of the damping ratio now, relative to it [-].
        frequency_sd_after: with the further hits [Hz].
        damping_sd_after: with the further hits, relative [-].
    """

    frequency: float
    damping: float
    frequency_sd: float
    damping_sd: float
    frequency_sd_after: float
    damping_sd_after: float


def further_hits(frf: Frf, *, more: int = 2) -> tuple[PeakForecast, ...]:
    """Forecast the scatter of the strongest resonances after further hits.

    Args:
        frf: average of at least two hits, with its variance.
        more: number of further hits; the variance of an average falls as 1 / hits.

    Returns:
        Forecasts in order of frequency; empty without a variance or a clear peak.
    """
    if frf.variance is None or frf.averages < 2:
        return ()
    low, high = frf.usable_band or (float(frf.frequency[0]), float(frf.frequency[-1]))
    inside = (frf.frequency >= max(low, 1e-9)) & (frf.frequency <= high)
    frequency = frf.frequency[inside]
    rows = frf.response[:, :, inside].reshape(-1, frequency.size)
    variance = frf.variance[:, :, inside].reshape(rows.shape)
    share = np.sqrt(frf.averages / (frf.averages + more))
    found = (
        _forecast(frequency, rows, variance, place, (frf.added_decay_rate, share))
        for place in _peaks(rows)
    )
    return tuple(sorted((f for f in found if f), key=lambda f: f.frequency))


def _peaks(rows: ComplexArray) -> list[int]:
    """Return the highest local maxima of the power of all responses."""
    scale = np.mean(np.abs(rows) ** 2, axis=1, keepdims=True)
    power = np.sum(np.abs(rows) ** 2 / np.where(scale > 0, scale, 1.0), axis=0)
    inner = power[1:-1]
    tops = np.flatnonzero((inner > power[:-2]) & (inner >= power[2:])) + 1
    tops = tops[power[tops] > _STAND_OUT * np.median(power)]
    chosen: list[int] = []
    for top in tops[np.argsort(-power[tops])]:
        width = _half_width(power, int(top))
        if all(abs(int(top) - other) > 2 * width for other in chosen):
            chosen.append(int(top))
        if len(chosen) == _MOST_PEAKS:
            break
    return chosen


def _half_width(power: FloatArray, top: int) -> int:
    """Return how many lines beside a peak the power falls below half."""
    below = np.flatnonzero(power < 0.5 * power[top])
    return int(np.min(np.abs(below - top))) if below.size else power.size


def _forecast(
    frequency: FloatArray,
    rows: ComplexArray,
    variance: FloatArray,
    top: int,
    rule: tuple[float, float],
) -> PeakForecast | None:
    power = np.sum(np.abs(rows) ** 2, axis=0)
    reach = max(_LEAST_LINES, round(_WIDTHS * _half_width(power, top)))
    part = slice(max(0, top - reach), top + reach + 1)
    s = np.asarray(2j * np.pi * frequency[part], dtype=np.complex128)
    least = np.finfo(float).tiny + 1e-20 * np.max(np.abs(rows)) ** 2
    weight = 1.0 / np.sqrt(np.maximum(variance[:, part], least))
    pole = complex(-np.pi * (frequency[1] - frequency[0]), s[top - part.start].imag)
    information = 0.0
    for _ in range(_ROUNDS):
        pole, information = _step(s, rows[:, part], weight, pole)
    added, share = rule
    decay = -pole.real - added
    if decay <= 0.0 or information <= 0.0 or not s[0].imag < pole.imag < s[-1].imag:
        return None
    sd, size = np.sqrt(0.5 / information), abs(complex(decay, pole.imag))
    now = sd / (2 * np.pi), sd / decay
    return PeakForecast(
        size / (2 * np.pi), decay / size, *now, share * now[0], share * now[1]
    )


def _step(
    s: ComplexArray, rows: ComplexArray, weight: FloatArray, pole: complex
) -> tuple[complex, float]:
    """Return a better pole and the information on it, summed over the responses.

    (s - p) H_r = a_r + b_r s is linear; its weight is that of H over |s - p|. What the
    residual terms explain is projected out.
    """
    above, below = 0.0 + 0.0j, 0.0
    middle = s[s.size // 2]
    for row, own in zip(rows, weight, strict=True):
        scale = own / np.abs(s - pole)
        others = np.stack((scale, scale * (s - middle)), axis=1).astype(complex)
        base = np.linalg.qr(others)[0]
        column, wanted = scale * row, scale * s * row
        column = column - base @ (base.conj().T @ column)
        above += np.vdot(column, wanted)
        below += float(np.vdot(column, column).real)
    return (complex(above / below) if below > 0.0 else pole), below
