# SPDX-License-Identifier: MIT
"""Laws of contact for a measured surface: what each predicts, and where it applies."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.special import ndtri

from jointbench.acquisition.basics.array_checks import require_positive
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.contact.spectral.height_distribution import HeightFacts
from jointbench.analysis.contact.spectral.isotropic_spectrum import (
    DRAWS,
    IsotropicSpectrum,
)
from jointbench.analysis.contact.spectral.law_limits import LIMITS
from jointbench.analysis.contact.spectral.persson import persson_state
from jointbench.analysis.contact.spectral.summit_laws import (
    LineMoments,
    SummitState,
    bush_gibson_thomas,
    greenwood_williamson,
    line_moments,
)

_NOISE_PER_DRAW = 8
"""Draws of a law's own scatter for each draw of the surface [-]."""
_WIDEST_SD = 0.5
"""Largest standard deviation of ln k [-]: the scatter of one hill."""
_HURST = 0.8
"""H of the power law of one hill where the surface has none [-]; H of 0.5 to 1 gives
exponents of 0.67 to 0.5."""
_SEED = 236


class MeasuredLaw(StrEnum):
    """Laws that take the spectrum of a measured surface."""

    PERSSON = "persson"
    GREENWOOD_WILLIAMSON = "greenwood_williamson"
    BUSH_GIBSON_THOMAS = "bush_gibson_thomas"
    YOVANOVICH = "yovanovich"


@dataclass(frozen=True, slots=True)
class MeasuredCase:
    """A joint of measured surfaces, apart from its load.

    Attributes:
        surface: combined spectrum of both contact surfaces.
        facts: of their heights.
        area: apparent [m^2]; the reference of pressure and stiffness per area.
        modulus: E* [Pa].
        hardness: of the softer body [Pa].
        modulus_sd: standard deviation of E* [Pa].
        hardness_sd: standard deviation of the hardness [Pa].
        lay: ratio of the slopes of a map along rows and columns [-], the larger one of
            both surfaces; 1 for profiles.
    """

    surface: IsotropicSpectrum
    facts: HeightFacts
    area: float
    modulus: float
    hardness: float
    modulus_sd: float = 0.0
    hardness_sd: float = 0.0
    lay: float = 1.0

    def __post_init__(self) -> None:
        """Check that every number is possible for a joint."""
        for name in ("area", "modulus", "hardness"):
            require_positive(name, getattr(self, name))

    @property
    def gradient(self) -> float:
        """Root mean square gradient h' [-]."""
        return float(np.sqrt(self.surface.moment(2)[0]))

    @property
    def flattening(self) -> float:
        """E* h', the pressure of nearly full contact [Pa]."""
        return self.modulus * self.gradient

    @property
    def height(self) -> float:
        """Root mean square height [m]."""
        return float(np.sqrt(self.surface.moment(0)[0]))

    @property
    def hills(self) -> float:
        """Apparent area over the square of the mean wavelength [-]."""
        return float(self.area / self.surface.mean_wave()[0] ** 2)

    @property
    def plasticity_index(self) -> float:
        """E*/H (sigma_s/R)^(1/2) of Greenwood and Williamson [-]."""
        moments = line_moments(self.surface)
        ratio = moments.summit_height[0] / moments.radius[0]
        return float(self.modulus / self.hardness * np.sqrt(ratio))


@dataclass(frozen=True, slots=True, eq=False)
class LawCurve:
    """One law at several pressures.

    Attributes:
        law: its name, of `MeasuredLaw` or of a contact model.
        pressure: nominal [Pa], shape (n_pressures,).
        stiffness: normal, per apparent area [N/m^3], same shape.
        low: 2.5 % point of it.
        high: 97.5 % point.
        separation: of the mean planes [m], same shape.
        real_area: over the apparent area [-], same shape.
        outside: why the law does not apply, at each pressure; empty where it does.
    """

    law: str
    pressure: FloatArray
    stiffness: FloatArray
    low: FloatArray
    high: FloatArray
    separation: FloatArray
    real_area: FloatArray
    outside: tuple[tuple[str, ...], ...]

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "pressure", "stiffness", "low", "high", "separation", "real_area")


@dataclass(frozen=True, slots=True, eq=False)
class _Common:
    """What all laws of a case share."""

    case: MeasuredCase
    pressure: FloatArray
    modulus: FloatArray
    hardness: FloatArray
    moments: LineMoments
    contacts: FloatArray
    load_sd: FloatArray


def predict_measured(
    case: MeasuredCase, pressure: FloatArray, load_sd: FloatArray | float = 0.0
) -> tuple[LawCurve, ...]:
    """Return what each law predicts for a measured surface.

    Intervals hold the estimate of the surface, the modulus, the hardness, the load, the
    accuracy of the law against boundary elements, and the scatter of few contacts.

    Args:
        case: surface, materials, apparent area.
        pressure: nominal, ascending [Pa], shape (n_pressures,).
        load_sd: standard deviation of each load over the load [-], same shape.
    """
    random = np.random.default_rng(_SEED)
    modulus, hardness = (
        _drawn(random, value, sd)
        for value, sd in (
            (case.modulus, case.modulus_sd),
            (case.hardness, case.hardness_sd),
        )
    )
    coarse = case.surface.without_below(
        float(case.surface.mean_wave()[0]) / LIMITS.finest_of_hill
    )
    counted = bush_gibson_thomas(line_moments(coarse), pressure, modulus)
    common = _Common(
        case,
        pressure,
        modulus,
        hardness,
        line_moments(case.surface),
        counted.contacts * case.area,
        np.broadcast_to(load_sd, pressure.shape),
    )
    return (
        _persson(common),
        _summits(common, MeasuredLaw.GREENWOOD_WILLIAMSON, greenwood_williamson),
        _summits(common, MeasuredLaw.BUSH_GIBSON_THOMAS, bush_gibson_thomas),
        _yovanovich(common),
    )


def _drawn(random: np.random.Generator, value: float, sd: float) -> FloatArray:
    """Return a positive value and lognormal draws of it."""
    spread = np.sqrt(np.log1p((sd / value) ** 2))
    drawn = value * np.exp(spread * random.standard_normal(DRAWS))
    return np.concatenate([[value], drawn])


def _persson(common: _Common) -> LawCurve:
    case, pressure = common.case, common.pressure
    found = persson_state(case.surface, pressure, common.modulus, common.hardness)
    hurst = np.where(np.isnan(case.surface.hurst), _HURST, case.surface.hurst)
    # K ~ F^(1 / (1 + H)) of a single hill; the number of contacts grows with F.
    few = np.minimum(1.0, common.contacts / LIMITS.finite_size_contacts)
    stiffness = found.stiffness * few ** -(hurst / (1 + hurst))[:, None]
    stiffening = found.stiffening[0]
    outside = [
        (
            *_of_any_law(common, j),
            *_above(
                p / (case.modulus * case.gradient), LIMITS.highest_load, "p / (E* h')"
            ),
            *_above(p / case.hardness, LIMITS.full_yield, "p / H"),
            *_above(stiffening[j], LIMITS.most_stiffening, "stiffening by yielding"),
        )
        for j, p in enumerate(pressure)
    ]
    # Half of what yielding adds: its size rests on one published formula.
    own = np.hypot(LIMITS.persson_sd, 0.5 * np.log(stiffening))
    low, high = _interval(common, stiffness, own)
    return LawCurve(
        MeasuredLaw.PERSSON,
        pressure,
        stiffness[0],
        low,
        high,
        found.gap,
        found.real_area[0],
        tuple(outside),
    )


def _summits(
    common: _Common,
    law: MeasuredLaw,
    state: Callable[[LineMoments, FloatArray, FloatArray], SummitState],
) -> LawCurve:
    case, pressure = common.case, common.pressure
    found = state(common.moments, pressure, common.modulus)
    index = case.plasticity_index
    outside = [
        (
            *_of_any_law(common, j),
            *_above(
                p / (case.modulus * case.gradient),
                LIMITS.highest_summit_load,
                "p / (E* h')",
            ),
            *_below(
                found.separation[0, j] / case.height,
                LIMITS.lowest_separation,
                "separation / h_rms",
            ),
            *_above(index, LIMITS.plastic, "plasticity index"),
        )
        for j, p in enumerate(pressure)
    ]
    low, high = _interval(
        common, found.stiffness, np.full(pressure.size, LIMITS.summit_sd)
    )
    return LawCurve(
        law,
        pressure,
        found.stiffness[0],
        low,
        high,
        found.separation[0],
        found.real_area[0],
        tuple(outside),
    )


def _yovanovich(common: _Common) -> LawCurve:
    """Return plastic contact: its area is load over hardness.

    Source:
        Cooper, Mikic and Yovanovich, Int. J. Heat Mass Transf. 12 (1969) 279, with the
        exponent of Yovanovich, AIAA 82-0888 (1982): conductance over conductivity
        1.25 m / sigma (p / H)^0.95, m the mean absolute slope of a line. Stiffness over
        E* is the same number: Barber, Proc. R. Soc. A 459 (2003) 53.
    """
    case, pressure = common.case, common.pressure
    slope = np.sqrt(2 / np.pi * common.moments.slope)
    height = np.sqrt(common.moments.height)
    share = pressure / common.hardness[:, None]
    stiffness = 1.25 * (common.modulus * slope / height)[:, None] * share**0.95
    plastic = case.modulus * slope[0] / case.hardness
    outside = [
        (
            *_of_any_law(common, j),
            *_below(plastic, LIMITS.plastic_slope, "E* m / H"),
            *_above(p / case.hardness, LIMITS.full_yield, "p / H"),
        )
        for j, p in enumerate(pressure)
    ]
    low, high = _interval(common, stiffness, np.full(pressure.size, LIMITS.plastic_sd))
    # Both areas are cut off where the plane cuts normal heights.
    area = np.minimum(share[0], 0.5)
    return LawCurve(
        MeasuredLaw.YOVANOVICH,
        pressure,
        stiffness[0],
        low,
        high,
        -height[0] * ndtri(area),
        area,
        tuple(outside),
    )


def _of_any_law(common: _Common, place: int) -> tuple[str, ...]:
    """Return why no law of many random contacts applies at a pressure."""
    case, contacts = common.case, common.contacts[0, place]
    deviation = case.facts.deviation
    return (
        *(() if deviation is None else (deviation,)),
        *_below(case.hills, LIMITS.fewest_hills, "hills in the apparent area"),
        *_below(contacts, LIMITS.fewest_contacts, "summits in contact"),
    )


def _above(value: float, limit: float, name: str) -> tuple[str, ...]:
    return (f"{name} = {value:.2g}, above {limit:g}",) if value > limit else ()


def _below(value: float, limit: float, name: str) -> tuple[str, ...]:
    return (f"{name} = {value:.2g}, below {limit:g}",) if value < limit else ()


def _interval(
    common: _Common, stiffness: FloatArray, own: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the 2.5 and 97.5 % points of the stiffness at each pressure."""
    variance = own**2 + LIMITS.contact_scatter / np.maximum(common.contacts[0], 1e-9)
    variance = variance + LIMITS.hill_scatter / common.case.hills
    # Stiffness follows the load in equal ratios, or more slowly.
    sd = np.hypot(np.minimum(np.sqrt(variance), _WIDEST_SD), common.load_sd)
    random = np.random.default_rng(_SEED)
    noise = random.standard_normal((_NOISE_PER_DRAW, DRAWS, 1))
    drawn = np.log(stiffness[1:]) + sd * noise
    ends = np.quantile(drawn.reshape(-1, sd.size), [0.025, 0.975], axis=0)
    low, high = np.exp(ends)
    return np.minimum(low, stiffness[0]), np.maximum(high, stiffness[0])
