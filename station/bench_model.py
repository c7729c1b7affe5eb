# SPDX-License-Identifier: MIT
"""The bench model file (TOML): bodies, links, the channel on each body, the contact.

Units are written beside every number ("9.02 kg") and parsed once, here.
"""

from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from jointbench.acquisition.errors import UnitError
from jointbench.acquisition.units import parse_value

GROUND = "ground"


def _quantity(kind: str) -> BeforeValidator:
    def parse(value: object) -> float:
        if not isinstance(value, str):
            # pydantic turns a ValueError, not a TypeError, into a named problem.
            raise ValueError(  # noqa: TRY004
                f"write the number with its unit, as text: '{value} ...'"
            )
        try:
            return parse_value(value, kind)
        except UnitError as error:
            raise ValueError(str(error)) from error

    return BeforeValidator(parse)


Mass = Annotated[float, _quantity("mass"), Field(gt=0)]
Stiffness = Annotated[float, _quantity("stiffness"), Field(ge=0)]
Damping = Annotated[float, _quantity("damping"), Field(ge=0)]
Force = Annotated[float, _quantity("force"), Field(gt=0)]
Pressure = Annotated[float, _quantity("pressure"), Field(gt=0)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class BodyTable(_Strict):
    """A rigid body: weighed mass [kg], its standard deviation, its channel."""

    mass: Mass
    mass_sd: Mass | None = None
    channel: str | None = None


class LinkTable(_Strict):
    """A spring and dashpot between two bodies, or a body and ``ground``.

    Stiffness [N/m] and damping [N s/m] are nominal values; the standard deviations,
    where given, make them priors.
    """

    between: tuple[str, str]
    stiffness: Stiffness | None = None
    stiffness_sd: Stiffness | None = None
    damping: Damping | None = None


class ContactTable(_Strict):
    """What the contact law needs to predict one link from its two faces."""

    link: str
    preload: Force
    modulus: Pressure
    hardness: Pressure
    poisson: Annotated[float, Field(ge=0, lt=0.5)] = 0.25
    model: str = "ke_3d_modified"


class BenchModel(_Strict):
    """A lumped bench: bodies and links by name, and the contact of one link."""

    bodies: dict[str, BodyTable] = Field(min_length=1)
    links: dict[str, LinkTable] = Field(min_length=1)
    contact: ContactTable | None = None

    @model_validator(mode="after")
    def _names_exist(self) -> "BenchModel":
        if GROUND in self.bodies:
            raise ValueError(f"{GROUND!r} is the name of the fixed end, not of a body")
        known = {GROUND, *self.bodies}
        for name, link in self.links.items():
            missing = [end for end in link.between if end not in known]
            if missing or link.between[0] == link.between[1]:
                raise ValueError(
                    f"link {name!r} joins {list(link.between)}; it must join two of "
                    f"{sorted(known)}"
                )
        channels = [b.channel for b in self.bodies.values() if b.channel is not None]
        if len(set(channels)) != len(channels):
            raise ValueError(f"two bodies share a channel: {channels}")
        if self.contact is not None and self.contact.link not in self.links:
            raise ValueError(
                f"contact.link is {self.contact.link!r}; links are {list(self.links)}"
            )
        return self
