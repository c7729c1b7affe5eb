# SPDX-License-Identifier: MIT
"""Raw hits: quiet start, contact, bad hits, common filter and decimation."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.intake.intake_settings import HITS
from jointbench.analysis.gap.intake.mains_hum import MainsHum
from jointbench.analysis.gap.structure_response.common_filter import CommonFilter


@dataclass(frozen=True, slots=True, eq=False)
class QuietHit:
    """A hit without offset and mains hum.

    Attributes:
        values: force [N] and responses, shape (1 + n_channels, n_samples).
        noise: sd of each channel before the hit, shape (1 + n_channels,).
    """

    values: FloatArray
    noise: FloatArray


def quieted(values: FloatArray, hum: MainsHum) -> QuietHit:
    """Subtract offset and mains hum, both fitted before the hit.

    Args:
        values: shape (n_rows, n_samples).
        hum: what the quiet starts of all hits show of it.
    """
    left = hum.subtracted(values)
    dof = max(hum.quiet - len(hum.root), 1)
    return QuietHit(left, np.sqrt(np.sum(left[:, : hum.quiet] ** 2, axis=1) / dof))


def contact_samples(force: FloatArray, noise: float) -> BoolArray:
    """Return the samples that belong to a contact, shape (n_samples,).

    Args:
        force: of one hit [N], shape (n_samples,).
        noise: its sd [N].
    """
    limit = max(HITS.contact_noise_sd * noise, HITS.contact_share * float(force.max()))
    strong = force > limit
    strong[1:-1] &= strong[:-2] | strong[2:]
    kernel = np.ones(2 * HITS.contact_padding + 1)
    return np.asarray(np.convolve(strong, kernel, mode="same") > 0.5)


def bad_hit(hit: QuietHit, volts: FloatArray, full_scale: float, aimed: float) -> str:
    """Return why a hit cannot be used, or an empty text.

    Args:
        hit: without offset.
        volts: as converted [V], shape (1 + n_channels, n_samples).
        full_scale: of the converter [V].
        aimed: peak force of the plan [N].
    """
    full = np.abs(volts) >= HITS.full_share * full_scale
    if int(full.sum(axis=1).max()) >= HITS.full_samples:
        return f"overload: a channel reaches the full scale of {full_scale:g} V"
    force, noise = hit.values[0], float(hit.noise[0])
    peak = float(force.max())
    if peak < HITS.glancing_share * aimed or peak < HITS.peak_noise_sd * noise:
        return f"glancing: peak of {peak:.3g} N, aimed at {aimed:g} N"
    if peak > HITS.hard_share * aimed:
        return f"overload: peak of {peak:.3g} N, aimed at {aimed:g} N"
    contacts = _contacts(force, max(HITS.second_share * peak, 8 * noise))
    if contacts > 1:
        return f"double: {contacts} contacts of the hammer"
    return ""


def _contacts(force: FloatArray, limit: float) -> int:
    """Count the contacts of the hammer: peaks with an opening between them."""
    from scipy.signal import find_peaks  # slow to import

    peaks, _ = find_peaks(
        force, height=limit, prominence=limit, distance=HITS.contact_padding
    )
    return max(len(peaks), 1)


def band_of(force: FloatArray, sample_rate: float) -> float:
    """Return the frequency up to which hits excite the structure [Hz].

    Args:
        force: gated [N], shape (n_records, n_samples).
        sample_rate: [Hz].
    """
    spectrum = np.abs(np.fft.rfft(force, axis=1))
    level = np.median(spectrum / spectrum[:, :1], axis=0)
    beyond = np.flatnonzero(level < HITS.band_share)
    last = beyond[0] if beyond.size else level.size - 1
    return float(last * sample_rate / force.shape[1])


def make_filter(band: float, sample_rate: float) -> CommonFilter:
    """Design the filter for a band.

    Args:
        band: highest frequency that is compared [Hz].
        sample_rate: of the raw records [Hz].
    """
    stop, half_rate = HITS.stop_over_band * band, 0.5 * sample_rate
    if stop >= half_rate:
        return CommonFilter(np.ones(1), 1)
    step, width = int(half_rate / stop), (stop - band) / half_rate
    from scipy.signal import firwin, kaiserord  # slow to import

    taps, beta = kaiserord(HITS.stop_band, width)
    cut = 0.5 * (band + stop)
    kernel = firwin(taps | 1, cut, window=("kaiser", beta), fs=sample_rate)
    return CommonFilter(np.asarray(kernel), step, stop)
