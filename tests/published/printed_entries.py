# SPDX-License-Identifier: MIT
"""The formula sheet: its entries, and what they stand for in our own words."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from jointbench.analysis.contact import printed_formulas_2023 as eq
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.joint_sums import joint_sums
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model

TABLE = Path(__file__).parents[3] / "shared" / "design" / "physics_checks.json"
ENTRIES = (
    [e for e in json.loads(TABLE.read_text()) if e["kind"] != "monte-carlo"]
    if TABLE.exists()
    else []
)
PLASTIC, STAGE_2, STAGE_1, ELASTIC = range(4)


def symbols(i):
    """Return the paper's symbols with k = 1, as the table drops its extra powers."""
    phi = i.get("phi", i["H"] / i["E"])
    k_mu, gamma = i.get("kmu", 1.0), i.get("gamma", 1.5)
    return eq.PrintedInputs(
        i["D"], i["G"], i["E"], i["H"], 1.0, phi, k_mu, gamma, i["al"], i["ac"]
    )


def surface_of(i):
    """Return the entry's surface."""
    return FractalSurface(np.array(i["D"]), np.array(i["G"]), np.array(i["H"]))


def mended(i, **changes):
    """Return the sums of the paper's own laws at the entry's largest area."""
    name = "modified_2d" if i["D"] < 2 else "friction_3d"
    model = replace(contact_model(name, "as-printed"), **changes)
    return joint_sums(model, surface_of(i), material_of(i), np.log(i["al"]))


def material_of(i):
    """Return the entry's material: yield strength from phi, or from kappa in 3D."""
    if "kap" in i and i.get("D", 3) > 2:
        strength = i["kap"] * 40 / (33 * math.pi) * i["E"]
        return ContactMaterial(i["E"], i["H"], 0.25, yield_strength=strength)
    strength = i["phi"] * i["E"] if "phi" in i else None
    return ContactMaterial(
        i["E"], i["H"], 0.25, yield_strength=strength, friction_factor=i.get("kmu", 1.0)
    )


def known(table, name):
    """Return the value under the longest key that begins `name`."""
    keys = [key for key in table if name.startswith(key)]
    return table[max(keys, key=len)] if keys else None
