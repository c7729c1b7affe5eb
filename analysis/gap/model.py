# SPDX-License-Identifier: MIT
"""Lumped bodies and links with priors: what a base model is made of."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import BadData


class Output(IntEnum):
    """What the channels measure: the power of s that turns displacement into it."""

    DISPLACEMENT = 0
    VELOCITY = 1
    ACCELERATION = 2


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid mass.

    Attributes:
        name: for example ``"m2"``.
        mass: nominal [kg].
        spread: prior sd of log(mass / nominal) [-].
    """

    name: str
    mass: float
    spread: float


@dataclass(frozen=True, slots=True)
class Link:
    """A spring and damper between two bodies, or a body and the ground.

    Attributes:
        name: for example ``"joint"``.
        first: index of the body at the negative end, -1 for the ground.
        second: index of the body at the positive end.
        stiffness: nominal [N/m].
        damping: nominal [N s/m].
        stiffness_spread: prior sd of log(stiffness / nominal) [-].
        damping_spread: prior sd of log(damping / nominal) [-].
        joint: True where effects of joints may sit.
    """

    name: str
    first: int
    second: int
    stiffness: float
    damping: float
    stiffness_spread: float
    damping_spread: float
    joint: bool = False


@dataclass(frozen=True, slots=True)
class Channel:
    """A response channel.

    Attributes:
        name: for example ``"a1"``.
        body: index of the body it sits on.
    """

    name: str
    body: int


@dataclass(frozen=True, slots=True)
class LumpedModel:
    """Bodies, links and channels; base parameters are masses, then k, then c.

    Attributes:
        bodies: in order.
        links: in order.
        channels: in the order of the rows of a response.
        output: what all channels measure.
    """

    bodies: tuple[Body, ...]
    links: tuple[Link, ...]
    channels: tuple[Channel, ...]
    output: Output = Output.ACCELERATION

    @property
    def nominal(self) -> FloatArray:
        """Nominal masses, stiffnesses and dampings [SI], shape (n_base,)."""
        return np.array(
            [b.mass for b in self.bodies]
            + [link.stiffness for link in self.links]
            + [link.damping for link in self.links]
        )

    @property
    def spread(self) -> FloatArray:
        """Prior sd of log(parameter / nominal), shape (n_base,)."""
        return np.array(
            [b.spread for b in self.bodies]
            + [link.stiffness_spread for link in self.links]
            + [link.damping_spread for link in self.links]
        )

    @property
    def base_names(self) -> tuple[str, ...]:
        """Names in the order of `nominal`."""
        return (
            *(b.name for b in self.bodies),
            *(f"k_{link.name}" for link in self.links),
            *(f"c_{link.name}" for link in self.links),
        )


def two_body_model(
    nominal: Mapping[str, float], spread: Mapping[str, float]
) -> LumpedModel:
    """Return ground -(k0, c0)- m1 -(kj, cj)- m2 with a channel on each body.

    Args:
        nominal: m1, m2 [kg], k0, kj [N/m], c0, cj [N s/m].
        spread: 1-sigma of the logarithm of each [-], same keys.

    Raises:
        BadData: a value is missing or not positive.
    """
    for key in ("m1", "m2", "k0", "kj", "c0", "cj"):
        for sheet, word in ((nominal, "nominal value"), (spread, "1-sigma")):
            value = sheet.get(key)
            if value is None or not (np.isfinite(value) and value > 0):
                raise BadData(
                    f"the sheet's {word} of {key!r} is {value!r}, it must be a "
                    "positive number; complete the sheet"
                )
    return LumpedModel(
        bodies=tuple(Body(key, nominal[key], spread[key]) for key in ("m1", "m2")),
        links=(
            _link("ground", -1, 0, "0", nominal, spread, joint=False),
            _link("joint", 0, 1, "j", nominal, spread, joint=True),
        ),
        channels=(Channel("a0", 0), Channel("a1", 1)),
    )


def _link(
    name: str,
    first: int,
    second: int,
    key: str,
    nominal: Mapping[str, float],
    spread: Mapping[str, float],
    *,
    joint: bool,
) -> Link:
    return Link(
        name=name,
        first=first,
        second=second,
        stiffness=nominal[f"k{key}"],
        damping=nominal[f"c{key}"],
        stiffness_spread=spread[f"k{key}"],
        damping_spread=spread[f"c{key}"],
        joint=joint,
    )
