# SPDX-License-Identifier: MIT
"""Noise of an FRF from the noise of its channels.

White noise of variance s^2 at every sample has E|N|^2 = s^2 dt integral(w^2) in a
windowed block; over |F|^2 of all hits that is the variance of H1. The gain of the
zero-phase stage cancels between force and response, and in this ratio too.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.provenance import Provenance
from jointbench.signal.frf.estimators import floored_power
from jointbench.signal.frf.spectral_sums import SpectralSums
from jointbench.signal.hits.windows import HammerWindow, kept_samples
from jointbench.signal.kalman.stage_provenance import stage_noise_of


def innovation_noise(
    sums: SpectralSums,
    provenance: Provenance,
    decay_rate: float,
) -> FloatArray | None:
    """Return the variance of each pair due to white noise of its channel.

    Args:
        sums: over the accepted hits.
        provenance: of the recordings, with the Kalman stage.
        decay_rate: of the exponential window [1/s], 0 for none.

    Returns:
        E|error|^2, shape (n_pairs, n_lines), or None if a channel was not filtered.

    Source:
        Bendat and Piersol, Random Data (2010), sec. 9.2 (variance of H1).
    """
    noise = stage_noise_of(provenance)
    names = [output.rpartition("@")[0] for output in sums.outputs]
    if any(name not in noise for name in names):
        return None
    step = 1.0 / (sums.block * float(sums.frequency[1]))
    length = sums.block * step
    if decay_rate > 0.0:
        length = -np.expm1(-2.0 * decay_rate * length) / (2.0 * decay_rate)
    rows = []
    for number, pair in enumerate(sums.pairs):
        sd = noise[names[number // len(sums.inputs)]]
        power = floored_power(pair.force_power)
        rows.append(sd**2 * step * length / np.where(power > 0.0, power, np.inf))
    return np.array(rows)


def force_noise(sums: SpectralSums, window: HammerWindow) -> FloatArray | None:
    """Return the variance of each pair due to the noise of the windowed force.

    Args:
        sums: over the accepted hits.
        window: applied to each of them.

    Returns:
        E|error|^2, shape (n_pairs, n_lines), or None if the noise is not known.

    Source:
        Bendat and Piersol, Random Data (2010), sec. 9.2 (H1 with input noise).
    """
    if window.force_width is None or not np.all(sums.force_variance > 0.0):
        return None
    step = 1.0 / (sums.block * float(sums.frequency[1]))
    kept = kept_samples(window, 1.0 / step)
    rows = []
    for variance, pair in zip(sums.force_variance, sums.pairs, strict=True):
        power = floored_power(pair.force_power)
        share = variance * step**2 * kept / np.where(power > 0.0, power, np.inf)
        rows.append(share * np.abs(pair.h1) ** 2)
    return np.array(rows)
