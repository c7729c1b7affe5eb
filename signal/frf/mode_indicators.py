# SPDX-License-Identifier: MIT
"""Mode indicator functions before any fit: CMIF, MIF and MvMIF."""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.frf.frf import Frf


def cmif(frf: Frf) -> FloatArray:
    """Return the complex mode indicator function: singular values of the FRF matrix.

    Args:
        frf: any kind.

    Returns:
        Largest first [unit of the FRF], shape (n, n_lines) with n the smaller of
        outputs and inputs. Each peaks at modes; two peaks on one line are two modes.

    Source:
        Shih, Tsuei, Allemang and Brown, Mech. Systems and Signal Processing 2 (1988)
        367.
    """
    matrices = frf.response.transpose(2, 0, 1)
    return np.asarray(np.linalg.svd(matrices, compute_uv=False).T)


def mode_indicator(frf: Frf) -> FloatArray:
    """Return the normal mode indicator function of each input.

    At the undamped frequency of a real mode the receptance is in quadrature with the
    force, so that its real part, or the imaginary part of a mobility, vanishes.

    Args:
        frf: any kind; measured at s = j omega (no exponential window).

    Returns:
        1 away from modes, dipping towards 0 at a mode [-], shape (n_inputs, n_lines).

    Source:
        Williams, Crowley and Vold, IMAC 3 (1985) 66.
    """
    in_phase = np.abs(_in_phase(frf)) * np.abs(frf.response)
    whole = np.sum(np.abs(frf.response) ** 2, axis=0)
    return np.asarray(np.sum(in_phase, axis=0) / np.where(whole > 0.0, whole, 1.0))


def multivariate_mode_indicator(frf: Frf) -> FloatArray:
    """Return the multivariate mode indicator function, over combinations of the inputs.

    Args:
        frf: any kind.

    Returns:
        Smallest first [-], shape (n_inputs, n_lines); the first dips at every mode,
        the second where two modes share a frequency.

    Source:
        Williams, Crowley and Vold, IMAC 3 (1985) 66.
    """
    part = _in_phase(frf).transpose(2, 0, 1)
    rest = _quadrature(frf).transpose(2, 0, 1)
    inner = np.swapaxes(part, 1, 2) @ part
    whole = inner + np.swapaxes(rest, 1, 2) @ rest
    ridge = 1e-14 * np.trace(whole, axis1=1, axis2=2) + np.finfo(float).tiny
    whole = whole + ridge[:, None, None] * np.eye(whole.shape[1])
    root = np.linalg.cholesky(whole)
    left = np.linalg.solve(root, inner)
    balanced = np.linalg.solve(root, np.swapaxes(left, 1, 2))
    return np.asarray(np.clip(np.linalg.eigvalsh(balanced).T, 0.0, 1.0))


def _receptance_like(frf: Frf) -> ComplexArray:
    """Return the FRF rotated to the phase of a receptance."""
    return np.asarray(frf.response * (-1j) ** frf.kind.derivatives)


def _in_phase(frf: Frf) -> FloatArray:
    return np.asarray(_receptance_like(frf).real)


def _quadrature(frf: Frf) -> FloatArray:
    return np.asarray(_receptance_like(frf).imag)
