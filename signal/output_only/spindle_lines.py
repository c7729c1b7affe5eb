# SPDX-License-Identifier: MIT
"""Find the sines of a rotating spindle in a record, and take them out.

A sine has no bandwidth: its line stands out of the neighbouring lines of the whole
record, however long that is, while a resonance driven by noise spreads over many lines
with a power that is exponentially distributed. No tachometer is needed.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy.fft
from scipy.ndimage import maximum_filter1d, median_filter

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import Recording, response_rows

# Lines on which the level around a line is estimated; a resonance is wider. Their
# median scatters like chi-squared of twice the freedom: neighbours are correlated.
_AROUND, _FREEDOM = 41, 12.0
# Chance that noise alone brings a line forth in a whole record.
_CHANCE = 1e-3
# A sine whose frequency was refined leaves less than this; else it is no steady sine.
_LEFT = 0.1
_ROUNDS = 3
_MOST_LINES = 64
_NEWTON = 20


@dataclass(frozen=True, slots=True, eq=False)
class SpindleLines:
    """Steady sines of a record.

    Attributes:
        frequency: [Hz], ascending, shape (n,).
        amplitude: of the strongest response [its unit], shape (n,).
    """

    frequency: FloatArray
    amplitude: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "amplitude")

    @property
    def words(self) -> str:
        """Return what was taken out as a sentence, empty for nothing."""
        if not self.frequency.size:
            return ""
        named = ", ".join(f"{f:.5g}" for f in self.frequency)
        return (
            f"steady sines at {named} Hz were taken out before the fit: harmonic "
            "excitation such as that of a rotating spindle, no modes"
        )


def without_spindle_lines(
    recording: Recording, band: tuple[float, float]
) -> tuple[Recording, SpindleLines]:
    """Take the steady sines in a band out of the responses of a recording.

    Args:
        recording: stationary excitation; its forces are left as they are.
        band: lowest and highest frequency of the search [Hz].

    Returns:
        The recording without the sines and with a step that lists them; the same
        recording where there are none.

    Source:
        Jacobsen, Andersen and Brincker, IMAC XXV (2007): harmonics in operational modal
        analysis; Rife and Boorstyn, IEEE Trans. Inf. Theory 20 (1974) 591 (maximum
        likelihood of a sine).
    """
    rows = list(response_rows(recording))
    responses = np.asarray(recording.samples[rows])
    found: list[tuple[float, float]] = []
    for _ in range(_ROUNDS):
        lines = _standing_out(responses, recording.sample_rate, band)
        taken = [_taken_out(responses, line) for line in lines[:_MOST_LINES]]
        sines = [one for one in taken if one is not None]
        if not sines:
            break
        found += [(turn * recording.sample_rate, size) for turn, size in sines]
    frequency, amplitude = np.array(sorted(found)).reshape(-1, 2).T
    lines_found = SpindleLines(frequency, amplitude)
    if not found:
        return recording, lines_found
    samples = np.array(recording.samples[:])
    samples[rows] = responses
    done = step(
        "take_out_sines",
        frequencies=", ".join(f"{f:.6g}" for f in frequency),
        lines=len(found),
    )
    provenance = (*recording.provenance, done)
    return replace(recording, samples=samples, provenance=provenance), lines_found


def _standing_out(
    responses: FloatArray, sample_rate: float, band: tuple[float, float]
) -> FloatArray:
    """Return lines that noise does not explain [turns per sample], strongest first."""
    count = responses.shape[1]
    power = _whitened(responses)
    frequency = scipy.fft.rfftfreq(count, 1.0 / sample_rate)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    # An exponential power over the scattering median around is F-distributed;
    # responses share a force: their mean may scatter as much as one of them.
    lines = max(1, int(np.count_nonzero(inside)))
    rare = float((lines / _CHANCE) ** (1.0 / _FREEDOM))
    limit = _FREEDOM * (rare - 1.0) / float(np.log(2.0))
    # The side lobes of a strong line stand out as well: the highest goes first.
    peak = power >= maximum_filter1d(power, _AROUND)
    chosen = np.flatnonzero(inside & peak & (power > limit))
    ordered = chosen[np.argsort(power[chosen])[::-1]]
    return np.asarray(ordered / count)


def _whitened(responses: FloatArray) -> FloatArray:
    """Return power over the median of the lines around, mean over responses."""
    count = responses.shape[1]
    total = np.zeros(count // 2 + 1)
    window = _hann(count)
    for row in responses:
        power = np.abs(scipy.fft.rfft((row - row.mean()) * window)) ** 2
        level = median_filter(power, _AROUND, mode="nearest")
        total += power / np.where(level > 0.0, level, np.inf)
    return np.asarray(total / responses.shape[0])


def _taken_out(responses: FloatArray, line: float) -> tuple[float, float] | None:
    """Subtract a sine from all responses in place.

    Args:
        responses: shape (n_outputs, n_samples); changed.
        line: where it was found [turns per sample].

    Returns:
        Its refined frequency [turns per sample] and largest amplitude; None where what
        is left shows that it is no steady sine, and nothing was changed.
    """
    count = responses.shape[1]
    time = np.arange(count) - 0.5 * (count - 1)
    window = _hann(count)
    window /= window.sum()

    def amplitudes(turn: float) -> FloatArray:
        return np.asarray(responses @ (window * np.exp(-2j * np.pi * turn * time)))

    turn = line
    width = 0.5 / count
    for _ in range(_NEWTON):
        left, here, right = (
            float(np.sum(np.abs(amplitudes(turn + shift)) ** 2))
            for shift in (-width, 0.0, width)
        )
        bend = left - 2.0 * here + right
        if bend >= 0.0:
            return None
        moved = float(np.clip(0.5 * width * (left - right) / bend, -width, width))
        turn += moved
        width = max(0.25 * width, 1e-3 / count)
        if abs(moved) < 1e-4 / count:
            break
    size = amplitudes(turn)
    wave = np.exp(2j * np.pi * turn * time)
    sines = 2.0 * (np.outer(size, wave)).real
    before = np.sum(np.abs(size) ** 2)
    responses -= sines
    after = np.sum(np.abs(amplitudes(turn)) ** 2)
    if after > _LEFT * before:
        responses += sines
        return None
    return turn, float(2.0 * np.abs(size).max())


def _hann(count: int) -> FloatArray:
    """Return the periodic Hann window, as `scipy.signal`, which is slow to import."""
    turn = np.linspace(-np.pi, np.pi, count + 1)[:-1]
    return np.asarray(0.5 + 0.5 * np.cos(turn))
