# SPDX-License-Identifier: MIT
"""The papers' fractal laws per area, with the reference area that they need."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.contact.contact_case import ContactCase
from jointbench.analysis.contact.predict import (
    ContactState,
    ContactVerdict,
    predict_contact,
)
from jointbench.analysis.contact.spectral.measured_laws import LawCurve
from jointbench.analysis.contact.torque_to_preload import Preload


def fractal_curve(
    case: ContactCase,
    pressure: FloatArray,
    *,
    area: float,
    sample: float,
    waves: tuple[float, float],
) -> LawCurve:
    """Return a fractal law per area at several pressures.

    In these laws the stiffness depends on the load alone, by an exponent below 1, so a
    law per area needs an area to which it belongs: that of the measured sample. The
    interval runs to the stiffness with the whole apparent area as one sample.

    Args:
        case: model, surface and conditions; its preload is replaced.
        pressure: nominal [Pa], shape (n_pressures,).
        area: apparent [m^2].
        sample: area of the measured sample [m^2].
        waves: shortest and longest wavelength that D and G are from [m].

    Raises:
        BadData: the surface is outside the range of the model.
    """
    bare = case.without_damping()
    ours, whole = (
        [
            predict_contact(replace(bare, preload=Preload(float(p) * part, 0.0)))
            for p in pressure
        ]
        for part in (sample, area)
    )
    stiffness = np.array([one.normal_stiffness for one in ours]) / sample
    other = np.array([one.normal_stiffness for one in whole]) / area
    return LawCurve(
        case.model.name,
        pressure,
        stiffness,
        np.minimum(stiffness, other),
        np.maximum(stiffness, other),
        np.full(pressure.shape, np.nan),
        np.array([one.real_area for one in ours]) / sample,
        tuple(_outside(one, waves) for one in ours),
    )


def _outside(state: ContactState, waves: tuple[float, float]) -> tuple[str, ...]:
    said = []
    if state.verdict is not ContactVerdict.USABLE:
        said.append(state.verdict.value)
    size = float(np.sqrt(state.largest_area))
    if not waves[0] <= size <= waves[1]:
        said.append(
            f"largest contact {1e6 * size:.2g} um, the heights give D and G of "
            f"{1e6 * waves[0]:.2g} to {1e6 * waves[1]:.2g} um"
        )
    return tuple(said)
