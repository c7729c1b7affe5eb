# SPDX-License-Identifier: MIT
"""Contact models of a rough joint as data, with terms to choose.

A model is a topography (profile or surface), a yield criterion, a law for each of four
deformation regimes and an interaction term. Get one with `contact_model`, and change a
term with `dataclasses.replace(model, interaction=Interaction.NONE)`.
"""

import math
from dataclasses import dataclass
from enum import StrEnum
from functools import cache

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.contact.asperity_laws import (
    AsperityLaw,
    FullyPlastic,
    PowerLaw,
)
from jointbench.analysis.contact.material import YieldCriterion
from jointbench.analysis.contact.topography import Topography


class Interaction(StrEnum):
    """Whether neighbouring asperities lower the mean surface."""

    NONE = "none"
    SELF_CONSISTENT = "self_consistent"
    AS_PRINTED = "as_printed"


class Mode(StrEnum):
    """Formulas to use: corrected and consistent, or as printed in the papers."""

    CORRECTED = "corrected"
    AS_PRINTED = "as-printed"


@dataclass(frozen=True, slots=True)
class ContactModel:
    """One contact model: every field is a term that can be replaced alone.

    Attributes:
        name: as in `contact_model`.
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
        mode: corrected, or with the choices of the papers.
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


@dataclass(frozen=True, slots=True)
class ContactLaw:
    """One entry of the contact models: corrected, and as its paper prints it.

    Attributes:
        corrected: the model that is used.
        printed: the same with the choices of its paper; None where no paper prints
            other ones.
    """

    corrected: ContactModel
    printed: ContactModel | None = None

    @property
    def name(self) -> str:
        """Name by which the model is asked for."""
        return self.corrected.name

    def model(self, mode: Mode) -> ContactModel:
        """Return the model in a mode.

        Raises:
            UsageError: the law has no printed form.
        """
        if mode is Mode.CORRECTED:
            return self.corrected
        if self.printed is None:
            raise UsageError(
                f"contact model {self.name!r} has no form as printed; leave "
                "--mode as-printed out"
            )
        return self.printed


# The papers' share of the interference that an interacting asperity keeps.
_PRINTED_SHARE = 3 * math.pi / 16


def interaction_share(model: ContactModel) -> float:
    """Return x, the asperity's own share of the interference it shares [-].

    The rest, 1 - x, is the displacement of the mean surface around it.

    Args:
        model: its interaction term and topography are used.

    Returns:
        1 without interaction, 3 pi/16 as printed; else the root of
        (16/(9 g)) x^3 = (1 - x)^2, at which Hertz's law and the displacement F/(E sqrt
        a) give the same load.

    Source:
        Appl. Sci. 2023, 13, 11680, eqs. (17)-(18), solved. Note: the papers use 3 pi/16
        for x, at which the two expressions for the load differ by 17 %.
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
    """Return the laws of a joint, in the order of `REGIMES`.

    Args:
        model: its four laws and its interaction term.

    Returns:
        From small contacts to large; with interaction an elastic contact carries
        x^(3/2) of the load of its geometric interference.
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
