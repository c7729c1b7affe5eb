# SPDX-License-Identifier: MIT
"""The noise of a band from what a fit leaves late in the decays."""

from dataclasses import replace

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.signal.amplitude.band_lines import BandLines

# Share of the decay in which nothing but noise should be left; the very end is not
# used, where the band's cut in frequency rings.
_LATE = (0.5, 0.9)
# Hits whose late residual is smallest: this quantile is the noise.
_QUIET = 0.3


def late_power(residual: ComplexArray) -> ComplexArray:
    """Return the noise covariance of virtual channels from the late residual.

    Args:
        residual: shape (n_hits, n_virtual, n_lines).

    Returns:
        Covariance of real (and of imaginary) parts, shape (n_virtual, n_virtual).
    """
    lines = residual.shape[2]
    time = np.fft.ifft(residual, axis=2)
    first, last = (round(share * lines) for share in _LATE)
    late = time[:, :, first : max(last, first + 2)]
    each = np.einsum("hvt,hwt->hvw", late, late.conj()) * lines / late.shape[2] / 2.0
    power = np.trace(each, axis1=1, axis2=2).real
    quiet = power <= np.quantile(power, _QUIET) * (1.0 + 1e-9)
    mean = each[quiet].mean(axis=0)
    # Few samples give a covariance that is close to singular: its diagonal helps.
    share = min(1.0, residual.shape[1] / (quiet.sum() * late.shape[2]))
    diagonal = np.diag(np.diag(mean))
    return np.asarray((1.0 - share) * mean + share * diagonal)


def rewhitened(lines: BandLines, residual: ComplexArray) -> BandLines:
    """Return the lines with noise as the late residual of a fit shows it."""
    covariance = late_power(residual)
    size = np.trace(covariance).real / covariance.shape[0]
    covariance += 1e-9 * size * np.eye(covariance.shape[0])
    root = np.linalg.cholesky(covariance)
    data = scipy.linalg.solve_triangular(
        root, lines.data.transpose(1, 0, 2).reshape(root.shape[0], -1), lower=True
    )
    shape = (root.shape[0], lines.data.shape[0], -1)
    return replace(
        lines,
        data=np.asarray(data.reshape(shape).transpose(1, 0, 2)),
        mixing=np.asarray(lines.mixing @ root),
        reduction=np.asarray(np.linalg.solve(root, lines.reduction)),
    )
