# SPDX-License-Identifier: MIT
"""Gains of sensors and aims of hits that are known to a standard deviation only.

An error of gain multiplies all FRFs of a sensor, one of aim all of a hit point. Their
covariance is added to that of the noise, so that they are eliminated, not fitted.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.frf.frf import Frf

# Directions weaker than this have no gain to eliminate.
_WEAK = 1e-12


@dataclass(frozen=True, slots=True)
class FrfGains:
    """What is known of the scale of FRFs.

    Attributes:
        gain_sd: of ln of a sensor's gain [-]; 0 is exact.
        force_sd: of ln of the force at a hit point, by aim and direction [-].
    """

    gain_sd: float = 0.0
    force_sd: float = 0.0

    def __post_init__(self) -> None:
        """Check signs."""
        if min(self.gain_sd, self.force_sd) < 0:
            raise BadData(
                f"gain_sd {self.gain_sd:g} and force_sd {self.force_sd:g}: a standard "
                "deviation is not below zero; 0 is exact"
            )


EXACT = FrfGains()
"""Gains and aims without error."""


def without_gains(
    rows: FloatArray, slopes: FloatArray, frf: Frf, gains: FrfGains
) -> tuple[FloatArray, FloatArray]:
    """Whiten differences of FRFs for errors of gain as well.

    Args:
        rows: differences over the standard deviations of the noise, real parts, then
            imaginary ones, shape (2 n_outputs n_inputs n_lines,).
        slopes: their derivatives, shape (n_rows, n_parameters).
        frf: measured, with its variance.
        gains: their standard deviations.

    Returns:
        Rows and slopes times the inverse root of 1 + U U', U the change of the rows by
        each gain times its standard deviation.

    Source:
        Rao 1973, Linear Statistical Inference, sec. 4a.2 (generalised least squares).
    """
    change = _changes(frf, gains)
    if not change.size:
        return rows, slopes
    square, turn = np.linalg.eigh(change.T @ change)
    kept = square > _WEAK
    basis = change @ turn[:, kept] / np.sqrt(square[kept])
    less = 1.0 - 1.0 / np.sqrt(1.0 + square[kept])
    return (
        rows - basis @ (less * (basis.T @ rows)),
        slopes - basis @ (less[:, None] * (basis.T @ slopes)),
    )


def _changes(frf: Frf, gains: FrfGains) -> FloatArray:
    """Return the change of the rows by each gain, times its standard deviation."""
    whole = frf.response / np.sqrt(0.5 * np.asarray(frf.variance))
    columns = []
    for axis, sd in ((0, gains.gain_sd), (1, gains.force_sd)):
        for at in range(whole.shape[axis] if sd > 0 else 0):
            own = np.zeros_like(whole)
            place = (at,) if axis == 0 else (slice(None), at)
            own[place] = sd * whole[place]
            flat = own.ravel()
            columns.append(np.concatenate([flat.real, flat.imag]))
    return np.array(columns).T if columns else np.zeros((0, 0))
