# SPDX-License-Identifier: MIT
"""Printed formulas of the papers compared with the correct sums."""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact import printed_formulas_2023 as eq
from jointbench.analysis.contact.asperity_laws import REGIMES, Regime
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.joint_sums import joint_sums
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.models import ContactModel, Mode

_STAGE_1, _STAGE_2 = Regime.ELASTIC_PLASTIC_1, Regime.ELASTIC_PLASTIC_2


@dataclass(frozen=True, slots=True)
class PrintedTerm:
    """One printed formula at one state of a joint.

    Attributes:
        equation: number in Appl. Sci. 2023, 13, 11680.
        quantity: ``"load"``, ``"stiffness"`` or ``"critical area"``.
        regime: that it sums over; None for an area.
        printed: its value [N, N/m or m^2, for any dimensions of the formula].
        mended: correct sum of the paper's laws, same state and unit.
        fault: what is wrong with it; empty where it is right.
    """

    equation: int
    quantity: str
    regime: Regime | None
    printed: float
    mended: float
    fault: str

    @property
    def factor(self) -> float:
        """Printed over mended [-]; 0 for an empty sum."""
        return self.printed / self.mended if self.mended else 0.0


_Formula = Callable[[eq.PrintedInputs], float]
_EXTRA_K = "an extra power of k = H/sigma_y, right only if k is the factor of CEB"
_WRONG_3D = "the 2D area distribution and bounds 1/(D-1) where 3D asks 1/(D-2)"
_ROWS: dict[str, tuple[tuple[int, str, Regime | None, _Formula, str], ...]] = {
    "modified_2d": (
        (23, "critical area", None, eq.critical_area_2d, ""),
        (
            24,
            "load",
            Regime.ELASTIC,
            eq.elastic_load_2d,
            "R(a) is taken out of the integral; E and D are missing and restored here",
        ),
        (26, "load", _STAGE_1, eq.first_stage_load_2d, _EXTRA_K),
        (
            27,
            "load",
            _STAGE_2,
            eq.second_stage_load_2d,
            f"exponent .8472 of G for .472, no force; {_EXTRA_K}",
        ),
        (
            28,
            "load",
            Regime.PLASTIC,
            eq.plastic_load_2d,
            "110 is inside the power of the area, and D - 2 for 2 - D: negative",
        ),
        (31, "stiffness", Regime.ELASTIC, eq.elastic_stiffness, ""),
        (
            33,
            "stiffness",
            _STAGE_1,
            eq.first_stage_stiffness_2d,
            "the hardness factor k was read as the stiffness k_e: unit (N/m)^1.15",
        ),
        (
            35,
            "stiffness",
            _STAGE_2,
            eq.second_stage_stiffness_2d,
            "k was read as the stiffness k_e, and the coefficient is eq. (27)'s",
        ),
    ),
    "friction_3d": (
        (41, "critical area", None, eq.critical_area_3d, "pi is counted twice"),
        (42, "load", _STAGE_1, eq.first_stage_load_3d, _WRONG_3D),
        (43, "load", _STAGE_2, eq.second_stage_load_3d, _WRONG_3D),
        (
            31,
            "stiffness",
            Regime.ELASTIC,
            eq.elastic_stiffness,
            "the 2D area distribution with the D of a surface",
        ),
        (
            45,
            "stiffness",
            _STAGE_1,
            eq.first_stage_stiffness_3d,
            f".175 D for .425 D; {_WRONG_3D}",
        ),
        (
            46,
            "stiffness",
            _STAGE_2,
            eq.second_stage_stiffness_3d,
            f"D - 2 for 59 D + 7, ln(gamma)^-.264 missing; {_WRONG_3D}",
        ),
    ),
}
_CHOICES = {
    "elastic": "MB's own load and stiffness take a = pi r^2 in a geometry of pi^2",
    "second": "exponent 1.236 for Kogut and Etsion's 1.263 in the second stage",
    "plastic": "full plasticity bears H a, but a is half the truncated area in 3D",
    "interaction": "eq. (5) k = sqrt(3)/2 E sqrt(a) and eq. (4): 3 pi/16 is no "
    "solution of eqs. (1)-(3), and k is no derivative of the load",
    "population": "eq. (6) counts half a contact of the largest area, f = 1/2",
}


def printed_terms(
    name: str,
    *,
    dimension: float,
    roughness: float,
    material: ContactMaterial,
    largest_area: float,
    gamma: float = 1.5,
    critical_area: float | None = None,
) -> tuple[PrintedTerm, ...]:
    """Evaluate the printed sums of a 2023 model, each with the corrected sum.

    Args:
        name: ``"modified_2d"`` or ``"friction_3d"``; others have no printed sums.
        dimension: of the profile or of the surface, as the model defines it [-].
        roughness: G [m].
        material: composite modulus, hardness, yield strength, friction factor.
        largest_area: a_l [m^2], above the critical area, as the paper assumes.
        gamma: of the Weierstrass-Mandelbrot function [-].
        critical_area: for the formulas [m^2]; default is the corrected one.

    Returns:
        One row for each formula; none for a model whose paper prints no such sums.

    Raises:
        BadData: a printed formula divides by zero at this dimension.
    """
    if name not in _ROWS:
        return ()
    model = contact_model(name, Mode.AS_PRINTED)
    surface = FractalSurface(
        np.array(dimension), np.array(roughness), np.array(material.hardness), gamma
    )
    mended = joint_sums(model, surface, material, np.log(largest_area))
    area = float(mended.critical_area)
    inputs = eq.printed_inputs(
        material,
        dimension=dimension,
        roughness=roughness,
        gamma=gamma,
        largest_area=largest_area,
        critical_area=critical_area or area,
    )
    by_regime = {
        "load": dict(zip(REGIMES, map(float, mended.load), strict=True)),
        "stiffness": dict(zip(REGIMES, map(float, mended.stiffness), strict=True)),
    }
    return tuple(
        PrintedTerm(
            equation,
            quantity,
            regime,
            _evaluate(formula, inputs),
            area if regime is None else by_regime[quantity][regime],
            fault,
        )
        for equation, quantity, regime, formula, fault in _ROWS[name]
    )


def printed_stiffness_parts(
    name: str,
    *,
    dimension: float,
    roughness: float,
    material: ContactMaterial,
    largest_area: float,
    gamma: float = 1.5,
) -> tuple[float, dict[Regime, float]] | None:
    """Return critical area and stiffness of each regime exactly as printed.

    Args:
        name: of the model.
        dimension: as the model defines it [-].
        roughness: G [m].
        material: composite modulus, hardness and so on.
        largest_area: a_l [m^2].
        gamma: of the Weierstrass-Mandelbrot function [-].

    Returns:
        The printed critical area [m^2], and with it the printed sums [N/m]; None where
        the model's paper prints no sums that differ from the closed form.
    """
    options = {
        "dimension": dimension,
        "roughness": roughness,
        "largest_area": largest_area,
        "gamma": gamma,
    }
    terms = printed_terms(name, material=material, **options)
    if not terms:
        return None
    area = terms[0].printed
    chained = printed_terms(name, material=material, critical_area=area, **options)
    parts = {t.regime: t.printed for t in chained if t.quantity == "stiffness"}
    return area, {regime: parts.get(regime, 0.0) for regime in REGIMES}


def printed_warnings(
    name: str,
    *,
    dimension: float,
    roughness: float,
    material: ContactMaterial,
    preload: float,
    gamma: float = 1.5,
) -> tuple[str, ...]:
    """Name each fault of a model as printed, and its size at one state.

    Args:
        name: of the model.
        dimension: as the model defines it [-].
        roughness: G [m].
        material: composite modulus, hardness and so on.
        preload: [N].
        gamma: of the Weierstrass-Mandelbrot function [-].

    Returns:
        A line for each choice of the paper, with its effect alone on K at equal
        preload, and one for each misprinted sum, with printed over corrected.
    """
    right, wrong = contact_model(name), contact_model(name, Mode.AS_PRINTED)
    state = {"dimension": dimension, "roughness": roughness, "gamma": gamma}

    def stiffness(model: ContactModel) -> float:
        sums = contact_curve(model, material=material, preload=preload, **state)
        return float(sums.stiffness.sum())

    usual = stiffness(right)
    lines = [
        f"{name} as printed: {_CHOICES[f.name]}; this alone makes K "
        f"{_size(stiffness(replace(right, **{f.name: getattr(wrong, f.name)})), usual)}"
        for f in fields(right)
        if f.name in _CHOICES and getattr(right, f.name) != getattr(wrong, f.name)
    ]
    sums = contact_curve(wrong, material=material, preload=preload, **state)
    terms = printed_terms(
        name, material=material, largest_area=float(sums.largest_area), **state
    )
    lines += [
        f"{name} as printed: eq. ({t.equation}), {t.quantity}: {t.fault}; "
        f"{t.factor:.4g} times the correct sum of the same laws"
        for t in terms
        if t.fault
    ]
    return tuple(lines)


def _size(value: float, usual: float) -> str:
    if usual > 0:
        return f"{value / usual:.4g} times"
    return f"{value:.4g} N/m instead of 0"


def _evaluate(formula: _Formula, inputs: eq.PrintedInputs) -> float:
    """Return the value of a printed formula; some divide by zero at one dimension."""
    try:
        value = formula(inputs)
    except (ZeroDivisionError, OverflowError) as error:
        raise BadData(
            f"the printed formula {formula.__name__} has no value at D = {inputs.D:g} "
            f"({error}); use mode 'corrected' or another D"
        ) from error
    if not math.isfinite(value):
        raise BadData(
            f"the printed formula {formula.__name__} gives {value:g} at D = "
            f"{inputs.D:g}; use mode 'corrected' or another D"
        )
    return value
