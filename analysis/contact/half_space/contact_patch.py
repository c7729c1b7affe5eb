# SPDX-License-Identifier: MIT
"""Contact patch, pressures and stiffness of mated heights, waviness apart."""

from dataclasses import dataclass

import numpy as np
from scipy import fft

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.contact.half_space.elastic_contact import (
    ElasticContact,
    solve_contact,
)
from jointbench.analysis.contact.half_space.influence import (
    Influence,
    periodic_influence,
)
from jointbench.analysis.contact.half_space.mated_heights import MatedHeights
from jointbench.signal.surface.gaussian_filter import transmission

_STEP = 0.03
"""Half the relative change of the load in the stiffness [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactPatch:
    """Mated heights under one load, on a map that repeats itself.

    Compliances are of the heights alone, without that of the bodies as half-spaces.

    Attributes:
        load: on the map [N].
        pressure: at each point [Pa], shape (n_rows, n_columns).
        mean_gap: [m].
        real_area: share of points in contact [-].
        patch: share of points in contact of the waviness alone [-].
        above_hardness: share of the load at pressures above the hardness [-].
        compliance: of all waves [m/N].
        wavy_compliance: of waves longer than the cut-off alone [m/N].
    """

    load: float
    pressure: FloatArray
    mean_gap: float
    real_area: float
    patch: float
    above_hardness: float
    compliance: float
    wavy_compliance: float

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "pressure")

    @property
    def rough_compliance(self) -> float:
        """Of waves shorter than the cut-off: all less the waviness [m/N]."""
        return self.compliance - self.wavy_compliance


def contact_patch(
    mated: MatedHeights,
    load: float,
    *,
    modulus: float,
    hardness: float,
    cutoff: float,
) -> ContactPatch:
    """Solve the elastic contact of mated heights at one load.

    Args:
        mated: sum of the heights of both sides.
        load: on the map [N].
        modulus: E* of both bodies [Pa].
        hardness: of the softer one [Pa]; nothing yields, the share above it is stated.
        cutoff: wavelength between roughness and waviness [m].

    Raises:
        BadData: a search does not end.
    """
    influence = periodic_influence(mated.heights.shape, mated.spacing, modulus)
    pressure = load / mated.area
    whole, compliance = _compliance(mated.heights, pressure, influence)
    wavy, slow = _compliance(waviness(mated, cutoff), pressure, influence)
    high = whole.pressure > hardness
    return ContactPatch(
        load=load,
        pressure=whole.pressure,
        mean_gap=whole.mean_gap,
        real_area=whole.area_share,
        patch=wavy.area_share,
        above_hardness=float(whole.pressure[high].sum() / whole.pressure.sum()),
        compliance=compliance / mated.area,
        wavy_compliance=slow / mated.area,
    )


def waviness(mated: MatedHeights, cutoff: float) -> FloatArray:
    """Return the heights of waves longer than a cut-off [m], by a Gaussian filter."""
    shape = mated.heights.shape
    rows = 2 * np.pi * fft.fftfreq(shape[0], mated.spacing[0])
    columns = 2 * np.pi * fft.rfftfreq(shape[1], mated.spacing[1])
    passed = transmission(np.hypot(rows[:, None], columns[None, :]), cutoff)
    smooth: FloatArray = fft.irfft2(fft.rfft2(mated.heights) * passed, s=shape)
    return smooth


def _compliance(
    heights: FloatArray, pressure: float, influence: Influence
) -> tuple[ElasticContact, float]:
    """Return the contact, and the fall of the mean gap over pressure [m/Pa]."""
    found = solve_contact(heights, pressure, influence)
    low, high = (
        solve_contact(heights, pressure * (1 + s), influence, found.pressure)
        for s in (-_STEP, _STEP)
    )
    return found, (low.mean_gap - high.mean_gap) / (2 * _STEP * pressure)
