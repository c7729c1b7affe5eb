# SPDX-License-Identifier: MIT
"""Laws of contact for one or two measured surfaces: from heights to stiffness."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.analysis.contact.contact_case import ContactCase, ContactConditions
from jointbench.analysis.contact.models import ContactModel
from jointbench.analysis.contact.spectral.fractal_reference import fractal_curve
from jointbench.analysis.contact.spectral.height_distribution import (
    facts_of_both,
    height_facts,
)
from jointbench.analysis.contact.spectral.isotropic_spectrum import (
    combined,
    doubled,
)
from jointbench.analysis.contact.spectral.measured_laws import (
    LawCurve,
    MeasuredCase,
    predict_measured,
)
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.analysis.contact.torque_to_preload import Preload
from jointbench.signal.band_limited.band_limited_fit import fit_lines
from jointbench.signal.band_limited.band_records import BandLimitedFit
from jointbench.station.contact.surface_spectrum import surface_spectrum

CURVE_POINTS = 25
_BELOW, _ABOVE = 100.0, 10.0
"""The curve runs from the least preload over the first to the largest times the second
[-]."""


@dataclass(frozen=True, slots=True)
class MeasuredJoint:
    """A joint apart from its surfaces.

    Attributes:
        area: apparent [m^2].
        conditions: material, and standard deviations of modulus and hardness.
        preloads: [N].
        models: fractal laws to show beside, where the surface has D and G.
    """

    area: float
    conditions: ContactConditions
    preloads: tuple[Preload, ...]
    models: tuple[ContactModel, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPrediction:
    """What the laws predict for measured surfaces.

    Attributes:
        names: of the surfaces; one stands for both.
        fits: their band-limited surfaces.
        case: the joint.
        preloads: [N].
        at: each law at the preloads, in ascending order.
        curve: each law over a range around them.
        coarser: the laws of the spectrum at the preloads without the shortest octave.
        no_fractal: why no fractal law is shown; None where one is or none is asked.
        profiles: whether a surface is a profile, whose lay is unknown.
    """

    names: tuple[str, ...]
    fits: tuple[BandLimitedFit, ...]
    case: MeasuredCase
    preloads: tuple[float, ...]
    at: tuple[LawCurve, ...]
    curve: tuple[LawCurve, ...]
    coarser: tuple[LawCurve, ...]
    no_fractal: str | None
    profiles: bool


def measured_prediction(
    surfaces: Sequence[Surface],
    joint: MeasuredJoint,
    fractal: ContactSurface | str | None,
) -> MeasuredPrediction:
    """Predict the stiffness of a joint from the spectra of its surfaces.

    Args:
        surfaces: of both sides, or one that stands for both.
        joint: area, materials, preloads.
        fractal: D and G of the equivalent surface, the reason for none, or None where
            no fractal law is asked.

    Raises:
        BadData: a surface shows no wavelength, or has too few points.
    """
    fits = tuple(fit_lines([one]) for one in surfaces)
    case = measured_case(surfaces, fits, joint)
    loads = sorted(joint.preloads, key=lambda one: one.value)
    pressure = np.array([one.value for one in loads]) / joint.area
    scatter = np.array([one.sd / one.value for one in loads])
    wide = np.geomspace(pressure[0] / _BELOW, pressure[-1] * _ABOVE, CURVE_POINTS)
    laws, curve = (
        predict_measured(case, pressure, scatter),
        predict_measured(case, wide),
    )
    reason = fractal if isinstance(fractal, str) else None
    if isinstance(fractal, ContactSurface):
        try:
            laws += _fractal_laws(case, joint, fractal, pressure)
            curve += _fractal_laws(case, joint, fractal, wide)
        except BadData as error:
            reason = str(error)
    return MeasuredPrediction(
        names=tuple(one.name for one in surfaces),
        fits=fits,
        case=case,
        preloads=tuple(one.value for one in loads),
        at=laws,
        curve=curve,
        coarser=predict_measured(_coarser(case), pressure),
        no_fractal=reason,
        profiles=any(isinstance(one, Profile) for one in surfaces),
    )


def measured_case(
    surfaces: Sequence[Surface],
    fits: Sequence[BandLimitedFit],
    joint: MeasuredJoint,
) -> MeasuredCase:
    """Return a joint of measured surfaces, as the laws of their spectra take it.

    Args:
        surfaces: of both sides, or one that stands for both.
        fits: their band-limited surfaces.
        joint: area and materials.
    """
    pairs = [surface_spectrum(*one) for one in zip(surfaces, fits, strict=True)]
    spectra = [spectrum for spectrum, _ in pairs]
    facts = [
        height_facts(surface, float(one.mean_wave()[0]))
        for surface, one in zip(surfaces, spectra, strict=True)
    ]
    whole = doubled(spectra[0]) if len(spectra) == 1 else combined(*spectra)
    material = joint.conditions.material
    return MeasuredCase(
        surface=whole,
        facts=facts_of_both(facts if len(facts) > 1 else facts * 2),
        area=joint.area,
        modulus=material.effective_modulus,
        hardness=material.hardness,
        modulus_sd=joint.conditions.modulus_sd,
        hardness_sd=joint.conditions.hardness_sd,
        lay=max(ratio for _, ratio in pairs),
    )


def _coarser(case: MeasuredCase) -> MeasuredCase:
    """Return the joint without the shortest octave of its surface."""
    rest = case.surface.without_below(2 * case.surface.shortest)
    return MeasuredCase(rest, case.facts, case.area, case.modulus, case.hardness)


def _fractal_laws(
    case: MeasuredCase,
    joint: MeasuredJoint,
    surface: ContactSurface,
    pressure: FloatArray,
) -> tuple[LawCurve, ...]:
    """Return the fractal laws with the square of the longest wave as their area."""
    waves = (case.surface.shortest, case.surface.longest)
    return tuple(
        fractal_curve(
            ContactCase(model, surface, joint.preloads[0], joint.conditions),
            pressure,
            area=joint.area,
            sample=min(joint.area, waves[1] ** 2),
            waves=waves,
        )
        for model in joint.models
    )
