# SPDX-License-Identifier: MIT
"""What the contact bench asks of a contact law, and the law linearised in its inputs.

A law converts preload to normal and tangential stiffness, with parameters that are
known with an uncertainty. Nothing else is asked, so that any law of a measured surface
can be the base of a diagnosis.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT


@dataclass(frozen=True, slots=True)
class LawParameter:
    """One input of a contact law.

    Attributes:
        name: for example ``"hardness"``.
        unit: of the value.
        value: nominal.
        log_sd: sd of the natural logarithm of the value [-]; 0 if exactly known.
        per_cut: change of ln(value) per unit of ln of the shortest wavelength that
            the surface instrument sees [-]; 0 if it does not depend on it.
    """

    name: str
    unit: str
    value: float
    log_sd: float
    per_cut: float = 0.0


class PreloadLaw(Protocol):
    """A contact law as the bench uses it."""

    @property
    def name(self) -> str:
        """Name of the law, for reports."""
        ...

    @property
    def parameters(self) -> tuple[LawParameter, ...]:
        """Inputs with their uncertainty."""
        ...

    @property
    def factor_sd(self) -> float:
        """Sd of ln(stiffness of the contact over that of the law) [-]."""
        ...

    @property
    def roughness_alone(self) -> float | None:
        """Rms height of measured surfaces too short to show their waves [m], or None.

        None also for a law of numbers, which makes no statement of waves.
        """
        ...

    def log_stiffness(
        self, log_preload: FloatArray, coordinates: FloatArray
    ) -> FloatArray:
        """Return ln of normal and tangential stiffness [ln N/m], shape (2, n).

        Args:
            log_preload: ln of the preload [ln N], shape (n,).
            coordinates: ln(value / nominal) of each parameter, shape (n_parameters,).
        """
        ...


@dataclass(frozen=True, slots=True, eq=False)
class LinearisedLaw:
    """A law linearised in its parameters about one point, exact in the preload.

    Attributes:
        law: the law itself.
        about: coordinates of the point, shape (n_parameters,).
        spline: ln k and its slopes by each parameter over ln P.
    """

    law: PreloadLaw
    about: FloatArray
    spline: CubicSpline

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "about")

    @property
    def parameters(self) -> tuple[LawParameter, ...]:
        """Inputs with their uncertainty."""
        return self.law.parameters

    def log_stiffness(
        self, log_preload: FloatArray, coordinates: FloatArray
    ) -> FloatArray:
        """Return ln of normal and tangential stiffness, shape (2, n)."""
        table = self.spline(log_preload)
        step = np.concatenate([[1.0], coordinates - self.about])
        return np.asarray(np.einsum("nqk,k->qn", table, step))

    def cut_shift(self, log_preload: FloatArray) -> FloatArray:
        """Return d ln k by ln of the instrument's cut-off, shape (2, n)."""
        table = self.spline(log_preload)[:, :, 1:]
        per_cut = np.array([p.per_cut for p in self.parameters])
        return np.asarray(np.einsum("nqk,k->qn", table, per_cut))


def linearised(
    law: PreloadLaw, log_range: tuple[float, float], about: Sequence[float] = ()
) -> LinearisedLaw:
    """Linearise a law in its parameters.

    Args:
        law: any law.
        log_range: smallest and largest ln P of the states; a margin is added.
        about: coordinates to linearise about; empty for the nominal values.
    """
    count = len(law.parameters)
    point = np.array(about, dtype=float) if len(about) else np.zeros(count)
    low, high = log_range
    grid = np.linspace(
        low - CONTACT.law_margin[0], high + CONTACT.law_margin[1], CONTACT.law_points
    )
    columns = [law.log_stiffness(grid, point)]
    for k in range(count):
        step = np.zeros(count)
        step[k] = CONTACT.law_step
        up = law.log_stiffness(grid, point + step)
        down = law.log_stiffness(grid, point - step)
        columns.append((up - down) / (2.0 * CONTACT.law_step))
    table = np.stack(columns, axis=-1).transpose(1, 0, 2)
    return LinearisedLaw(law, point, CubicSpline(grid, table))
