# SPDX-License-Identifier: MIT
"""Single printed numbers: jumps of laws, the rig, the five fits, Mindlin."""

import math
from dataclasses import replace

import numpy as np
from printed_entries import (
    ELASTIC,
    material_of,
    surface_of,
)

from jointbench.analysis.contact.asperity import asperity_load, log_critical_area
from jointbench.analysis.contact.asperity_laws import FullyPlastic
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.damping import damping_ratio
from jointbench.analysis.contact.material import ContactMaterial, effective_modulus
from jointbench.analysis.contact.model_catalogue import PRINTED_STAGE_2, contact_model
from jointbench.analysis.contact.models import interaction_share
from jointbench.analysis.contact.tangential import (
    contact_shear,
    tangential_stiffness,
)
from jointbench.analysis.contact.torque_to_preload import preload_from_torque
from jointbench.analysis.lumped.lumped_model import Body, Link, LumpedModel
from jointbench.analysis.lumped.lumped_modes import solve_modes
from jointbench.signal.fractal.fractal_fit import fractal_from_line

LINES = (
    (0.738, -15.149),
    (0.903, -12.050),
    (1.083, -9.771),
    (0.6741, -16.12),
    (1.198, -7.781),
)


def natural_frequency(i, damping=0.0):
    """Return the frequency of one mass on the identified stiffness."""
    links = (Link("joint", ("ground", "plate"), i["K"], damping),)
    return solve_modes(LumpedModel((Body("plate", i["M"]),), links)).natural_frequency[
        0
    ]


def jump_at_110(name, pressure_factor):
    """Return fully plastic load over the second stage's at their common bound."""
    flowing = FullyPlastic(pressure_factor)
    model = replace(contact_model(name), plastic=flowing)
    low = model.topography.lowest_dimension
    i = {"D": low + 0.5, "G": 1e-9, "E": 69.3e9, "H": 2.265336e9}
    surface, material = surface_of(i), ContactMaterial(i["E"], i["H"], 0.25)
    edge = log_critical_area(model, surface, material) - math.log(110) / 0.5
    below = asperity_load(model, surface, material, edge - 1e-12)
    return float(below / asperity_load(model, surface, material, edge + 1e-12))


def jump_at_6(second):
    """Return second-stage over first-stage load at six times the critical depth."""
    model = replace(contact_model("ke_2d"), second=second)
    i = {"D": 1.5, "G": 1e-9, "E": 69.3e9, "H": 2.265e9}
    surface, material = surface_of(i), material_of(i)
    edge = log_critical_area(model, surface, material) - math.log(6) / 0.5
    below = asperity_load(model, surface, material, edge - 1e-12)
    return float(below / asperity_load(model, surface, material, edge + 1e-12))


def roughnesses(constant="as-printed"):
    """Return G of the five printed lines."""
    found = [fractal_from_line(*line, constant=constant) for line in LINES]
    return np.array([one.roughness for one in found])


def shear_check(e):
    """Return the stiffness of one contact in partial slip."""
    i = e["inputs"]
    return contact_shear(
        i["x"], radius=i["r"], shear=i["Gp"], preload=i["P"], friction=i["mu"]
    )[1]


def no_slip_ratio(e):
    """Return tangential over normal stiffness of elastic Hertz contacts."""
    material = ContactMaterial(69.3e9, 2.265e9, e["inputs"]["nu"])
    sums = contact_curve(
        "ke_3d", dimension=2.5, roughness=1e-10, material=material, preload=1e3
    )
    tangential = tangential_stiffness(contact_model("ke_3d"), sums, material)
    return float(tangential / sums.stiffness[ELASTIC])


def share_of(name):
    """Return the share of interference that an interacting asperity keeps."""
    return interaction_share(contact_model(name))


NUMBERS = {
    "E_composite": lambda e: effective_modulus(130e9, 0.25, 130e9, 0.25),
    "interaction x, a=pi R d": lambda e: share_of("ke_3d_modified"),
    "interaction x, a=pi^2": lambda e: share_of("modified_2d"),
    "KE jump at s=6 exponent 1.236": lambda e: jump_at_6(PRINTED_STAGE_2),
    "KE jump at s=6 exponent 1.263": lambda e: jump_at_6(contact_model("ke_2d").second),
    "k_e coefficient": lambda e: 2 * math.sqrt(share_of("ke_3d_modified") / math.pi),
    "marble composite": lambda e: effective_modulus(55e9, 0.25, 55e9, 0.25),
    "preload": lambda e: preload_from_torque(20.0, diameter=0.016, bolts=4).value,
    "plate mass": lambda e: 0.5 * 0.3 * 0.05 * 2600,
    "marble zeta": lambda e: damping_ratio(
        e["inputs"]["c"], e["inputs"]["K"], e["inputs"]["M"]
    ),
    "marble f": lambda e: natural_frequency(e["inputs"]),
    "mean 2D D": lambda e: np.mean(
        [fractal_from_line(*line, constant="as-printed").dimension for line in LINES]
    ),
    "mean G (arith)": lambda e: roughnesses().mean(),
    "mean G geometric": lambda e: np.exp(np.log(roughnesses()).mean()),
    "median G": lambda e: np.median(roughnesses()),
    "mean G if": lambda e: roughnesses("corrected").mean(),
    "Kt/Kn": no_slip_ratio,
    "Mindlin kt": shear_check,
    "universal": lambda e: 1.0,
    "plastic/EP2 load jump at s=110: 2D": lambda e: jump_at_110("modified_2d", 1.0),
    "plastic/EP2 load jump at s=110: 3D CEB K=.5565, P=Ha": lambda e: jump_at_110(
        "ke_3d", 1.0
    ),
    "plastic/EP2 load jump at s=110: 3D CEB, P=2Ha": lambda e: jump_at_110(
        "ke_3d", 2.0
    ),
    "plastic/EP2 load jump at s=110: 3D 33/40, H": lambda e: jump_at_110(
        "friction_3d", 1.0
    ),
    "plastic/EP2 load jump at s=110: 3D 33/40, P": lambda e: jump_at_110(
        "friction_3d", 2.0
    ),
}
