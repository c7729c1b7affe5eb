# SPDX-License-Identifier: MIT
"""The laws of a measured surface as the base of the contact bench."""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.spectral.measured_laws import (
    LawCurve,
    MeasuredCase,
    MeasuredLaw,
    predict_measured,
)
from jointbench.analysis.contact.spectral.persson import persson_state
from jointbench.analysis.contact.spectral.summit_laws import (
    bush_gibson_thomas,
    greenwood_williamson,
    line_moments,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.preload_law import LawParameter
from jointbench.analysis.gap.contact_bench.preload_laws import mindlin_ratio

_ORDER = (
    MeasuredLaw.PERSSON,
    MeasuredLaw.BUSH_GIBSON_THOMAS,
    MeasuredLaw.GREENWOOD_WILLIAMSON,
)
"""Of laws that apply equally often, the first is used: it is the most accurate."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPreloadLaw:
    """Stiffness over preload by the spectrum of measured surfaces.

    Attributes:
        parameters: uncertainty of the surface in its principal directions, modulus,
            and the shortest wavelength that the instrument saw.
        spline: ln k_n and its slope by each parameter over ln P.
        poisson: Poisson ratio of the bodies [-].
        name: of the law.
        factor_sd: of ln(stiffness of the contact over that of the law) [-].
        roughness_alone: rms height [m] where the surfaces were measured over too
            short a length to show their waves, else None.
    """

    parameters: tuple[LawParameter, ...]
    spline: CubicSpline
    poisson: float
    name: str
    factor_sd: float
    roughness_alone: float | None

    def log_stiffness(
        self, log_preload: FloatArray, coordinates: FloatArray
    ) -> FloatArray:
        """Return ln of normal and tangential stiffness, shape (2, n)."""
        table = self.spline(log_preload)
        log_k = table @ np.concatenate([[1.0], coordinates])
        return np.stack([log_k, log_k + np.log(mindlin_ratio(self.poisson))])


def measured_preload_law(
    case: MeasuredCase,
    log_range: tuple[float, float],
    poisson: float,
    law: MeasuredLaw | None = None,
) -> MeasuredPreloadLaw:
    """Return the law of a measured surface that applies at most preloads.

    Args:
        case: surfaces, materials, apparent area.
        log_range: smallest and largest ln P of the states [ln N].
        poisson: Poisson ratio of the bodies [-].
        law: one to use whatever its range; None for that which applies most often.

    Raises:
        BadData: the law predicts no stiffness at these preloads.
    """
    shares = applying_shares(case, log_range)
    chosen = law or max(_ORDER, key=lambda one: (shares[one], -_ORDER.index(one)))
    low, high = log_range
    grid = np.linspace(
        low - CONTACT.law_margin[0], high + CONTACT.law_margin[1], CONTACT.law_points
    )
    drawn = _log_stiffness(case, chosen, grid)
    if not np.isfinite(drawn).all():
        raise BadData(
            f"law {chosen.value!r} predicts no stiffness at {np.exp(low):.3g} to "
            f"{np.exp(high):.3g} N; check area and modulus"
        )
    rows, shapes = _principal(drawn, grid, log_range)
    step = CONTACT.law_step
    stiffer = replace(case, modulus=case.modulus * np.exp(step))
    by_modulus = (_log_stiffness(stiffer, chosen, grid)[0] - drawn[0]) / step
    coarser = replace(
        case, surface=case.surface.without_below(2 * case.surface.shortest)
    )
    by_cut = (_log_stiffness(coarser, chosen, grid)[0] - drawn[0]) / np.log(2.0)
    spread = float(np.sqrt(np.log1p((case.modulus_sd / case.modulus) ** 2)))
    parameters = (
        *rows,
        LawParameter("modulus", "Pa", case.modulus, spread),
        # Its deviation belongs to the effect `scale_cut`, not to the base.
        LawParameter("shortest_wave", "m", case.surface.shortest, 0.0, per_cut=1.0),
    )
    columns = np.stack([drawn[0], *shapes, by_modulus, by_cut], axis=-1)
    applies = shares[chosen] == 1.0
    short = case.surface.longest < CONTACT.wave_share * math.sqrt(case.area)
    return MeasuredPreloadLaw(
        parameters,
        CubicSpline(grid, columns),
        poisson,
        chosen.value,
        CONTACT.applying_factor_sd if applies else CONTACT.outside_factor_sd,
        case.height if short else None,
    )


def applying_shares(
    case: MeasuredCase, log_range: tuple[float, float]
) -> dict[MeasuredLaw, float]:
    """Return the share of the preloads that the range of each law holds.

    Args:
        case: surfaces, materials, apparent area.
        log_range: smallest and largest ln P of the states [ln N].
    """
    pressure = np.exp(np.linspace(*log_range, CONTACT.range_points)) / case.area
    curves = {c.law: c for c in predict_measured(case, pressure)}
    return {law: _share(curves[law]) for law in _ORDER}


def _share(curve: LawCurve) -> float:
    return float(np.mean([not reasons for reasons in curve.outside]))


def _log_stiffness(
    case: MeasuredCase, law: MeasuredLaw, log_preload: FloatArray
) -> FloatArray:
    """Return ln k of the best estimate and of each draw, shape (1 + n_draws, n)."""
    pressure = np.exp(log_preload) / case.area
    count = case.surface.variance.shape[0]
    modulus, hardness = (np.full(count, v) for v in (case.modulus, case.hardness))
    if law is MeasuredLaw.PERSSON:
        found = persson_state(case.surface, pressure, modulus, hardness).stiffness
    else:
        state = (
            greenwood_williamson
            if law is MeasuredLaw.GREENWOOD_WILLIAMSON
            else bush_gibson_thomas
        )
        found = state(line_moments(case.surface), pressure, modulus).stiffness
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(found * case.area))


def _principal(
    drawn: FloatArray, grid: FloatArray, log_range: tuple[float, float]
) -> tuple[list[LawParameter], list[FloatArray]]:
    """Return the principal directions in which draws of the surface change ln k.

    A coordinate is a change of ln k of that size, by root mean square over the states.
    """
    inside = (grid >= log_range[0] - 0.5) & (grid <= log_range[1] + 0.5)
    off = drawn[1:] - drawn[1:].mean(axis=0)
    _, size, shape = np.linalg.svd(off[:, inside], full_matrices=False)
    rows, shapes = [], []
    for k in range(min(CONTACT.surface_directions, size.size)):
        sd = float(size[k] / np.sqrt(off.shape[0] * inside.sum()))
        if sd < CONTACT.least_surface_sd:
            break
        # Regression of all points on the score of each draw extends the shape.
        score = off[:, inside] @ shape[k] / np.sqrt(inside.sum())
        rows.append(LawParameter(f"surface_{k + 1}", "-", 1.0, sd))
        shapes.append(score @ off / (score @ score))
    return rows, shapes
