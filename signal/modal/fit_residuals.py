# SPDX-License-Identifier: MIT
"""Local residual of a fit around each mode, and its effect on the interval.

The covariance of a least-squares fit holds if residuals match the variances and are
independent from line to line. Their local ratio corrects for the first, their
correlation for the second. Two practices make intervals too wide and are avoided:
counting only ratios above 1, where the variances themselves are estimates that err both
ways, and treating every chance correlation of a few lines as real.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.frf_lines import FrfLines, measured_width

# Around a mode: this many half-power half-widths, and this many lines, each side.
_REACH_WIDTHS = 4.0
_REACH_LINES = 10.0
# A correlation counts above this many of its own standard deviations.
_SIGNIFICANT = 2.0
_HIGHEST_SHARE = 0.99


def residual_around(
    lines: FrfLines, pole: ComplexArray, residual: ComplexArray, variance: FloatArray
) -> FloatArray:
    """Compare the residual around each pole with the given variances.

    Args:
        lines: lines of the fit.
        pole: [rad/s], shape (n_modes,).
        residual: of the fit, shape (n_frf, n_lines).
        variance: E|error|^2 of each line, same shape.

    Returns:
        Factor on the covariance of each pole [-], shape (n_modes,).
    """
    standard = residual / np.sqrt(variance)
    omega = lines.laplace.imag
    pitch = float(np.median(np.diff(omega)))
    factors = []
    for p, width in zip(pole, measured_width(lines, pole), strict=True):
        reach = max(_REACH_WIDTHS * width, _REACH_LINES * pitch)
        around = standard[:, np.abs(omega - p.imag) < reach]
        inside = int(np.count_nonzero(np.abs(pole.imag - p.imag) < reach))
        factors.append(_power(around, inside) * _correlation_length(around))
    return np.array(factors)


def _power(standard: ComplexArray, modes: int) -> float:
    """Return mean |x|^2, corrected for the fitted parameters.

    One residue per FRF, one pole for all.
    """
    n_frf, n_lines = standard.shape
    left = n_frf * (n_lines - modes) - modes
    if left <= 0:
        return 1.0
    return float(np.sum(np.abs(standard) ** 2) / left)


def _correlation_length(standard: ComplexArray) -> float:
    """Return how many neighbouring lines carry one independent error, 1 or more."""
    power = float(np.sum(np.abs(standard) ** 2))
    if standard.shape[1] < 3 or power == 0.0:
        return 1.0
    shared = np.sum(standard[:, 1:] * standard[:, :-1].conj()).real / power
    share = min(float(shared), _HIGHEST_SHARE)
    # The real part of a correlation of n complex numbers has variance 1 / 2 n.
    if share < _SIGNIFICANT / np.sqrt(2.0 * standard.size):
        return 1.0
    return (1.0 + share) / (1.0 - share)
