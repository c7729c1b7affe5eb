# SPDX-License-Identifier: MIT
"""Contact of summits that do not interact, by the moments of the spectrum."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial.legendre import leggauss

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.contact.spectral.isotropic_spectrum import IsotropicSpectrum

_HEIGHT = np.linspace(-6.0, 12.0, 721)
"""Separations of the tables, in standard deviations of the summits [-]."""
_SEPARATION = np.linspace(-2.0, 8.0, 81)
"""Separations at which elliptic summits are summed, in rms heights [-]."""
_LONGEST_CURVATURE = 6.5
"""Largest mean curvature of a summit, in standard deviations of it [-]."""
_NODES = 24
_SPREADS = np.linspace(0.1, 0.999, 33)
"""Standard deviations of the height of a summit of given curvature, in rms heights,
at which its sums are tabulated [-]; alpha of 1.515 to 750."""


@dataclass(frozen=True, slots=True, eq=False)
class LineMoments:
    """Moments of the density along a line of an isotropic surface, of each draw.

    Attributes:
        height: m_0 [m^2], shape (n_draws,).
        slope: m_2 [-].
        curvature: m_4 [1/m^2].
    """

    height: FloatArray
    slope: FloatArray
    curvature: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "height", "slope", "curvature")

    @property
    def breadth(self) -> FloatArray:
        """Nayak's alpha = m_0 m_4 / m_2^2, at least 1.5 [-]."""
        return self.height * self.curvature / self.slope**2

    @property
    def density(self) -> FloatArray:
        """Summits per area [1/m^2]."""
        density: FloatArray = self.curvature / self.slope / (6 * np.pi * np.sqrt(3))
        return density

    @property
    def radius(self) -> FloatArray:
        """Radius of the mean summit [m]."""
        radius: FloatArray = 3 / 8 * np.sqrt(np.pi / self.curvature)
        return radius

    @property
    def summit_height(self) -> FloatArray:
        """Standard deviation of the heights of summits [m]."""
        sd: FloatArray = np.sqrt((1 - 0.8968 / self.breadth) * self.height)
        return sd


def line_moments(surface: IsotropicSpectrum) -> LineMoments:
    """Return the moments of lines on a surface.

    Source:
        Nayak, J. Lubr. Technol. 93 (1971) 398: of the mean square gradient a line has
        1/2, of the mean square Laplacian 3/8.
    """
    return LineMoments(
        surface.moment(0), surface.moment(2) / 2, 3 / 8 * surface.moment(4)
    )


@dataclass(frozen=True, slots=True, eq=False)
class SummitState:
    """Summits in contact at several pressures, for every draw of the surface.

    Attributes:
        stiffness: per area [N/m^3], shape (n_draws, n_pressures).
        separation: of the mean planes of the undeformed surfaces [m], same shape.
        real_area: over the apparent one [-], same shape.
        contacts: per area [1/m^2], same shape.
    """

    stiffness: FloatArray
    separation: FloatArray
    real_area: FloatArray
    contacts: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "separation", "real_area", "contacts")


def greenwood_williamson(
    moments: LineMoments, pressure: FloatArray, modulus: FloatArray
) -> SummitState:
    """Return spheres of one radius with normal heights, from spectral moments.

    Args:
        moments: of the combined surface.
        pressure: nominal, ascending [Pa], shape (n_pressures,).
        modulus: E* of each draw [Pa], shape (n_draws,).

    Source:
        Greenwood and Williamson, Proc. R. Soc. A 295 (1966) 300. Moments: McCool, Wear
        107 (1986) 37, with the summits of Bush, Gibson and Keogh, Mech. Res. Commun. 3
        (1976) 169: radius 0.375 (pi / m_4)^(1/2), variance (1 - 0.8968 / alpha) m_0,
        mean 4 (m_0 / (pi alpha))^(1/2) above the mean plane.
    """
    sd, radius = moments.summit_height, moments.radius
    load, slope, area, count = _TABLES
    unit = 4 / 3 * modulus * moments.density * np.sqrt(radius) * sd**1.5
    place = _inverse(np.log(load), np.log(pressure / unit[:, None]))
    mean = 4 * np.sqrt(moments.height / (np.pi * moments.breadth))

    def at(table: FloatArray) -> FloatArray:
        return np.exp(np.interp(place, _HEIGHT, np.log(table)))

    hertz = 2 * modulus * moments.density * np.sqrt(radius * sd)
    return SummitState(
        stiffness=hertz[:, None] * at(slope),
        separation=mean[:, None] + sd[:, None] * place,
        real_area=(np.pi * moments.density * radius * sd)[:, None] * at(area),
        contacts=moments.density[:, None] * at(count),
    )


def bush_gibson_thomas(
    moments: LineMoments, pressure: FloatArray, modulus: FloatArray
) -> SummitState:
    """Return paraboloids with the heights and both curvatures of a random surface.

    Each summit is a sphere of the geometric mean of its curvatures, which differs from
    the elliptic contact by a few per cent.

    Args:
        moments: of the combined surface.
        pressure: nominal, ascending [Pa], shape (n_pressures,).
        modulus: E* of each draw [Pa], shape (n_draws,).

    Source:
        Bush, Gibson and Thomas, Wear 35 (1975) 87, as simplified by Greenwood, Wear 261
        (2006) 191. Joint distribution: Nayak 1971; derived in `_summits`.
    """
    root = np.sqrt(moments.height)
    bend = np.sqrt(moments.curvature)
    density = moments.curvature / moments.slope
    load, slope, area, count = _sums_of(moments.breadth)
    unit = 4 / 3 * modulus * density * root**1.5 / np.sqrt(bend)
    wanted = np.log(pressure / unit[:, None])
    place = np.array(
        [
            np.interp(-one, -np.log(table), _SEPARATION)
            for one, table in zip(wanted, load, strict=True)
        ]
    )

    def at(table: FloatArray) -> FloatArray:
        rows = zip(place, np.log(table), strict=True)
        return np.exp([np.interp(one, _SEPARATION, row) for one, row in rows])

    hertz = 2 * modulus * density * np.sqrt(root / bend)
    return SummitState(
        stiffness=hertz[:, None] * at(slope),
        separation=root[:, None] * place,
        real_area=(np.pi * density * root / bend)[:, None] * at(area),
        contacts=density[:, None] * at(count),
    )


def _sums_of(breadth: FloatArray) -> tuple[FloatArray, ...]:
    """Return the four sums of `_summits`, each of shape (n_draws, n_separations)."""
    tables = _summit_tables()
    place = np.sqrt(np.clip(1 - 1.5 / breadth, _SPREADS[0], _SPREADS[-1]))
    right = np.clip(np.searchsorted(_SPREADS, place), 1, _SPREADS.size - 1)
    part = (place - _SPREADS[right - 1]) / (_SPREADS[right] - _SPREADS[right - 1])
    mixed = (1 - part)[:, None, None] * tables[right - 1]
    mixed += part[:, None, None] * tables[right]
    load, slope, area, count = np.moveaxis(np.exp(mixed), 1, 0)
    return load, slope, area, count


@cache
def _summit_tables() -> FloatArray:
    """Return the logarithms of the sums at each spread, shape (n, 4, n_separations)."""
    sums = np.array([_summits(1.5 / (1 - spread**2)) for spread in _SPREADS])
    table: FloatArray = np.log(sums)
    return table


def _summits(breadth: float) -> FloatArray:
    """Return sums over the summits of a random surface, shape (4, n_separations).

    Over densities of summits with mean curvature s and geometric mean curvature g, in
    units of m_4^(1/2): integrals of the depth to 3/2 over g^(1/2), of its root over
    g^(1/2), of itself over g, and of 1.

    Note:
        s is normal with variance 2/3, and the square of the difference of the principal
        curvatures over 2, u = s^2 - g^2, is exponential with mean 2/3. A height given s
        is normal with mean 1.5 s alpha^(-1/2) and variance 1 - 1.5 / alpha in units of
        m_0. A summit of curvatures g has the weight g^2 / (2 pi) per m_2 / m_4.
    """
    node, weight = leggauss(_NODES)
    top = _LONGEST_CURVATURE * np.sqrt(2 / 3)
    s = 0.5 * top * (node + 1)
    of_s = 0.5 * top * weight * np.exp(-0.75 * s**2) / np.sqrt(4 / 3 * np.pi)
    # u runs from 0 to s^2, mostly within a few times 2/3.
    reach = np.minimum(s**2, 16.0)
    u = 0.5 * reach[:, None] * (node + 1)
    of_u = 0.75 * reach[:, None] * weight * np.exp(-1.5 * u)
    square = s[:, None] ** 2 - u
    share = (of_s[:, None] * of_u * square / (2 * np.pi)).ravel()
    bend = np.sqrt(square).ravel()
    sd = np.sqrt(max(1 - 1.5 / breadth, 1e-6))
    mean = np.repeat(1.5 * s / np.sqrt(breadth), _NODES)
    place = (_SEPARATION[:, None] - mean) / sd
    load, slope, area, count = (
        np.exp(np.interp(place, _HEIGHT, np.log(table))) for table in _TABLES
    )
    return np.array(
        [
            sd**1.5 * load @ (share / np.sqrt(bend)),
            sd**0.5 * slope @ (share / np.sqrt(bend)),
            sd * area @ (share / bend),
            count @ share,
        ]
    )


def _half_integrals() -> tuple[FloatArray, ...]:
    """Return the integrals of (x - h)^n over the normal density above h.

    n = 3/2, 1/2, 1 and 0 at the heights of the tables.
    """
    return tuple(_integral(n) for n in (1.5, 0.5, 1.0, 0.0))


def _integral(power: float) -> FloatArray:
    # With t = y^2 the half-integer power is smooth at the edge of the contact.
    node, weight = leggauss(200)
    reach = np.sqrt(np.maximum(8.0 - _HEIGHT, 24 / (_HEIGHT + 8.0)))
    y = 0.5 * reach[:, None] * (node + 1)
    t = y**2
    whole = _HEIGHT[:, None] + t
    kernel = 2 * y ** (2 * power + 1) * np.exp(-0.5 * whole**2) / np.sqrt(2 * np.pi)
    found: FloatArray = 0.5 * reach * (kernel @ weight)
    return found


def _inverse(falling: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return where a falling table has the values wanted, same shape as these."""
    found: FloatArray = np.interp(-wanted, -falling, _HEIGHT)
    return found


_TABLES = _half_integrals()
