# SPDX-License-Identifier: MIT
"""Inputs of a contact model from a fractal fit: D, G and their uncertainty."""

from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.models import ContactModel
from jointbench.analysis.contact.spread import ContactSpread
from jointbench.signal.fractal.verdict_records import (
    NORMAL_97_5,
    WIDEST_ROUGHNESS,
    FractalFit,
    Scaling,
)
from jointbench.signal.surface.structure_constant import log_roughness

_STEP = 1e-5
"""Step of the numerical derivative by D [-]; the constant is smooth in D."""


@dataclass(frozen=True, slots=True)
class SurfaceLevel:
    """The best determined number of a surface besides D: S at its pivot.

    Attributes:
        pivot: lag at which D and S are nearly independent [m].
        value: S there [m^2].
        interval: 2.5 % and 97.5 % points of it [m^2].
    """

    pivot: float
    value: float
    interval: tuple[float, float]


@dataclass(frozen=True, slots=True)
class ContactSurface:
    """A rough contact surface, or two as one, as input of a contact model.

    Attributes:
        dimension: of a line on the surface, 1 < D < 2 [-].
        roughness: fractal roughness G of that line [m].
        spread: standard deviations of D and ln G, and their correlation.
        level: result of the fit; None where D and G were given as numbers.
        cautions: cautions about the underlying heights.
    """

    dimension: float
    roughness: float
    spread: ContactSpread = field(default_factory=ContactSpread)
    level: SurfaceLevel | None = None
    cautions: tuple[str, ...] = ()

    @property
    def roughness_interval(self) -> tuple[float, float] | None:
        """2.5 % and 97.5 % points of G [m]; None without a spread."""
        if self.spread.log_roughness == 0:
            return None
        reach = float(np.exp(NORMAL_97_5 * self.spread.log_roughness))
        return self.roughness / reach, self.roughness * reach

    @property
    def roughness_known(self) -> bool:
        """Whether G can be reported: given as a number, or fitted within a decade."""
        interval = self.roughness_interval
        if self.level is None or interval is None:
            return True
        return bool(interval[1] <= WIDEST_ROUGHNESS * interval[0])

    def dimension_for(self, model: ContactModel) -> float:
        """Return D as `model` defines it: of a line (2D) or of the surface, D + 1."""
        return self.dimension + (model.topography.lowest_dimension - 1)


def contact_surface(fit: FractalFit) -> ContactSurface:
    """Return a fit as the input of a contact model, with its uncertainty.

    Args:
        fit: of one contact surface, or of the sum S_a + S_b of two.

    Returns:
        D, G and their joint spread, propagated from (D, ln S at the pivot).

    Raises:
        BadData: the surface has no scaling range; the message holds the fit's reason.

    Source:
        ln G = (ln S_p - ln C(D) - (4 - 2D) ln tau_p) / (2 (D - 1)), from Appl. Sci.
        2025, 15, 9040, eq. (9).
    """
    if fit.scaling is None:
        raise BadData(f"no contact prediction: {fit.verdict.value}; {fit.reason}")
    scaling = fit.scaling
    slope = np.array([_by_dimension(scaling), 0.5 / (scaling.dimension - 1)])
    log_sd = float(np.sqrt(slope @ scaling.covariance @ slope))
    together = float((scaling.covariance @ slope)[0])
    dimension = float(np.sqrt(scaling.covariance[0, 0]))
    correlation = together / (log_sd * dimension) if dimension > 0 else 0.0
    return ContactSurface(
        scaling.dimension,
        scaling.roughness,
        ContactSpread(
            dimension=dimension,
            log_roughness=log_sd,
            correlation=float(np.clip(correlation, -1, 1)),
        ),
        SurfaceLevel(scaling.pivot, scaling.pivot_value, scaling.pivot_value_interval),
    )


def _by_dimension(scaling: Scaling) -> float:
    """Return d ln G / d D at fixed S of the pivot [-]."""
    level = float(np.log(scaling.pivot_value))
    up, down = (
        log_roughness(scaling.dimension + step, level, scaling.pivot)
        for step in (_STEP, -_STEP)
    )
    return (up - down) / (2 * _STEP)
