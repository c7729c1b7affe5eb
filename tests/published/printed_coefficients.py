# SPDX-License-Identifier: MIT
"""Coefficients of printed formulas, asked of quadrature and of the sums."""

import math

import numpy as np
from printed_entries import (
    ELASTIC,
    ENTRIES,
    STAGE_1,
    STAGE_2,
    mended,
    surface_of,
    symbols,
)
from scipy.integrate import quad

from jointbench.analysis.contact import printed_formulas_2023 as eq
from jointbench.analysis.contact.asperity import interference
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.joint_sums import joint_sums
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model

FIRST, SECOND = (1.425, 1.03), (1.236, 1.40)
EARLY, LATE = (1, 6), (6, 110)


def seed_choice(i, law, lower, upper):
    """Sum a law of the 3D model over the 2D distribution and 2D bounds of ch. 4."""
    model = contact_model("friction_3d", "as-printed")
    q, e = i["D"] / 2, i["D"] - 1
    critical = math.log(i["ac"])
    span = critical - math.log(upper) / e, critical - math.log(lower) / e

    def integrand(log_area):
        # The stage's own law holds on the wrong interval too: taken at its anchor.
        return law(model, i, log_area) * math.exp(q * (math.log(i["al"]) - log_area))

    return q * quad(integrand, *span, epsabs=0, epsrel=1e-11)[0]


def stage(exponent, coefficient, *, stiffness):
    """Return a Kogut-Etsion stage of the 3D geometry, whatever the regime."""

    def law(model, i, log_area):
        area = math.exp(log_area)
        depth = float(interference(model, surface_of(i), np.array(area)))
        radius = area / (math.pi * depth)
        kappa = 33 * math.pi * i["kmu"] * i["phi"] / 40
        critical = kappa**2 * radius
        load = 4 / 3 * i["E"] * radius**0.5 * critical**1.5
        load *= coefficient * (depth / critical) ** exponent
        return exponent * load / depth if stiffness else load

    return law


def at_one_state(coefficient, formula, regime, quantity="load", **options):
    """Return the coefficient that the mended sum asks of a printed formula."""
    i = {"D": 1.4, "G": 1e-10, "E": 69.3e9, "H": 2.265e9, "al": 1e-7}
    i["ac"] = float(mended({**i, "ac": 0.0}).critical_area)
    part = getattr(mended(i), quantity)[regime]
    return coefficient * float(part) / formula(symbols(i), **options)


def without_collision(regime, unit):
    """Return the mended coefficient of eq. (33) or (35), in the print's own form."""
    D, G, E, H, al = 1.4, 1e-10, 69.3e9, 2.265e9, 1e-7
    i = {"D": D, "G": G, "E": E, "H": H, "al": al}
    sums = mended({**i, "ac": 0.0})
    return float(sums.stiffness[regime]) / unit(
        D, G, E, H, al, float(sums.critical_area)
    )


def unit_33(D, G, E, H, al, ac):
    """What multiplies 19.57 in the mended eq. (33)."""
    scale = 2**0.85 * D * E**0.85 * G ** (0.15 * (1 - D)) * H**0.15 * al ** (D / 2)
    scale *= (6**0.425 - 1) * ac ** (0.425 * (1 - D))
    return scale / (17 * (D - 1) * math.pi)


def unit_35(D, G, E, H, al, ac):
    """What multiplies 144.2 in the mended eq. (35)."""
    scale = 2**0.472 * D * E**0.472 * G ** (0.528 * (1 - D)) * H**0.528
    scale *= al ** (D / 2) * (110**0.236 - 6**0.236) * ac ** (0.236 * (1 - D))
    return scale / (59 * (D - 1) * math.pi)


def coefficient_3d(printed, formula, law, bounds, **options):
    """Return the coefficient that quadrature asks of a printed formula of ch. 4."""
    i = next(e["inputs"] for e in ENTRIES if "eq42" in e["name"] and e["inputs"])
    return printed * seed_choice(i, law, *bounds) / formula(symbols(i), **options)


def mended_46(i):
    """Return eq. (46) with the denominator 59 D + 7 and the logarithm restored."""
    return seed_choice(i, stage(*SECOND, stiffness=True), 6, 110)


def of_2025(regime, printed, unit):
    """Return the coefficient that eq. (8)'s own laws ask in one of its terms."""
    D, G, E, H, lg, k = 2.4, 1e-9, 69.3e9, 2.265e9, math.log(1.5), 0.5565
    model = contact_model("ke_3d_modified", "as-printed")
    surface = FractalSurface(np.array(D), np.array(G), np.array(H))
    sums = joint_sums(model, surface, ContactMaterial(E, H, 0.25), np.log(1.0))
    ac = float(sums.critical_area)
    return float(sums.stiffness[regime]) / unit(D, G, E, H, ac, lg, k)


def term_1(D, G, E, H, ac, lg, k):
    """First term of eq. (8) at a_l = 1 m^2, without its coefficient."""
    return E * (D - 1) * ac ** (1 - D / 2) / (D - 2) * (1 - ac ** ((D - 2) / 2))


def term_2(D, G, E, H, ac, lg, k):
    """Second term of eq. (8) at a_l = 1 m^2, without its coefficient."""
    top = 2 ** (0.225 * D + 0.45) * E**0.85 * G ** (0.3 - 0.15 * D) * H**0.15
    top *= ac ** (0.85 - 0.425 * D) * k**0.15 * (D - 1)
    return top / (math.pi ** (0.075 * D + 0.2) * lg**0.075 * (D - 2))


def term_3(D, G, E, H, ac, lg, k):
    """Third term of eq. (8) at a_l = 1 m^2, without its coefficient."""
    top = 2 ** (0.792 * D + 0.568) * E**0.472 * G ** (1.056 - 0.528 * D) * H**0.528
    top *= ac ** (0.472 - 0.236 * D) * k**0.528 * math.pi ** (0.556 - 0.264 * D)
    return top * (D - 1) / (lg**0.264 * (D - 2))


def quadrature_of(law, bounds, *, stiffness):
    """Return a check that sums a stage over the distribution of a profile."""
    return lambda e: seed_choice(e["inputs"], stage(*law, stiffness=stiffness), *bounds)


COEFFICIENTS = {
    "S0.eq26 coef": lambda e: at_one_state(24.7543, eq.first_stage_load_2d, STAGE_1),
    "S0.eq27 coef": lambda e: at_one_state(
        161.8203, eq.second_stage_load_2d, STAGE_2, exponent_of_roughness=0.472
    ),
    "S0.eq33 coef 17": lambda e: without_collision(STAGE_1, unit_33) * 4**-0.075,
    "S0.eq33 coef, corrected": lambda e: without_collision(STAGE_1, unit_33),
    "S0.eq35 coef 161": lambda e: without_collision(STAGE_2, unit_35) * 4**-0.264,
    "S0.eq35 coef vs": lambda e: without_collision(STAGE_2, unit_35),
    "S0.eq42 coef": lambda e: coefficient_3d(
        15.7636, eq.first_stage_load_3d, stage(*FIRST, stiffness=False), EARLY
    ),
    "S0.eq43 coef": lambda e: coefficient_3d(
        6.8692, eq.second_stage_load_3d, stage(*SECOND, stiffness=False), LATE
    ),
    "S0.eq45 coef": lambda e: coefficient_3d(
        12.9865,
        eq.first_stage_stiffness_3d,
        stage(*FIRST, stiffness=True),
        EARLY,
        exponent_of_area=0.425,
    ),
    "S0.eq46 coef": lambda e: coefficient_3d(
        24.4098,
        lambda p: (
            eq.second_stage_stiffness_3d(p)
            * (p.D - 2)
            / (59 * p.D + 7)
            * math.log(p.gamma) ** -0.264
        ),
        lambda *a: 250 * 0.004 * stage(*SECOND, stiffness=True)(*a),
        LATE,
    ),
    "S1.eq8 coef 0.433": lambda e: of_2025(ELASTIC, 0.433, term_1),
    "S1.eq8 coef 0.4894": lambda e: of_2025(STAGE_1, 0.4894, term_2),
    "S1.eq8 coef 0.2301": lambda e: of_2025(STAGE_2, 0.2301, term_3),
    "S0.eq42 Pe1 vs quad": quadrature_of(FIRST, EARLY, stiffness=False),
    "S0.eq43": quadrature_of(SECOND, LATE, stiffness=False),
    "S0.eq45": quadrature_of(FIRST, EARLY, stiffness=True),
    "S0.eq46 K2": quadrature_of(SECOND, LATE, stiffness=True),
}
