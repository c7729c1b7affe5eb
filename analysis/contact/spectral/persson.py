# SPDX-License-Identifier: MIT
"""Persson's theory: real area, mean gap and stiffness of a rough contact."""

from dataclasses import dataclass

import numpy as np
from scipy.special import erf

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.contact.spectral.isotropic_spectrum import IsotropicSpectrum

ENERGY_FACTOR = 0.4
"""gamma: elastic energy at a small real area over that of full contact with the same
area [-]. Boundary elements of 11 surfaces (docs/contact-measured-surfaces.md) have a
least scatter at 0.4, 5 %; Yang and Persson give 0.45, with which the stiffness at
small load is 11 % lower, Wang and Mueser 5/9."""
_GAP_POINTS = 96
"""Pressures of the integral of the mean gap [-]."""
_CLOSED = 6.0
"""Pressure over E* times rms gradient at which a gap is closed [-]: erfc(8) = 1e-29."""
_TERMS = np.arange(1, 31)
"""Terms of the distribution of stress up to the hardness [-]."""
_FEW_YIELD = 0.01
"""Variance of the stress over hardness squared below which nothing yields [-]:
exp(-1 / 0.04) = 1e-11, which the terms resolve."""
_SMOOTHED = 6
"""Power of the yielded share by which waves are flattened [-]."""
_LEAST_LEFT = 0.1
"""Least share of the variance of a wave that yielding leaves [-]: what touches yields,
the valleys around it stay. No boundary elements have judged it."""


@dataclass(frozen=True, slots=True, eq=False)
class PerssonState:
    """A rough contact at several pressures, for every draw of its surface.

    Attributes:
        stiffness: by the mean gap, per area [N/m^3], shape (n_draws, n_pressures).
        gap: between the mean planes of the deformed surfaces, of the best estimate
            [m], shape (n_pressures,).
        real_area: elastic and yielded, over the apparent one [-], same shape.
        yielded: share of the load that yielded contacts carry [-], same shape.
        stiffening: stiffness over that without yielding [-], same shape.
    """

    stiffness: FloatArray
    gap: FloatArray
    real_area: FloatArray
    yielded: FloatArray
    stiffening: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "gap", "real_area", "yielded", "stiffening")


def persson_state(
    surface: IsotropicSpectrum,
    pressure: FloatArray,
    modulus: FloatArray,
    hardness: FloatArray,
) -> PerssonState:
    """Return stiffness, gap and area of a contact of many hills.

    Args:
        surface: combined spectrum of both surfaces.
        pressure: nominal, ascending [Pa], shape (n_pressures,).
        modulus: E* of each draw [Pa], shape (n_draws,).
        hardness: of each draw [Pa], same shape.

    Source:
        Area: Persson, J. Chem. Phys. 115 (2001) 3840, with its boundary condition at
        the hardness. Gap and stiffness: Persson, Phys. Rev. Lett. 99 (2007) 125502;
        Yang and Persson, J. Phys.: Condens. Matter 20 (2008) 215214, eq. (21), whose
        u_0 is the limit of p / k at small p. Waves that have yielded are flattened as
        by Tiwari, Almqvist and Persson, Tribol. Lett. 68 (2020) 129.
    """
    slope = surface.variance * surface.wavenumber**2 / 2
    elastic, share = _yielding(np.cumsum(slope, axis=1), pressure, modulus, hardness)
    plain = pressure / _reach(surface.wavenumber, slope, pressure[None, :], modulus)
    stiffness, gap = np.empty_like(elastic), np.empty_like(pressure)
    left = np.maximum(1 - share**_SMOOTHED, _LEAST_LEFT)
    for j, load in enumerate(pressure):
        kept = slope * left[:, :, j]
        length = _reach(surface.wavenumber, kept, np.full((1, 1), load), modulus)
        stiffness[:, j] = load / length[:, 0]
        gap[j] = _mean_gap(surface.wavenumber, kept[:1], load, modulus[:1])[0]
    # The load of contacts that yield is hardness times their area.
    last = share[:, -1, :]
    area = elastic + last * pressure / hardness[:, None]
    return PerssonState(stiffness, gap, area, last, stiffness / plain)


def exponential_length(surface: IsotropicSpectrum) -> FloatArray:
    """Return u_0 of p ~ exp(-gap / u_0), elastic, at small pressure [m].

    Shape (n_draws,). Stiffness per area is p / u_0 there.

    Source:
        Persson, Phys. Rev. Lett. 99 (2007) 125502.
    """
    slope = surface.variance * surface.wavenumber**2 / 2
    part = _part_lengths(surface.wavenumber, slope)
    length: FloatArray = ENERGY_FACTOR * np.sqrt(np.pi) * part.sum(axis=1)
    return length


def _part_lengths(wavenumber: FloatArray, slope: FloatArray) -> FloatArray:
    """Return the integral of q^2 C w over each bin [m], shape (n_draws, n_bins).

    With X the integral of pi q^3 C, w is X^(-1/2), and dX = pi q^3 C dq.
    """
    total = np.cumsum(slope, axis=1)
    root = np.sqrt(np.concatenate([np.zeros((total.shape[0], 1)), total], axis=1))
    parts: FloatArray = 2 * np.diff(root, axis=1) / (np.pi * wavenumber)
    return parts


def _reach(
    wavenumber: FloatArray,
    slope: FloatArray,
    pressure: FloatArray,
    modulus: FloatArray,
) -> FloatArray:
    """Return p / k at pressures of each draw [m], shape (n_draws, n_pressures).

    Args:
        wavenumber: [rad/m], shape (n_bins,).
        slope: half the mean square gradient of each bin, shape (n_draws, n_bins).
        pressure: [Pa], shape (n_draws or 1, n_pressures).
        modulus: [Pa], shape (n_draws,).
    """
    parts = _part_lengths(wavenumber, slope)
    middle = np.cumsum(slope, axis=1) - 0.5 * slope
    weight = 1 / np.sqrt(np.maximum(middle, np.finfo(float).tiny))
    # Magnified pressure: it grows with the waves that have been smoothed over.
    scaled = weight[:, :, None] * (pressure / modulus[:, None])[:, None, :]
    factor = ENERGY_FACTOR + 3 * (1 - ENERGY_FACTOR) * erf(scaled) ** 2
    kernel = parts[:, :, None] * factor * np.exp(-(np.minimum(scaled, 26.0) ** 2))
    length: FloatArray = np.sqrt(np.pi) * kernel.sum(axis=1)
    return length


def _mean_gap(
    wavenumber: FloatArray, slope: FloatArray, load: float, modulus: FloatArray
) -> FloatArray:
    """Return the integral of dp / k from a pressure on [m], shape (n_draws,)."""
    closed = _CLOSED * modulus * np.sqrt(2 * slope.sum(axis=1))
    closed = np.maximum(closed, 1.01 * load)
    step = np.linspace(0, 1, _GAP_POINTS)
    pressure = load * (closed[:, None] / load) ** step
    length = _reach(wavenumber, slope, pressure, modulus)
    gap: FloatArray = np.trapezoid(length, np.log(pressure), axis=1)
    return gap


def _yielding(
    total: FloatArray, pressure: FloatArray, modulus: FloatArray, hardness: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the elastic area at all waves, and the yielded share of load at each.

    The stress diffuses from the mean pressure as shorter waves are added, and ends at 0
    and at the hardness. The mean stress stays, so the elastic remainder gives the
    yielded load.

    Args:
        total: half the mean square gradient up to each bin, shape (n_draws, n_bins).
        pressure: [Pa], shape (n_pressures,).
        modulus: [Pa], shape (n_draws,).
        hardness: [Pa], same shape.

    Returns:
        Area over the apparent one, shape (n_draws, n_pressures); share, shape
        (n_draws, n_bins, n_pressures).
    """
    spread = 0.25 * (modulus / hardness)[:, None] ** 2 * total
    start = np.minimum(pressure / hardness[:, None], 1.0)
    angle = np.pi * _TERMS[:, None, None] * start
    # A term of the load over the load itself; sin(x) / x near 0.
    sign = -((-1.0) ** _TERMS)
    of_load = 2 * sign[:, None, None] * np.sinc(angle / np.pi)
    of_area = (1 + sign)[:, None, None] * 2 / np.pi * np.sin(angle)
    of_area /= _TERMS[:, None, None]
    decay = np.exp(-((np.pi * _TERMS[:, None, None]) ** 2) * spread)
    left = np.einsum("ndb,ndp->dbp", decay, of_load)
    share = np.where(spread[:, :, None] < _FEW_YIELD, 0.0, np.clip(1 - left, 0, 1))
    bounded = np.einsum("nd,ndp->dp", decay[:, :, -1], of_area)
    free = erf(pressure / (modulus * np.sqrt(total[:, -1]))[:, None])
    few = spread[:, -1:] < _FEW_YIELD
    return np.where(few, free, np.clip(bounded, 0, 1)), share
