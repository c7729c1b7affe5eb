# SPDX-License-Identifier: MIT
"""Terms of a contact model by name, to add or remove them."""

from dataclasses import replace
from enum import StrEnum

from jointbench.analysis.contact.asperity_laws import (
    ABSENT,
    AsperityLaw,
    FullyPlastic,
    PowerLaw,
    bears_nothing,
)
from jointbench.analysis.contact.material import YieldCriterion
from jointbench.analysis.contact.model_catalogue import (
    HERTZ,
    KOGUT_ETSION_1,
    KOGUT_ETSION_2,
    PLASTIC_PROFILE,
    PLASTIC_SURFACE,
)
from jointbench.analysis.contact.models import ContactModel, Interaction
from jointbench.analysis.contact.topography import PROFILE, SURFACE


class ContactTerm(StrEnum):
    """A part of a contact model that can be added or removed."""

    ELASTIC = "elastic"
    ELASTIC_PLASTIC_1 = "elastic_plastic_1"
    ELASTIC_PLASTIC_2 = "elastic_plastic_2"
    PLASTIC = "plastic"
    INTERACTION = "interaction"
    FRICTION = "friction"
    THIRD_DIMENSION = "third_dimension"


def model_terms(model: ContactModel) -> frozenset[ContactTerm]:
    """Return the terms present in `model`."""
    present = {
        ContactTerm.ELASTIC: isinstance(model.elastic, PowerLaw),
        ContactTerm.ELASTIC_PLASTIC_1: isinstance(model.first, PowerLaw),
        ContactTerm.ELASTIC_PLASTIC_2: isinstance(model.second, PowerLaw),
        ContactTerm.PLASTIC: not bears_nothing(model.plastic),
        ContactTerm.INTERACTION: model.interaction is not Interaction.NONE,
        ContactTerm.FRICTION: model.yielding is YieldCriterion.FRICTION,
        ContactTerm.THIRD_DIMENSION: model.topography is SURFACE,
    }
    return frozenset(term for term, there in present.items() if there)


def with_term(model: ContactModel, term: ContactTerm, *, present: bool) -> ContactModel:
    """Return `model` with a term added or removed.

    Args:
        model: to start from.
        term: the term to switch.
        present: whether it is to be present.

    Returns:
        The unchanged model where the term is as requested. A missing elastic-plastic
        stage becomes fully plastic, as in Majumdar and Bhushan 1991; missing elastic or
        plastic contacts carry no load; without friction, yield is set by the mean
        contact pressure; without the third dimension the surface is a profile, and its
        fractal dimension one lower.
    """
    if (term in model_terms(model)) is present:
        return model
    flow = PLASTIC_SURFACE if model.topography is SURFACE else PLASTIC_PROFILE
    match term:
        case ContactTerm.ELASTIC:
            return replace(model, elastic=HERTZ if present else ABSENT)
        case ContactTerm.ELASTIC_PLASTIC_1:
            return replace(model, first=KOGUT_ETSION_1 if present else flow)
        case ContactTerm.ELASTIC_PLASTIC_2:
            return replace(model, second=KOGUT_ETSION_2 if present else flow)
        case ContactTerm.PLASTIC:
            return replace(model, plastic=flow if present else ABSENT)
        case ContactTerm.INTERACTION:
            on = Interaction.SELF_CONSISTENT
            return replace(model, interaction=on if present else Interaction.NONE)
        case ContactTerm.FRICTION:
            off = YieldCriterion.MEAN_CONTACT_PRESSURE
            on_off = YieldCriterion.FRICTION if present else off
            return replace(model, yielding=on_off)
        case ContactTerm.THIRD_DIMENSION:
            return _with_third_dimension(model, present=present)


def _with_third_dimension(model: ContactModel, *, present: bool) -> ContactModel:
    """Return `model` on the other kind of topography, with its full plasticity."""
    flow = PLASTIC_SURFACE if present else PLASTIC_PROFILE

    def moved(law: AsperityLaw) -> AsperityLaw:
        flows = isinstance(law, FullyPlastic) and not bears_nothing(law)
        return flow if flows else law

    return replace(
        model,
        topography=SURFACE if present else PROFILE,
        first=moved(model.first),
        second=moved(model.second),
        plastic=ABSENT if bears_nothing(model.plastic) else flow,
    )
