# SPDX-License-Identifier: MIT
"""The bench model file (TOML): bodies, links, the channel on each body, the contact.

One file serves `identify`, `report` and `gap`. Units are written beside every number
("9.02 kg") and parsed once, here. Where a [record] is driven by something else than a
force (a voltage, say), its units stand in for newton and metre: see `record_model`.
"""

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from jointbench.analysis.gap.model.stated_scatter import LONGEST_DELAY
from jointbench.analysis.lumped.lumped_model import (
    GROUND,
    Body,
    Link,
    LumpedModel,
    Output,
    ResponseChannel,
)
from jointbench.station.files.toml_file import StrictTable, with_unit
from jointbench.station.schemas.bolted_joint_table import BoltedLinkTable
from jointbench.station.schemas.positive_quantities import Force, Mass, Pressure, Share
from jointbench.station.schemas.record_model import RecordTable, with_mechanical_units

_OUTPUTS = {
    "displacement": Output.DISPLACEMENT,
    "velocity": Output.VELOCITY,
    "acceleration": Output.ACCELERATION,
}

_Stiffness = Annotated[float, with_unit("stiffness"), Field(ge=0)]
_Damping = Annotated[float, with_unit("damping"), Field(ge=0)]
_Delay = Annotated[float, with_unit("time"), Field(gt=0, lt=LONGEST_DELAY)]


class BodyTable(StrictTable):
    """A rigid body: weighed mass [kg], its standard deviation, its channel.

    The points are those at which the hammer strikes this body; left out, they are
    the point at which its channel sits, or the name of the body.
    """

    mass: Mass
    mass_sd: Mass | None = None
    channel: str | None = None
    points: tuple[str, ...] = ()


class LinkTable(StrictTable):
    """A spring and dashpot between two bodies, or a body and ``ground``.

    Stiffness [N/m] and damping [N s/m] are nominal values; the standard deviations,
    where given, make them priors. A joint is a link where effects of joints may sit.
    """

    between: tuple[str, str]
    stiffness: _Stiffness | None = None
    stiffness_sd: _Stiffness | None = None
    damping: _Damping | None = None
    damping_sd: _Damping | None = None
    joint: bool = False


class ContactTable(StrictTable):
    """Input of the contact law for the prediction of one link from two surfaces."""

    link: str
    preload: Force
    modulus: Pressure
    hardness: Pressure
    poisson: Annotated[float, Field(ge=0, lt=0.5)] = 0.25
    model: str = "ke_3d_modified"


class ScatterTable(StrictTable):
    """Expected sd from hit to hit, by direction: gains and stiffness [-], delays [s].

    A key left out states nothing: the size is then estimated from the hits alone.
    """

    force_gain: Share | None = None
    joint_stiffness: Share | None = None
    channel_gain: Share | None = None
    force_delay: _Delay | None = None
    channel_delay: _Delay | None = None


class GapTable(StrictTable):
    """What `gap` needs beside bodies and links.

    What all channels measure; the preload [N] that the nominal values belong to; the
    scatter from hit to hit relative to the peak response [-], without repeats; or the
    scatter to expect, by direction;
    the sessions to examine, beside this file, where it is given in their place.
    """

    output: Literal["displacement", "velocity", "acceleration"] = "acceleration"
    preload_reference: Force | None = None
    repeatability: Share | None = None
    scatter: ScatterTable = ScatterTable()
    sessions: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _one_statement(self) -> "GapTable":
        if self.repeatability is not None and self.scatter != ScatterTable():
            raise ValueError(
                f"repeatability = {self.repeatability:g} replaces all estimates of "
                "scatter; state it, or the table gap.scatter, not both"
            )
        return self


class BenchModel(StrictTable):
    """A lumped bench: bodies and links by name, the joint at one link, a record."""

    bodies: dict[str, BodyTable] = Field(min_length=1)
    links: dict[str, LinkTable] = Field(min_length=1)
    contact: ContactTable | None = None
    bolted_joint: BoltedLinkTable | None = None
    gap: GapTable = GapTable()
    record: RecordTable | None = None

    @model_validator(mode="before")
    @classmethod
    def _stand_ins(cls, content: Any) -> Any:
        return with_mechanical_units(content)

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
        points = [point for body in self.bodies.values() for point in body.points]
        if len(set(points)) != len(points):
            raise ValueError(f"a hit point belongs to two bodies: {points}")
        for name in ("contact", "bolted_joint"):
            table = getattr(self, name)
            if table is not None and table.link not in self.links:
                raise ValueError(
                    f"{name}.link is {table.link!r}; links are {list(self.links)}"
                )
        return self


def lumped_model(bench: BenchModel) -> LumpedModel:
    """Return the bodies, links and channels of a model file, as the analysis has them.

    A mass without a standard deviation is exact; a stiffness or damping without one,
    or without a value, has no prior.
    """
    return LumpedModel(
        bodies=tuple(
            Body(name, body.mass, _spread(body.mass, body.mass_sd) or 0.0)
            for name, body in bench.bodies.items()
        ),
        links=tuple(
            Link(
                name,
                link.between,
                stiffness=link.stiffness or 0.0,
                damping=link.damping or 0.0,
                stiffness_spread=_spread(link.stiffness, link.stiffness_sd),
                damping_spread=_spread(link.damping, link.damping_sd),
                joint=link.joint,
            )
            for name, link in bench.links.items()
        ),
        channels=tuple(
            ResponseChannel(body.channel, name)
            for name, body in bench.bodies.items()
            if body.channel is not None
        ),
        output=_OUTPUTS[bench.gap.output],
    )


def _spread(value: float | None, sd: float | None) -> float | None:
    """Return the prior sd of log(parameter / nominal) [-], None for no prior."""
    return sd / value if value and sd else None
