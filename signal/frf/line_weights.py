# SPDX-License-Identifier: MIT
"""Weights of the lines of an FRF in the pole fit.

The scatter between hits is the best source, coherence the next. A single hit has
neither; its weights come from the channel noise that the Kalman stage estimated, and
from the force spectrum.
"""

import numpy as np
from scipy.ndimage import median_filter

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.signal.frf.frf import Frf

# Largest weight relative to the median weight.
_MOST_WEIGHT = 30.0
# The noise is smoothed over this share of the band.
_PIECES = 20
_LEAST_COHERENCE = 1e-6


def weights_of(frf: Frf, keep: BoolArray) -> tuple[FloatArray | None, str]:
    """Return the weights of the kept lines, and their source.

    Args:
        frf: any.
        keep: True for the lines to fit, shape (n_lines,).

    Returns:
        Weights [-], shape (n_kept,), or None where all lines are equal; their source as
        text.
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
    """Return the weight of each line in `fit_poles`, from the noise of the FRFs.

    All outputs must share one weight per line, or orders no longer nest: it is the
    reciprocal of their mean noise, each over its own power. Weights are bounded and
    smoothed by a median over a twentieth of the band: on a few lines hits agree by
    chance, and at a resonance they differ by leakage, which must not lower the weight.

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
