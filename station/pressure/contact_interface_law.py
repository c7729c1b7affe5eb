# SPDX-License-Identifier: MIT
"""The law of a joint's surfaces as [pressure] and [contact] of a model give it."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.contact_case import ContactCase, ContactConditions
from jointbench.analysis.contact.damping import DampingChoice
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.predict import predict_contact
from jointbench.analysis.contact.torque_to_preload import Preload
from jointbench.analysis.contact.uncertainty import predict_uncertainty
from jointbench.analysis.structures.pressure.interface_law import (
    InterfaceLaw,
    law_of_loads,
)
from jointbench.analysis.structures.pressure.joint_pressure import LawAt
from jointbench.station.joints.structure_contact import theory_surface
from jointbench.station.joints.structure_model import StructureModel

_NORMAL_SD = 2 * 1.96


def law_of_model(settings: StructureModel, folder: Path) -> LawAt:
    """Return the law of a model's joint.

    Args:
        settings: with [pressure], and [contact] where that holds no law.
        folder: of the model; surface files are relative to it.

    Raises:
        BadData: neither is there, or the reference area is missing.
    """
    table = settings.pressure
    assert table is not None
    if table.law is not None:
        power = table.law.power(table.frequency)
        return lambda pressures, _: power.law(pressures)
    contact, area = settings.contact, table.reference_area
    if contact is None:
        raise BadData(
            "[pressure] has no law: give [pressure.law] with stiffness, area, pressure "
            "and exponent, or a table [contact] and pressure.reference_area"
        )
    if area is None:
        raise BadData(
            "the laws of [contact] depend on the load alone: give the area within "
            "which the surface was measured, e.g. pressure.reference_area = '1 mm^2'"
        )
    surface = theory_surface(contact, folder, [], [])
    conditions = ContactConditions(
        contact.material,
        hardness_sd=contact.hardness_sd * contact.hardness,
        damping=DampingChoice(frequency=table.frequency),
    )
    model = contact_model(contact.models[0], contact.mode)

    def case(load: float) -> ContactCase:
        return ContactCase(model, surface, Preload(load, 0.0), conditions)

    def at_load(load: float) -> tuple[float, float, float]:
        state = predict_contact(case(load))
        return state.normal_stiffness, state.tangential_stiffness, state.damping or 0.0

    def law(pressures: FloatArray, factor: float) -> InterfaceLaw:
        middle = float(np.sqrt(pressures[0] * pressures[-1])) * area * factor
        interval = predict_uncertainty(case(middle)).stiffness.interval
        spread = float(np.log(interval.upper / interval.lower)) / _NORMAL_SD
        said = f"{model.name}, k = K(p A) / A with reference area A = "
        return law_of_loads(
            pressures,
            area * factor,
            at_load,
            log_sd=spread,
            source=said + f"{1e6 * area * factor:.3g} mm^2",
        )

    return law
