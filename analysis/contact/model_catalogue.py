# SPDX-License-Identifier: MIT
"""The contact models by name: those of the papers, and those of other packages.

A package adds a model by one entry point of the group ``jointbench.contact_laws`` that
names a `ContactLaw`; the name of the entry point is that of the model.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.basics.registry import Registry
from jointbench.analysis.contact.asperity_laws import (
    FullyPlastic,
    PowerLaw,
)
from jointbench.analysis.contact.material import YieldCriterion
from jointbench.analysis.contact.models import (
    ContactLaw,
    ContactModel,
    Interaction,
    Mode,
)
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
"""The built-in models, corrected."""
CONTACT_LAWS_GROUP = "jointbench.contact_laws"
_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")


def contact_model(name: str, mode: str = Mode.CORRECTED) -> ContactModel:
    """Return the contact model called `name`.

    Args:
        name: one of `CONTACT_LAWS`.
        mode: ``corrected``: lost notation restored, misprints corrected;
            ``as-printed``: with the laws and factors that the papers chose.

    Returns:
        The model; the papers' own joint sums are in `printed_2023`.

    Raises:
        UsageError: there is no such model, or no such mode, or the package that adds
            the model cannot be used.
    """
    known = {str(m) for m in Mode}
    if mode not in known:
        raise UsageError(f"no mode {mode!r}; known: {', '.join(sorted(known))}")
    return CONTACT_LAWS.entry(name).value.model(Mode(mode))


def contact_law_package(name: str) -> str:
    """Return the package, and its version where it is another, of a model."""
    return CONTACT_LAWS.entry(name).package


def contact_law_code(name: str) -> tuple[str, ...]:
    """Return what the key of a prediction holds of a model of another package.

    Args:
        name: of the model.

    Returns:
        Nothing for a built-in model, whose code the stage's own version holds; else
        package, version and digest of its module, see `Entry.code`.
    """
    entry = CONTACT_LAWS.entry(name)
    return () if entry.built_in else (entry.code,)


def _law_fault(law: ContactLaw) -> str:
    """Return what is wrong with the law of another package, or an empty text."""
    if not _NAME.fullmatch(law.name):
        return "the name must be words in small letters joined by _"
    for model in (law.corrected, law.printed):
        if model is not None and (fault := _model_fault(model)):
            return fault
    if law.corrected.mode is not Mode.CORRECTED:
        return "the mode of its corrected model must be Mode.CORRECTED"
    if law.printed is not None and law.printed.mode is not Mode.AS_PRINTED:
        return "the mode of its printed model must be Mode.AS_PRINTED"
    return ""


def _model_fault(model: ContactModel) -> str:
    """Return what no joint can be computed with, or an empty text."""
    if not model.source.strip():
        return "its source is empty; give paper and equation"
    if not (math.isfinite(model.population) and model.population > 0):
        return f"its population is {model.population:g}; it must be above 0"
    for word in ("elastic", "first", "second", "plastic"):
        law = getattr(model, word)
        if not isinstance(law, PowerLaw | FullyPlastic):
            return f"its {word} law must be a PowerLaw or FullyPlastic"
        if isinstance(law, PowerLaw):
            numbers = (law.coefficient, law.exponent)
        else:
            numbers = (law.pressure_factor, 1.0)
        if not (math.isfinite(sum(numbers)) and numbers[0] >= 0 < numbers[1]):
            return (
                f"its {word} law is {law}; a coefficient must be finite and not "
                "negative, an exponent above 0"
            )
    return ""


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


_BUILT_IN = tuple(ContactLaw(m, _as_printed(m)) for m in CONTACT_MODELS.values())
CONTACT_LAWS = Registry(
    CONTACT_LAWS_GROUP,
    "contact model",
    ContactLaw,
    lambda: _BUILT_IN,
    fault=_law_fault,
)
"""All contact models, corrected and as printed."""
