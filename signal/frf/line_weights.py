# SPDX-License-Identifier: MIT
"""How much each line of an FRF counts when poles are looked for.

Best is the scatter between hits; next coherence; with a single hit there is neither,
but the Kalman stage has seen how noisy each channel is, and the force spectrum tells
where little force leaves much of that noise.
"""

import numpy as np
from scipy.ndimage import median_filter

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.signal.frf.frf import Frf

# No line counts more than the median one by more than this.
_MOST_WEIGHT = 30.0
# Noise is taken as it is over this share of the band.
_PIECES = 20
_LEAST_COHERENCE = 1e-6


def weights_of(frf: Frf, keep: BoolArray) -> tuple[FloatArray | None, str]:
    """Return the weights of the kept lines, and what they come from.

    Args:
        frf: any.
        keep: True for the lines to fit, shape (n_lines,).

    Returns:
        Weights [-], shape (n_kept,), or None where nothing tells lines apart; a word
        for the record.
    """
    response = frf.response[:, :, keep]
    if frf.variance is not None:
        return line_weights(response, frf.variance[:, :, keep]), "scatter between hits"
    if frf.coherence is not None:
        share = np.clip(frf.coherence[:, :, keep], _LEAST_COHERENCE, 1.0)
        noise = (1.0 - share) / share * np.abs(response) ** 2
        return line_weights(response, noise), "coherence"
    if frf.innovation_noise is not None:
        noise = frf.innovation_noise[:, :, keep]
        return line_weights(response, noise), "innovations of the Kalman stage"
    return None, "none"


def line_weights(response: ComplexArray, variance: FloatArray) -> FloatArray:
    """Return how much each line counts in `fit_poles`, from the noise of the FRFs.

    All outputs must share one weight a line, or orders no longer nest: it is the
    reciprocal of their mean noise, each over its own power. Bounded, and smoothed by a
    median over a twentieth of the band: on a few lines hits agree by chance, and where
    a mode resonates they differ by their leakage, which is no reason to look away.

    Args:
        response: FRF, shape (n_outputs, n_inputs, n_lines).
        variance: E|error|^2, same shape.

    Returns:
        Weights [-], median 1, shape (n_lines,).
    """
    power = np.mean(np.abs(response) ** 2, axis=2, keepdims=True)
    noise = np.mean(variance / np.where(power > 0.0, power, 1.0), axis=(0, 1))
    around = max(3, noise.size // _PIECES)
    noise = median_filter(noise, around, mode="nearest")
    middle = float(np.median(noise))
    if middle <= 0.0:
        return np.ones_like(noise)
    least = middle / _MOST_WEIGHT
    return np.asarray(middle / np.maximum(noise, least))
