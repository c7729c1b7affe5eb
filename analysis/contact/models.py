# SPDX-License-Identifier: MIT
"""Contact models of a rough joint as data: terms that are chosen, not code paths.

A model is a topography (profile or surface), a yield criterion, a law for each of four
deformation regimes and an interaction term. Take one with `contact_model`, and change
a term with `dataclasses.replace(model, interaction=Interaction.NONE)`.
"""

import difflib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from types import MappingProxyType

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.contact.material import YieldCriterion


class Regime(StrEnum):
    """How far an asperity is deformed; from the smallest contacts to the largest."""

    PLASTIC = "plastic"
    ELASTIC_PLASTIC_2 = "elastic_plastic_2"
    ELASTIC_PLASTIC_1 = "elastic_plastic_1"
    ELASTIC = "elastic"


REGIMES = tuple(Regime)

# Interference over critical interference at which one regime gives way to the next:
# plastic above 110, second elastic-plastic stage above 6, first above 1.
REGIME_BOUNDS = (math.inf, 110.0, 6.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True)
class Topography:
    """Kind of fractal surface: what sets an asperity's interference and radius.

    With the excess e = D - `lowest_dimension`, both kinds obey the same formulas:
    interference delta = c a^((1-e)/2), a = `shape` R delta, and a distribution of
    contact areas n(a) = q a_l^q a^(-q-1) with q = (1+e)/2.

    Attributes:
        name: ``"profile"`` or ``"surface"``.
        lowest_dimension: fractal dimension at which the kind begins [-].
        shape: g in a = g R delta [-].
        log_interference: ln c of excess [-], roughness G [m] and gamma [-].
    """

    name: str
    lowest_dimension: float
    shape: float
    log_interference: Callable[[FloatArray, FloatArray, float], FloatArray]


def _profile_interference(
    excess: FloatArray, roughness: FloatArray, gamma: float
) -> FloatArray:
    """Return ln c of delta = c a^((2-D)/2) (Appl. Sci. 2023, 13, 11680, eq. 15)."""
    return np.asarray(excess * np.log(roughness))


def _surface_interference(
    excess: FloatArray, roughness: FloatArray, gamma: float
) -> FloatArray:
    """Return ln c of delta = c a^((3-D)/2) (the same paper, eq. 38)."""
    constant = (
        (5 - 3 * excess) / 2 * math.log(2)
        + (excess - 1) / 2 * math.log(math.pi)
        + 0.5 * math.log(math.log(gamma))
    )
    return np.asarray(excess * np.log(roughness) + constant)


PROFILE = Topography("profile", 1.0, math.pi**2, _profile_interference)
SURFACE = Topography("surface", 2.0, math.pi, _surface_interference)


@dataclass(frozen=True, slots=True)
class PowerLaw:
    """Load of an asperity as P = coefficient * P_c * (delta / delta_c)^exponent.

    Attributes:
        coefficient: of the load [-].
        exponent: of the interference ratio [-].
        printed_slope: of the stiffness in P_c / delta_c [-], where a paper prints one
            that is not the derivative of its load.
    """

    coefficient: float
    exponent: float
    printed_slope: float | None = None

    @property
    def slope(self) -> float:
        """Coefficient of dP/d(delta) = slope * P_c / delta_c * s^(exponent - 1) [-]."""
        if self.printed_slope is not None:
            return self.printed_slope
        return self.coefficient * self.exponent


@dataclass(frozen=True, slots=True)
class FullyPlastic:
    """Load of an asperity as P = pressure_factor * hardness * a; 0 bears nothing."""

    pressure_factor: float


AsperityLaw = PowerLaw | FullyPlastic
# Contacts of a regime that was taken out of a model.
ABSENT = FullyPlastic(0.0)


def bears_nothing(law: AsperityLaw) -> bool:
    """Tell whether contacts of this law carry no load at all."""
    factor = law.coefficient if isinstance(law, PowerLaw) else law.pressure_factor
    return factor == 0.0


class Interaction(StrEnum):
    """Whether asperities feel that their neighbours sink the mean surface."""

    NONE = "none"
    SELF_CONSISTENT = "self_consistent"
    AS_PRINTED = "as_printed"


class Mode(StrEnum):
    """Whose formulas: mended and consistent, or those that the papers print."""

    CORRECTED = "corrected"
    AS_PRINTED = "as-printed"


@dataclass(frozen=True, slots=True)
class ContactModel:
    """One contact model: every field is a term that can be exchanged by itself.

    Attributes:
        name: as `contact_model` takes it.
        topography: profile (2D) or surface (3D).
        yielding: what sets the critical interference.
        elastic: law of contacts above the critical area.
        first: law of the first elastic-plastic stage, interference ratio 1 to 6.
        second: law of the second one, 6 to 110.
        plastic: law beyond.
        interaction: acts on elastic contacts only.
        population: factor f of the contact-area distribution [-]; 1 counts one
            contact of the largest area.
        source: paper and chapter.
        mode: mended, or with the papers' own choices.
    """

    name: str
    topography: Topography
    yielding: YieldCriterion
    elastic: AsperityLaw
    first: AsperityLaw
    second: AsperityLaw
    plastic: FullyPlastic
    interaction: Interaction
    population: float
    source: str
    mode: Mode = Mode.CORRECTED


HERTZ = PowerLaw(1.0, 1.5)
KOGUT_ETSION_1 = PowerLaw(1.03, 1.425)
# Both papers print the exponent 1.236; Kogut and Etsion (2002) have 1.263.
KOGUT_ETSION_2 = PowerLaw(1.40, 1.263)
PRINTED_STAGE_2 = PowerLaw(1.40, 1.236)
# The papers' share of the interference that an interacting asperity keeps.
_PRINTED_SHARE = 3 * math.pi / 16
PLASTIC_PROFILE = FullyPlastic(1.0)
# In the surface geometry `a` is half the truncated area: full plasticity bears 2 H a.
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
        mode: ``corrected``: lost notation restored, misprints mended; ``as-printed``:
            with the laws and factors that the papers chose.

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
        # The original takes a = pi r^2 and P = 4 E r^3 / (3 R): with R and delta of
        # the profile that is 4 sqrt(pi)/3 E G^(D-1) a^((3-D)/2), and k = 2 E r.
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


def interaction_share(model: ContactModel) -> float:
    """Return x, the asperity's own share of the interference it shares [-].

    The rest, 1 - x, is the sinking of the mean surface around it.

    Args:
        model: its interaction term and its topography decide.

    Returns:
        1 without interaction, 3 pi/16 as printed; else the root of
        (16/(9 g)) x^3 = (1 - x)^2, which makes Hertz's law and the sinking
        F/(E sqrt a) bear the same load.

    Source:
        Appl. Sci. 2023, 13, 11680, eqs. (17)-(18), solved. Note: the papers put
        3 pi/16 for x, at which the two expressions for the load differ by 17 %.
    """
    if model.interaction is Interaction.NONE:
        return 1.0
    if model.interaction is Interaction.AS_PRINTED:
        return _PRINTED_SHARE
    return _balanced_share(model.topography.shape)


@cache
def _balanced_share(shape: float) -> float:
    """Return the root of (16/(9 g)) x^3 = (1 - x)^2 between 0 and 1."""
    cubic = 16 / (9 * shape)
    share = 1.0
    for _ in range(50):  # Newton on a rising, convex-at-the-root function
        value = cubic * share**3 - (1 - share) ** 2
        share -= value / (3 * cubic * share**2 + 2 * (1 - share))
    return share


def regime_laws(model: ContactModel) -> tuple[AsperityLaw, ...]:
    """Return the laws that act in a joint, in the order of `REGIMES`.

    Args:
        model: its four laws and its interaction term.

    Returns:
        From small contacts to large; with interaction an elastic contact bears
        x^(3/2) of what its geometric interference would.
    """
    elastic = model.elastic
    if isinstance(elastic, PowerLaw) and model.interaction is Interaction.AS_PRINTED:
        elastic = _printed_interaction(elastic, model.topography.shape)
    elif isinstance(elastic, PowerLaw):
        share = interaction_share(model)
        elastic = PowerLaw(elastic.coefficient * share**1.5, elastic.exponent)
    return (model.plastic, model.second, model.first, elastic)


def _printed_interaction(elastic: PowerLaw, shape: float) -> PowerLaw:
    """Return the elastic law of eqs. (18) and (30): load and stiffness disagree."""
    # P = E a^(3/2) (1 - 3 pi/16)/(pi R) and k = (sqrt 3 / 2) E sqrt(a), as multiples
    # of Hertz's 4/3 E R^(1/2) delta^(3/2) and 2 E sqrt(a/g), with a = g R delta.
    load = 3 / (4 * math.pi) * shape**1.5 * (1 - _PRINTED_SHARE)
    slope = math.sqrt(3 * shape) / 4 * elastic.exponent
    return PowerLaw(elastic.coefficient * load, elastic.exponent, slope)
