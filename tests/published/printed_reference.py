# SPDX-License-Identifier: MIT
"""States of the reference model: areas, parts, energies, maxima."""

import math
from dataclasses import replace

import numpy as np
from printed_entries import (
    material_of,
    surface_of,
)
from scipy.optimize import minimize_scalar

from jointbench.analysis.contact.asperity_laws import FullyPlastic
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.energy import joint_energy, two_regime_energy
from jointbench.analysis.contact.model_catalogue import PRINTED_STAGE_2, contact_model
from jointbench.analysis.contact.models import Interaction

SEED = {"hertz": Interaction.NONE, "seed": Interaction.AS_PRINTED}
SEED["consistent"] = Interaction.SELF_CONSISTENT


def in_reference(i, interaction, name=None, load=None, **changes):
    """Return the sums of the reference model, which predates the pinned one."""
    name = name or ("modified_2d" if i["D"] < 2 else "friction_3d")
    second = {1.236: PRINTED_STAGE_2}.get(i["m2"], contact_model("ke_2d").second)
    model = replace(
        contact_model(name),
        interaction=interaction,
        second=second,
        plastic=FullyPlastic(1.0),
        population=i.get("f", 1.0),
        **changes,
    )
    material = material_of(i)
    return contact_curve(
        model,
        dimension=i["D"],
        roughness=i["G"],
        material=material,
        preload=i["P"] if load is None else load,
        gamma=i.get("gamma", 1.5),
    )


def reference_state(entry, interaction):
    """Return areas, parts and real area as the table lists them."""
    sums = in_reference(entry["inputs"], interaction)
    return {
        "al": float(sums.largest_area),
        "ac": float(sums.critical_area),
        "P": sums.load,
        "K": sums.stiffness,
        "Ar": float(sums.real_area),
    }


def reference_curve(entry, interaction):
    """Return stiffness at three loads and the critical area."""
    loads = np.array([1e2, 1e3, 1e4])
    sums = in_reference(entry["inputs"], interaction, load=loads)
    return {"K": sums.stiffness.sum(axis=0), "ac": float(sums.critical_area[0])}


def marble(entry):
    """Return the plate rig's stiffness in the reference model."""
    plane = "2D" in entry["name"]
    extra = {"D": 1.5404 if plane else 2.5404, "G": 9.497e-12, "E": 55e9 / 1.875}
    i = entry["inputs"] | extra
    sums = in_reference(i, SEED[i["elastic"]])
    return float(sums.stiffness.sum())


def dissipation(entry):
    """Return the energies with full plasticity as 2 pi R delta H, whatever a is.

    The table's quadrature begins at 1e-12 of the area where full plasticity does;
    what is below is taken off.
    """
    i = entry["inputs"]
    name = "modified_2d" if i["D"] < 2 else "friction_3d"
    model = contact_model(name)
    flowing = FullyPlastic(2 * math.pi / model.topography.shape)
    model = replace(model, interaction=Interaction.NONE, plastic=flowing)
    sums = in_reference(i, Interaction.NONE)
    e = i["D"] - model.topography.lowest_dimension
    whole = np.log(float(sums.largest_area))
    cut = math.log(1e-12 * float(sums.critical_area)) - math.log(110) / e
    surface, material = surface_of(i), material_of(i)
    energies = [
        joint_energy(model, surface, material, np.array(log_area))
        for log_area in (whole, cut)
    ]
    # The same contacts, counted as the larger joint counts them.
    weights = (1.0, -math.exp((1 + e) / 2 * (whole - cut)))
    stored, lost = (
        sum(
            w * float(getattr(one, part).sum())
            for w, one in zip(weights, energies, strict=True)
        )
        for part in ("recovered", "dissipated")
    )
    found = {"We": stored, "Wd": lost, "eta": lost / stored}
    if "eta_std" in entry["derived"]:
        found["eta_std"] = lost / (2 * math.pi * (stored + lost))
    return found


def best_dimension(entry):
    """Return the dimension at which the reference model is stiffest."""
    i = entry["inputs"]
    low = i["dim"] - 1

    def softness(dimension):
        state = i | {"D": dimension}
        if low == 2:
            state["kap"] = 33 * math.pi / 40 * 0.95 * i["H"] / 2.8 / i["E"]
        sums = in_reference(state, SEED[i["elastic"]])
        return -math.log(float(sums.stiffness.sum()))

    options = {"xatol": 1e-7}
    span = (low + 0.6, low + 0.95)
    return minimize_scalar(softness, bounds=span, method="bounded", options=options).x


def two_regimes(entry):
    """Return stored and lost energy of the two-regime form."""
    i = entry["inputs"]
    model = replace(contact_model("modified_2d"), interaction=Interaction.NONE)
    surface = surface_of(i)
    return two_regime_energy(model, surface, material_of(i), np.log(i["al"]))


STATES = {
    "ref 2D seed-elastic": lambda e: reference_state(e, Interaction.AS_PRINTED),
    "ref 2D hertz": lambda e: reference_state(e, Interaction.NONE),
    "ref 3D seed": lambda e: reference_curve(e, Interaction.AS_PRINTED),
    "ref 3D hertz": lambda e: reference_curve(e, Interaction.NONE),
    "ref 3D consistent": lambda e: reference_curve(e, Interaction.SELF_CONSISTENT),
    "marble K": marble,
    "ref damping": dissipation,
    "D of maximum": best_dimension,
    "We elastic": lambda e: two_regimes(e)[0],
    "Wp plastic": lambda e: two_regimes(e)[1],
}
