# SPDX-License-Identifier: MIT
"""Printed formulas of 2023 and 2025, beside the same laws summed right."""

import math

import numpy as np
from printed_entries import (
    ELASTIC,
    PLASTIC,
    STAGE_1,
    STAGE_2,
    material_of,
    mended,
    surface_of,
)
from scipy.integrate import quad

from jointbench.analysis.contact.asperity import (
    asperity_load,
    asperity_stiffness,
    interference,
    log_critical_area,
)
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.joint_sums import joint_sums, power_integral
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model


def area_between(i, population, *, above_critical=False):
    """Integrate a n(a) of eq. (6) from 0 or a_c to a_l."""
    q = (i["D"] - 1) / 2
    lowest = math.log(i["ac"]) if above_critical else -2000.0
    area = power_integral(np.array(1 - q), np.array(lowest), np.log(i["al"]))
    return population * q * i["al"] ** q * float(area)


def eq_32(entry):
    """Return the entry's value times our own dP/d(delta) over eq. (32) at s = 3.

    The table leaves the state out; the identity holds at any.
    """
    i, s, factor = entry["inputs"], 3.0, 0.5565
    model = contact_model("ke_2d")
    material = ContactMaterial(i["E"], i["H"], 0.25)
    at = log_critical_area(model, surface_of(i), material) - math.log(s) / (i["D"] - 1)
    own = float(asperity_stiffness(model, surface_of(i), material, at))
    depth = float(interference(model, surface_of(i), np.exp(at)))
    radius, critical = math.exp(at) / (math.pi**2 * depth), depth / s
    area = 0.93 * math.pi * radius * critical * s**1.136
    printed = 2 / 3 * factor * i["H"] * 1.03 * 1.425 / 0.93 * area * s**-0.711
    return entry["printed"] * own / (printed / critical)


def elastic_4(i):
    """Return the load of eq. (4), which is that of a profile of D - 1."""
    model = contact_model("modified_2d", "as-printed")
    hard = np.array(1e3 * i["H"])  # so that the contact is elastic
    surface = FractalSurface(np.array(i["D"] - 1), np.array(i["G"]), hard)
    material = ContactMaterial(i["E"], i["H"], 0.25)
    return float(asperity_load(model, surface, material, np.log(i["al"])))


def collided(entry, regime, power):
    """Return the stage with the hardness factor k taken for the stiffness k_e."""
    i = entry["inputs"]
    model = contact_model("modified_2d", "as-printed")
    surface, material = surface_of(i), material_of(i)
    bounds = {STAGE_1: (1, 6), STAGE_2: (6, 110)}[regime]
    low, high = (
        math.log(i["ac"]) - math.log(bound) / (i["D"] - 1) for bound in bounds[::-1]
    )

    def integrand(log_area):
        stiffness = float(
            asperity_stiffness(model, surface, material, np.array(log_area))
        )
        read = math.sqrt(3) / 2 * i["E"] * math.exp(log_area / 2)
        number = math.exp(i["D"] / 2 * (math.log(i["al"]) - log_area))
        return stiffness * read**power * number

    return i["D"] / 2 * quad(integrand, low, high, epsabs=0, epsrel=1e-11)[0]


def radius_39(i):
    """Return R = a/(pi delta) at the largest area."""
    model = contact_model("ke_3d")
    return i["al"] / (math.pi * float(interference(model, surface_of(i), i["al"])))


def state_of_2025(i):
    """Return the entry with the critical area of its own paper, yield as in CEB.

    The table lists that of the 2023 model beside them; at D = 2.1 a_l is three a_c.
    """
    model = contact_model("ke_3d_modified", "as-printed")
    material = ContactMaterial(i["E"], i["H"], 0.25)
    critical = math.exp(float(log_critical_area(model, surface_of(i), material)))
    return i | {"ac": critical, "al": 3 * critical if i["D"] < 2.2 else i["al"]}


def of_8(entry, regime):
    """Return a term of eq. (8) by the sums."""
    i = state_of_2025(entry["inputs"])
    model = contact_model("ke_3d_modified", "as-printed")
    material = ContactMaterial(i["E"], i["H"], 0.25)
    sums = joint_sums(model, surface_of(i), material, np.log(i["al"]))
    return float(sums.stiffness[regime])


def sums_of(quantity, regime):
    """Return a check that reads one part of the mended sums."""
    return lambda e: float(getattr(mended(e["inputs"]), quantity)[regime])


def area_41(e):
    """Return the critical area of the mended model."""
    return float(mended(e["inputs"]).critical_area)


FORMULAS = {
    "S0.eq23": area_41,
    "S0.eq24": sums_of("load", ELASTIC),
    "S0.eq26 Pe1": sums_of("load", STAGE_1),
    "S0.eq27 Pe2": sums_of("load", STAGE_2),
    "S0.eq28": sums_of("load", PLASTIC),
    "S0.eq31": sums_of("stiffness", ELASTIC),
    "S0.eq32": eq_32,
    "S0.eq33 K1 as printed vs": lambda e: collided(e, STAGE_1, 0.15),
    "S0.eq33 K1": sums_of("stiffness", STAGE_1),
    "S0.eq35 K2 print coef": lambda e: collided(e, STAGE_2, 0.528),
    "S0.eq35 K2": sums_of("stiffness", STAGE_2),
    "S0.eq39": lambda e: radius_39(e["inputs"]),
    "S0.eq41": area_41,
    "S0.eq42 Pe1 vs corrected": sums_of("load", STAGE_1),
    "S1.eq8 term1": lambda e: of_8(e, ELASTIC),
    "S1.eq8 term2": lambda e: of_8(e, STAGE_1),
    "S1.eq8 term3": lambda e: of_8(e, STAGE_2),
    "S1.eq7 Ar=": lambda e: area_between(state_of_2025(e["inputs"]), 0.5),
    "S1.eq7 Ar print vs int": lambda e: area_between(
        state_of_2025(e["inputs"]), 0.5, above_critical=True
    ),
    "S1.eq7 Ar print vs norm": lambda e: area_between(state_of_2025(e["inputs"]), 1.0),
    "S1.eq4": lambda e: elastic_4(state_of_2025(e["inputs"])),
}
