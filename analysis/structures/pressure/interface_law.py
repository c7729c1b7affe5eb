# SPDX-License-Identifier: MIT
"""Stiffness and damping per area of an interface over its local pressure."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import BadData

_LOGARITHMIC = 1e-9
"""Difference of an exponent from 1 below which the approach is a logarithm [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class InterfaceLaw:
    """A law per unit area: straight in double logarithms between its points.

    Below the first pressure it is linear, so that the surfaces part at a finite gap;
    above the last one the last exponent continues.

    Attributes:
        pressure: ascending [Pa], shape (n,).
        normal: stiffness per area [N/m^3], shape (n,).
        tangential: the same, in the plane [N/m^3], shape (n,).
        damping: normal damping per area [N s/m^3], shape (n,); zeros where unknown.
        log_sd: standard deviation of ln of the stiffness, one for all pressures [-].
        source: which law it is and its reference area, one line.
    """

    pressure: FloatArray
    normal: FloatArray
    tangential: FloatArray
    damping: FloatArray
    log_sd: float
    source: str

    def __post_init__(self) -> None:
        """Check the points, and make the arrays read-only."""
        for name in ("pressure", "normal"):
            value = getattr(self, name)
            if not (np.all(np.isfinite(value)) and np.all(value > 0)):
                raise BadData(
                    f"the contact law has a {name} that is not positive and finite; "
                    "check its numbers and its reference area"
                )
        freeze(self, "pressure", "normal", "tangential", "damping")

    def stiffness(self, pressure: FloatArray) -> FloatArray:
        """Return the normal stiffness per area at pressures [N/m^3], same shape."""
        place, reach = self._segment(pressure)
        grown = np.exp(self._exponents()[place] * reach)
        return np.asarray(self.normal[place] * grown)

    def approach(self, pressure: FloatArray) -> FloatArray:
        """Return how far the surfaces come together at pressures [m], same shape."""
        place, reach = self._segment(pressure)
        straight = pressure / self.normal[0]
        beyond = self._steps()[place] + self._within(place, reach)
        return np.asarray(np.where(pressure <= self.pressure[0], straight, beyond))

    def other(self, name: str, pressure: FloatArray) -> FloatArray:
        """Return ``tangential`` or ``damping`` per area at pressures, same shape."""
        share = getattr(self, name) / self.normal
        held = np.log(np.maximum(pressure, self.pressure[0]))
        ratio = np.interp(held, np.log(self.pressure), share)
        return np.asarray(self.stiffness(pressure) * ratio)

    def scaled(self, factor: float) -> "InterfaceLaw":
        """Return the law with every stiffness and damping multiplied."""
        return InterfaceLaw(
            self.pressure,
            self.normal * factor,
            self.tangential * factor,
            self.damping * factor,
            self.log_sd,
            self.source,
        )

    def _exponents(self) -> FloatArray:
        slope = np.diff(np.log(self.normal)) / np.diff(np.log(self.pressure))
        return np.append(slope, slope[-1])

    def _segment(self, pressure: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the point below each pressure, and ln of the pressure over it."""
        held = np.maximum(pressure, self.pressure[0])
        place = np.searchsorted(self.pressure, held, side="right") - 1
        return place.astype(np.int64), np.log(held / self.pressure[place])

    def _within(self, place: IntArray, reach: FloatArray) -> FloatArray:
        left = 1 - self._exponents()[place]
        curved = np.abs(left) > _LOGARITHMIC
        safe = np.where(curved, left, 1.0)
        length = np.where(curved, np.expm1(safe * reach) / safe, reach)
        return np.asarray(self.pressure[place] / self.normal[place] * length)

    def _steps(self) -> FloatArray:
        """Return the approach at each point [m]."""
        inner = np.arange(self.pressure.size - 1).astype(np.int64)
        parts = self._within(inner, np.diff(np.log(self.pressure)))
        first = self.pressure[0] / self.normal[0]
        return np.asarray(first + np.concatenate([[0.0], np.cumsum(parts)]))


@dataclass(frozen=True, slots=True)
class PowerInterface:
    """A power law per unit area, k = c (p / p_0)^m.

    Attributes:
        stiffness: c, at the pressure p_0 [N/m^3].
        pressure: p_0 [Pa].
        exponent: m, 0 to 1 [-].
        tangential_ratio: tangential over normal stiffness [-].
        loss_factor: eta of the interface [-]; damping is eta k / omega.
        frequency: at which the loss becomes damping [Hz].
        log_sd: standard deviation of ln c [-].
    """

    stiffness: float
    pressure: float
    exponent: float
    tangential_ratio: float
    loss_factor: float
    frequency: float
    log_sd: float

    def law(self, pressures: FloatArray) -> InterfaceLaw:
        """Return the law at pressures [Pa], shape (n,)."""
        normal = self.stiffness * (pressures / self.pressure) ** self.exponent
        losses = self.loss_factor / (2 * np.pi * self.frequency)
        return InterfaceLaw(
            pressures,
            normal,
            self.tangential_ratio * normal,
            losses * normal,
            self.log_sd,
            f"k = {self.stiffness:.3g} N/m^3 (p / {self.pressure:.3g} Pa)^"
            f"{self.exponent:g} per unit area: no reference area",
        )


def law_of_loads(
    pressures: FloatArray,
    area: float,
    at_load: Callable[[float], tuple[float, float, float]],
    *,
    log_sd: float,
    source: str,
) -> InterfaceLaw:
    """Return a law of the load as one per unit area, k(p) = K(p A) / A.

    In these laws K depends on the load alone, so patches of a surface would add up to a
    stiffness that depends on their number: the sample area on which the surface was
    measured stands for the size within which its contacts share a load.

    Args:
        pressures: ascending [Pa], shape (n,).
        area: reference area A of the law [m^2].
        at_load: normal stiffness, tangential stiffness [N/m] and damping [N s/m] at a
            load [N].
        log_sd: of the stiffness [-].
        source: which law, one line.

    Raises:
        BadData: the law has no stiffness at one of the pressures.
    """
    values = np.array([at_load(float(p * area)) for p in pressures]) / area
    return InterfaceLaw(
        pressures, values[:, 0], values[:, 1], values[:, 2], log_sd, source
    )
