# SPDX-License-Identifier: MIT
"""Spectrum along lines of a surface from its spectrum over two wavenumbers."""

import numpy as np
from scipy.special import gamma

from jointbench.signal.band_limited.lay_spectrum import LaySpectrum
from jointbench.signal.band_limited.matern_spectrum import BandLimited


def line_of(model: LaySpectrum) -> BandLimited:
    """Return the spectrum of lines of a surface without its lay.

    The integral of (1 + (u^2 + v^2) / q_r^2)^(-1-H) over v; a lay is left out, its
    level is that of the mean of both directions.
    """
    corner = (2 * np.pi / model.roll_off) ** 2 + model.pivot**2
    share = np.sqrt(np.pi) * gamma(model.hurst + 0.5) / gamma(model.hurst + 1)
    return BandLimited(
        level=float(model.level * np.sqrt(corner) * share),
        pivot=model.pivot,
        hurst=model.hurst,
        roll_off=model.roll_off,
        blur=model.blur,
        noise=model.noise,
    )
