# SPDX-License-Identifier: MIT
"""Noise of an FRF from the channel noise that the Kalman stage estimated.

White noise of variance s^2 at every sample has E|N|^2 = s^2 dt integral(w^2) in a
windowed block; over |F|^2 of all hits that is the variance of H1. The gain of the
zero-phase stage cancels between force and response, and in this ratio too.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.provenance import Provenance
from jointbench.signal.hits.hit_pairs import Pair
from jointbench.signal.hits.hit_spectra import HitSpectra
from jointbench.signal.kalman.stage_provenance import stage_noise_of


def innovation_noise(
    spectra: HitSpectra,
    outputs: Sequence[str],
    pairs: Sequence[Pair],
    provenance: Provenance,
    decay_rate: float,
) -> FloatArray | None:
    """Return the variance of each pair due to white noise of its channel.

    Args:
        spectra: of the accepted hits.
        outputs: labels ``"channel@point"``; pairs are sorted by them.
        pairs: hits of each pair.
        provenance: of the recordings, with the Kalman stage.
        decay_rate: of the exponential window [1/s], 0 for none.

    Returns:
        E|error|^2, shape (n_pairs, n_lines), or None if a channel was not filtered.

    Source:
        Bendat and Piersol, Random Data (2010), sec. 9.2 (variance of H1).
    """
    noise = stage_noise_of(provenance)
    names = [output.rpartition("@")[0] for output in outputs]
    if any(name not in noise for name in names):
        return None
    step = 1.0 / (spectra.block * float(spectra.frequency[1]))
    length = spectra.block * step
    if decay_rate > 0.0:
        length = -np.expm1(-2.0 * decay_rate * length) / (2.0 * decay_rate)
    rows = []
    for number, pair in enumerate(pairs):
        sd = noise[names[number * len(names) // len(pairs)]]
        power = np.sum(np.abs(spectra.force[pair.hits]) ** 2, axis=0)
        rows.append(sd**2 * step * length / np.where(power > 0.0, power, np.inf))
    return np.array(rows)
