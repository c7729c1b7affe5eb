# SPDX-License-Identifier: MIT
"""Contact cases from plain numbers, with the dimension as the model wants it."""

from typing import Any

from jointbench.analysis.contact.contact_case import ContactCase, ContactConditions
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.models import ContactModel, Mode
from jointbench.analysis.contact.spread import ContactSpread
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.analysis.contact.torque_to_preload import Preload

KNOWN_EXACTLY = ContactSpread()


def joint_case(
    model: str | ContactModel,
    *,
    dimension: float,
    roughness: float,
    material: ContactMaterial,
    preload: float,
    spread: ContactSpread = KNOWN_EXACTLY,
    mode: str = Mode.CORRECTED,
    gamma: float = 1.5,
    **conditions: Any,
) -> ContactCase:
    """Return one case; `conditions` are fields of `ContactConditions`."""
    record = contact_model(model, mode) if isinstance(model, str) else model
    of_line = dimension - (record.topography.lowest_dimension - 1)
    return ContactCase(
        record,
        ContactSurface(of_line, roughness, spread),
        Preload(preload, spread.preload),
        ContactConditions(
            material,
            hardness_sd=spread.hardness,
            friction_factor_sd=spread.friction,
            **conditions,
        ),
        gamma=gamma,
    )
