# SPDX-License-Identifier: MIT
"""The spectrum that contact laws take of a measured surface, with or without a lay."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.records.surfaces import Areal, Surface
from jointbench.analysis.contact.spectral.isotropic_spectrum import (
    IsotropicSpectrum,
    averaged,
    isotropic_spectrum,
)
from jointbench.signal.band_limited.band_limited_fit import fit_lines
from jointbench.signal.band_limited.band_records import BandLimitedFit

LAY = 1.25
"""Ratio of the slopes along columns and rows from which a map has a lay [-]: maps that
are alike in all directions stay within a few per cent."""


def surface_spectrum(
    surface: Surface, fit: BandLimitedFit
) -> tuple[IsotropicSpectrum, float]:
    """Return the spectrum of a surface, and by what factor its slopes differ.

    The lines of a map are its rows. Where columns are steeper or flatter, the mean of
    both spectra has the gradient and the height of the map: the mean square gradient
    is the sum of the mean square slopes along any two directions at right angles.

    Args:
        surface: a profile or a map.
        fit: of its lines.

    Returns:
        The spectrum, and the ratio of the larger slope over the smaller one [-]; 1
        where only one direction was measured.

    Raises:
        BadData: no wavelength shows the surface.
    """
    rows = isotropic_spectrum(fit)
    if not isinstance(surface, Areal):
        return rows, 1.0
    try:
        columns = isotropic_spectrum(fit_lines([_turned(surface)]))
    except (UsageError, BadData):  # too few rows for lines
        return rows, 1.0
    short = max(rows.shortest, columns.shortest) * (1 - 1e-9)
    squares = [one.without_below(short).moment(2)[0] for one in (rows, columns)]
    ratio = float(np.sqrt(max(squares) / min(squares)))
    return (rows if ratio < LAY else averaged(rows, columns)), ratio


def _turned(surface: Areal) -> Areal:
    """Return a map whose rows are the columns of another."""
    down, along = surface.spacing
    return replace(
        surface,
        heights=surface.heights.T,
        valid=surface.valid.T,
        spacing=(along, down),
    )
