# SPDX-License-Identifier: MIT
"""The contact models of the papers by name, corrected or as printed."""

import difflib
import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.contact.asperity_laws import (
    FullyPlastic,
    PowerLaw,
)
from jointbench.analysis.contact.material import YieldCriterion
from jointbench.analysis.contact.models import ContactModel, Interaction, Mode
from jointbench.analysis.contact.topography import PROFILE, SURFACE, Topography

HERTZ = PowerLaw(1.0, 1.5)
KOGUT_ETSION_1 = PowerLaw(1.03, 1.425)
# Both papers print the exponent 1.236; Kogut and Etsion (2002) have 1.263.
KOGUT_ETSION_2 = PowerLaw(1.40, 1.263)
PRINTED_STAGE_2 = PowerLaw(1.40, 1.236)
PLASTIC_PROFILE = FullyPlastic(1.0)
# In the surface geometry `a` is half the truncated area: full plasticity carries 2 H a.
PLASTIC_SURFACE = FullyPlastic(2.0)
_PAPER_2023 = "Appl. Sci. 2023, 13, 11680"
_PAPER_2025 = "Appl. Sci. 2025, 15, 9040"


def _model(
    name: str,
    topography: Topography,
    yielding: YieldCriterion,
    interaction: Interaction,
    source: str,
) -> ContactModel:
    """Return a model with Kogut and Etsion's stages between elastic and plastic."""
    plastic = PLASTIC_PROFILE if topography is PROFILE else PLASTIC_SURFACE
    return ContactModel(
        name,
        topography,
        yielding,
        HERTZ,
        KOGUT_ETSION_1,
        KOGUT_ETSION_2,
        plastic,
        interaction,
        1.0,
        source,
    )


_MB_2D = ContactModel(
    "mb_2d",
    PROFILE,
    YieldCriterion.HARDNESS,
    HERTZ,
    PLASTIC_PROFILE,
    PLASTIC_PROFILE,
    PLASTIC_PROFILE,
    Interaction.NONE,
    1.0,
    "Majumdar and Bhushan 1991",
)
_WITH = Interaction.SELF_CONSISTENT
_WITHOUT = Interaction.NONE
_CEB = YieldCriterion.MEAN_CONTACT_PRESSURE
CONTACT_MODELS: Mapping[str, ContactModel] = MappingProxyType(
    {
        model.name: model
        for model in (
            _MB_2D,
            _model("modified_2d", PROFILE, YieldCriterion.HARDNESS, _WITH, _PAPER_2023),
            _model("friction_3d", SURFACE, YieldCriterion.FRICTION, _WITH, _PAPER_2023),
            _model("ke_2d", PROFILE, _CEB, _WITHOUT, _PAPER_2025),
            _model("ke_3d", SURFACE, _CEB, _WITHOUT, _PAPER_2025),
            _model("ke_3d_modified", SURFACE, _CEB, _WITH, _PAPER_2025),
        )
    }
)


def contact_model(name: str, mode: str = Mode.CORRECTED) -> ContactModel:
    """Return the contact model called `name`.

    Args:
        name: one of `CONTACT_MODELS`.
        mode: ``corrected``: lost notation restored, misprints corrected;
            ``as-printed``: with the laws and factors that the papers chose.

    Returns:
        The model; the papers' own joint sums are in `printed_2023`.

    Raises:
        UsageError: there is no such model, or no such mode.
    """
    known = {str(m) for m in Mode}
    if mode not in known:
        raise UsageError(f"no mode {mode!r}; known: {', '.join(sorted(known))}")
    if name in CONTACT_MODELS:
        model = CONTACT_MODELS[name]
        return model if mode == Mode.CORRECTED else _as_printed(model)
    near = difflib.get_close_matches(name, CONTACT_MODELS, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise UsageError(
        f"no contact model {name!r}; {hint}known: {', '.join(CONTACT_MODELS)}"
    )


def _as_printed(model: ContactModel) -> ContactModel:
    """Return `model` with the choices of its paper."""
    if model.name == "mb_2d":
        # The original uses a = pi r^2 and P = 4 E r^3 / (3 R): with R and delta of the
        # profile that is 4 sqrt(pi)/3 E G^(D-1) a^((3-D)/2), and k = 2 E r.
        root = math.sqrt(math.pi)
        elastic = PowerLaw(math.pi * root, 1.5, 1.5 * root)
        return replace(model, elastic=elastic, mode=Mode.AS_PRINTED)
    interaction = model.interaction
    if interaction is Interaction.SELF_CONSISTENT:
        interaction = Interaction.AS_PRINTED
    of_2025_3d = model.topography is SURFACE and model.source == _PAPER_2025
    return replace(
        model,
        second=PRINTED_STAGE_2,
        plastic=PLASTIC_PROFILE,
        interaction=interaction,
        population=0.5 if of_2025_3d else 1.0,
        mode=Mode.AS_PRINTED,
    )
