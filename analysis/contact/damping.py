# SPDX-License-Identifier: MIT
"""Damping of a joint from the energy loss of its contacts, and its conventions.

The loss is that of a first loading to the preload. A small vibration about the preload
loses less: these numbers are an upper bound, not the loss of a cycle.
"""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.energy import joint_energy, two_regime_energy
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import ContactModel


class EnergyForm(StrEnum):
    """Method for the lost and the stored energy of the contacts."""

    KOGUT_ETSION = "kogut-etsion"
    TWO_REGIME = "two-regime"


class LossConvention(StrEnum):
    """Definition of the loss factor: W_d/W_e, or W_d/(2 pi W_max); about 2 pi apart."""

    ENERGY_RATIO = "energy-ratio"
    PER_RADIAN = "per-radian"


@dataclass(frozen=True, slots=True)
class DampingChoice:
    """Definition of a damping coefficient.

    Attributes:
        mass: moving mass on the joint [kg]; sets the frequency sqrt(K/M) ...
        frequency: ... unless it is given [Hz].
        form: of the energies.
        convention: of the loss factor.
    """

    mass: float | None = None
    frequency: float | None = None
    form: EnergyForm = EnergyForm.KOGUT_ETSION
    convention: LossConvention = LossConvention.ENERGY_RATIO

    def __post_init__(self) -> None:
        """Check that one of mass and frequency is given."""
        if (self.mass is None) == (self.frequency is None):
            raise BadData(
                "damping needs the mass on the joint or the frequency, one of them; "
                "give e.g. mass 19.5 kg"
            )
        value = self.mass if self.mass is not None else self.frequency
        if not (value is not None and 0 < value < math.inf):
            raise BadData(
                f"mass or frequency is {value:g}, it must be positive; give e.g. 19.5"
            )


def loss_factor(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    log_largest: FloatArray,
    *,
    form: EnergyForm = EnergyForm.KOGUT_ETSION,
    convention: LossConvention = LossConvention.ENERGY_RATIO,
) -> FloatArray:
    """Return the loss factor of a joint's first loading [-].

    Args:
        model: its laws are used.
        surface: dimension, roughness and hardness of one or many surfaces.
        material: effective modulus and yield properties.
        log_largest: ln(a_l / m^2), broadcast with the surfaces.
        form: two regimes as in Zhang's model, or Kogut and Etsion's laws with
            Etsion's unloading.
        convention: of the quotient.

    Returns:
        Loss factor, infinite where no energy is stored.
    """
    if form is EnergyForm.TWO_REGIME:
        stored, lost = two_regime_energy(model, surface, material, log_largest)
    else:
        energy = joint_energy(model, surface, material, log_largest)
        stored, lost = energy.recovered.sum(axis=0), energy.dissipated.sum(axis=0)
    below = stored
    if convention is LossConvention.PER_RADIAN:
        below = 2 * math.pi * (stored + lost)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(lost / below)


def damping_coefficient(
    factor: FloatArray, stiffness: FloatArray, choice: DampingChoice
) -> FloatArray:
    """Return the viscous coefficient with the same loss at one frequency [N s/m].

    Args:
        factor: loss factor in the convention of `choice` [-].
        stiffness: of the joint [N/m].
        choice: mass or frequency.

    Returns:
        eta K/omega, which is eta sqrt(M K) at omega = sqrt(K/M). The damping ratio is
        eta/2 where the convention is per radian.
    """
    if choice.frequency is not None:
        return np.asarray(factor * stiffness / (2 * math.pi * choice.frequency))
    return np.asarray(factor * np.sqrt(float(choice.mass or 0.0) * stiffness))


def damping_ratio(damping: float, stiffness: float, mass: float) -> float:
    """Return C/(2 sqrt(K M)) [-]; above 1 there is no oscillating mode."""
    return damping / (2 * math.sqrt(stiffness * mass))
