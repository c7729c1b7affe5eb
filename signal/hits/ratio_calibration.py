# SPDX-License-Identifier: MIT
"""Ratio calibration of hammer and accelerometers on a known mass.

A force F accelerates a rigid mass m by a = F / m, at every frequency between its
suspension modes and its first bending mode. The indicated value differs by the ratio of
the two sensitivities, on which alone an accelerance depends.

Source:
    ISO 7626-5:2019, 7.4 (operational calibration on a freely suspended mass); Ewins,
    Modal Testing (2000), sec. 3.5 (ratio calibration); JCGM 100:2008 (GUM), 5.1 and
    G.4 (combined uncertainty, effective degrees of freedom).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import NoHitFound
from jointbench.acquisition.basics.tail_probabilities import t_quantile
from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
    response_rows,
)

FLATNESS_LIMIT = 0.02
"""Largest change of the ratio over the band for a rigid, centrally struck mass [-]."""
_PULSES = 10.0  # record used, in pulse lengths: too short for suspension modes
_SPECTRUM_DROP = 10.0  # fall of the force at the end of the band [dB]
_COVERAGE = 0.95


@dataclass(frozen=True, slots=True)
class RatioCalibration:
    """Indicated over true accelerance of one accelerometer on a known mass.

    Attributes:
        channel: of the accelerometer.
        ratio: indicated over true accelerance [-].
        standard_uncertainty: combined, of the ratio [-].
        expanded: half-width of its 95 % interval [-].
        repeatability: part of the scatter from hit to hit [-].
        mass_part: part of the mass [-].
        flatness: change of the ratio from the lower to the upper half of the band [-].
        band: lowest and highest line used [Hz].
        hits: number used.
    """

    channel: Channel
    ratio: float
    standard_uncertainty: float
    expanded: float
    repeatability: float
    mass_part: float
    flatness: float
    band: tuple[float, float]
    hits: int

    @property
    def passed(self) -> bool:
        """Whether the mass behaved as a rigid body."""
        return abs(self.flatness) <= FLATNESS_LIMIT


def calibrate_ratio(
    recordings: Sequence[Recording], *, mass: float, mass_sd: float
) -> tuple[RatioCalibration, ...]:
    """Compare every accelerometer with the hammer on a known mass.

    Args:
        recordings: with judged hits; those with the verdict `OK` are used. All share
            their channels and sample rate.
        mass: of everything that moves, sensors and mounts included [kg].
        mass_sd: its standard uncertainty [kg].

    Returns:
        One result per response channel.

    Raises:
        NoHitFound: there are fewer than three good hits.
        ChannelMissing: there is no force, or no response.

    Note:
        The ratio of a hit is the least-squares accelerance over the band, weighted by
        the force spectrum. Its scatter gives the repeatability (n - 1 degrees of
        freedom); half its change over the band is taken as the half-width of a
        rectangular distribution for the departure from a rigid body.
    """
    found = [
        (recording, hit)
        for recording in recordings
        for hit in recording.hits
        if hit.verdict is Verdict.OK
    ]
    if len(found) < 3:
        raise NoHitFound(
            f"{len(found)} good hits on the mass; the scatter needs three, strike again"
        )
    first = recordings[0]
    hits = [_ratios(recording, hit, mass) for recording, hit in found]
    bands = np.array([each.band for each in hits])
    band = (float(bands[:, 0].max()), float(bands[:, 1].min()))
    ratios = np.array([each.ratios for each in hits])
    return tuple(
        _result(first.channels[row], ratios[:, i], band, mass_sd / mass)
        for i, row in enumerate(response_rows(first))
    )


@dataclass(frozen=True, slots=True, eq=False)
class _HitRatios:
    """Ratios of one hit over the whole band, its lower and its upper half."""

    ratios: FloatArray
    band: tuple[float, float]


def _ratios(recording: Recording, hit: Hit, mass: float) -> _HitRatios:
    """Return the ratios of one hit, shape (n_responses, 3)."""
    rows = (recording.row(Quantity.FORCE), *response_rows(recording))
    samples = recording.samples[list(rows), hit.start : hit.stop]
    samples = samples - np.median(
        samples[:, : hit.trigger - hit.start], axis=1, keepdims=True
    )
    cut, padded = _around_the_pulse(samples, hit.trigger - hit.start)
    spectra: ComplexArray = np.fft.rfft(cut, padded, axis=1)
    frequency = np.fft.rfftfreq(padded, 1 / recording.sample_rate)
    power = np.abs(spectra[0]) ** 2
    low = 2 * recording.sample_rate / cut.shape[1]
    weak = np.flatnonzero(power < power.max() * 10 ** (-_SPECTRUM_DROP / 10))
    high = float(frequency[weak[0]]) if weak.size else float(frequency[-1])
    middle = 0.5 * (low + high)
    found = []
    for first, last in ((low, high), (low, middle), (middle, high)):
        inside = (frequency >= first) & (frequency <= last)
        across = (spectra[1:, inside] @ spectra[0, inside].conj()).real
        found.append(mass * across / power[inside].sum())
    return _HitRatios(np.array(found).T, (low, high))


def _around_the_pulse(samples: FloatArray, trigger: int) -> tuple[FloatArray, int]:
    """Return the pulse and some pulse lengths after it, tapered, and the FFT length."""
    force = samples[0]
    width = int(np.count_nonzero(force > 0.1 * force.max()))
    count = max(16, round(_PULSES * width))
    first = max(0, trigger - width)
    cut = samples[:, first : first + count]
    taper = np.ones(cut.shape[1])
    half = cut.shape[1] // 2
    taper[-half:] = 0.5 + 0.5 * np.cos(np.pi * np.arange(1, half + 1) / half)
    return cut * taper, 8 * 2 ** int(np.ceil(np.log2(cut.shape[1])))


def _result(
    channel: Channel, ratios: FloatArray, band: tuple[float, float], mass_part: float
) -> RatioCalibration:
    """Combine the parts of the uncertainty; `ratios` of shape (n_hits, 3)."""
    count = ratios.shape[0]
    ratio, low, high = ratios.mean(axis=0)
    repeat = float(ratios[:, 0].std(ddof=1) / np.sqrt(count) / ratio)
    flatness = float((high - low) / ratio)
    shape = abs(flatness) / (2 * np.sqrt(3))
    combined = float(np.sqrt(repeat**2 + mass_part**2 + shape**2))
    freedom = (count - 1) * (combined / repeat) ** 4 if repeat > 0 else np.inf
    factor = t_quantile(0.5 + 0.5 * _COVERAGE, freedom)
    return RatioCalibration(
        channel=channel,
        ratio=float(ratio),
        standard_uncertainty=combined * float(ratio),
        expanded=factor * combined * float(ratio),
        repeatability=repeat * float(ratio),
        mass_part=mass_part * float(ratio),
        flatness=flatness,
        band=band,
        hits=count,
    )
