# SPDX-License-Identifier: MIT
"""What a fit takes from an FRF, and the FRF that it gives back."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.records.provenance import step
from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.frf_lines import FrfLines
from jointbench.signal.modal.mode_selection import FittedModes
from jointbench.signal.modal.shared_errors import ForceNoise


def scatter_of(frf: Frf, keep: BoolArray) -> FloatArray | None:
    """Return the variance of the kept lines, one row per pair, or None."""
    if frf.variance is None:
        return None
    kept = frf.variance[:, :, keep]
    return kept.reshape(-1, kept.shape[2])


def force_noise_of(frf: Frf, keep: BoolArray) -> ForceNoise:
    """Return what the noise of the force changes in the FRFs of each input."""
    if frf.force_noise is None or frf.force_width <= 0.0:
        return ForceNoise(np.zeros((len(frf.inputs), np.count_nonzero(keep))), 0.0)
    power = np.abs(frf.response[:, :, keep]) ** 2
    share = frf.force_noise[:, :, keep] / np.where(power > 0.0, power, np.inf)
    return ForceNoise(np.max(share, axis=0), frf.force_width)


def synthesis_of(frf: Frf, keep: BoolArray, fitted: FittedModes) -> Frf:
    """Return the FRF of the model on the kept lines."""
    shape = (len(frf.outputs), len(frf.inputs), -1)
    return replace(
        frf,
        frequency=frf.frequency[keep],
        response=fitted.fit.synthesis.reshape(shape),
        coherence=None,
        innovation_noise=None,
        force_noise=None,
        variance=fitted.variance.reshape(shape),
        provenance=(*frf.provenance, step("synthesis")),
    )


def missed_share(lines: FrfLines, fitted: FittedModes) -> FloatArray:
    """Return the rms of the residual over the rms of the FRF, line by line."""
    missed = np.sum(np.abs(lines.response - fitted.fit.synthesis) ** 2, axis=0)
    measured = np.sum(np.abs(lines.response) ** 2, axis=0)
    return np.asarray(np.sqrt(missed / np.where(measured > 0.0, measured, 1.0)))
