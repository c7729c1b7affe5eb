# SPDX-License-Identifier: MIT
"""Rigid bodies joined by springs and dashpots: nominal values with priors, channels."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError

GROUND = "ground"
# A microgram to a million tonnes [kg]: no test object is outside, and eigenvalues for
# larger masses lose all their digits.
_MASS_RANGE = (1e-9, 1e9)
# Far above any link or body [SI], also in other units; squares of larger values
# overflow in the eigenvalue problem.
_LARGEST_NUMBER = 1e30


class Output(IntEnum):
    """Quantity of the channels: the power of s that relates it to displacement."""

    DISPLACEMENT = 0
    VELOCITY = 1
    ACCELERATION = 2


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body that moves in one direction.

    Attributes:
        name: unique in its model; not ``"ground"``.
        mass: nominal [kg].
        mass_spread: prior sd of log(mass / nominal) [-]; 0 where it is exact.
    """

    name: str
    mass: float
    mass_spread: float = 0.0


@dataclass(frozen=True, slots=True)
class Link:
    """A spring and a dashpot between two bodies, or a body and the ground.

    Attributes:
        name: unique in its model.
        ends: names of the bodies at its negative and its positive end; one may be
            ``"ground"``, which is always the negative end.
        stiffness: nominal [N/m]; 0 where not known yet.
        damping: nominal, viscous [N s/m].
        stiffness_spread: prior sd of log(stiffness / nominal) [-]; None for no prior.
        damping_spread: prior sd of log(damping / nominal) [-]; None for no prior.
        joint: True where effects of joints may act.
    """

    name: str
    ends: tuple[str, str]
    stiffness: float = 0.0
    damping: float = 0.0
    stiffness_spread: float | None = None
    damping_spread: float | None = None
    joint: bool = False


@dataclass(frozen=True, slots=True)
class ResponseChannel:
    """A response channel.

    Attributes:
        name: for example ``"a1"``.
        body: name of its body.
    """

    name: str
    body: str


@dataclass(frozen=True, slots=True)
class LumpedModel:
    """Bodies, the links between them, and the channels on them.

    Base parameters are the masses, then the stiffnesses, then the dampings.

    Attributes:
        bodies: each one degree of freedom, in this order in every matrix.
        links: at least one.
        channels: in the order of the rows of a response; empty where the bodies name
            the outputs.
        output: quantity of all channels.
    """

    bodies: tuple[Body, ...]
    links: tuple[Link, ...]
    channels: tuple[ResponseChannel, ...] = ()
    output: Output = Output.ACCELERATION

    def __post_init__(self) -> None:
        """Check names, ends and numbers once."""
        names = [body.name for body in self.bodies]
        _require_unique("body", [*names, GROUND])
        _require_unique("link", [link.name for link in self.links])
        for body in self.bodies:
            _require_number(f"mass of body {body.name!r}", body.mass, above=True)
            _require_mass(body, 1 / _LARGEST_NUMBER, _LARGEST_NUMBER)
            _require_number(f"mass_spread of body {body.name!r}", body.mass_spread)
        for link in self.links:
            _require_ends(link, names)
            for what in ("stiffness", "damping", "stiffness_spread", "damping_spread"):
                value = getattr(link, what)
                if value is not None:
                    _require_number(f"{what} of link {link.name!r}", value)
                    _require_moderate(link.name, what, value)
        for channel in self.channels:
            self.index(channel.body)

    @property
    def nominal(self) -> FloatArray:
        """Nominal masses, stiffnesses and dampings [SI], shape (n_base,)."""
        return np.array(
            [body.mass for body in self.bodies]
            + [link.stiffness for link in self.links]
            + [link.damping for link in self.links]
        )

    @property
    def spread(self) -> FloatArray:
        """Prior sd of log(parameter / nominal), shape (n_base,).

        Raises:
            UsageError: a parameter has no prior, or is exact.
        """
        priors = (
            *(body.mass_spread for body in self.bodies),
            *(link.stiffness_spread for link in self.links),
            *(link.damping_spread for link in self.links),
        )
        for name, prior in zip(self.base_names, priors, strict=True):
            if not prior:
                raise UsageError(
                    f"the prior sd of {name} is {prior}, each base parameter needs one "
                    "above zero; complete the model"
                )
        return np.array(priors, dtype=float)

    @property
    def base_names(self) -> tuple[str, ...]:
        """Names in the order of `nominal`."""
        return (
            *(body.name for body in self.bodies),
            *(f"k_{link.name}" for link in self.links),
            *(f"c_{link.name}" for link in self.links),
        )

    @property
    def first_joint(self) -> int:
        """Index of the first link that is a joint; 0 where none is."""
        return next((i for i, link in enumerate(self.links) if link.joint), 0)

    def index(self, body: str) -> int:
        """Return the degree of freedom of `body`.

        Raises:
            UsageError: there is no such body.
        """
        for degree, one in enumerate(self.bodies):
            if one.name == body:
                return degree
        names = [one.name for one in self.bodies]
        raise UsageError(f"no body {body!r} in the model; its bodies are {names}")

    def ends(self, link: int) -> tuple[int, int]:
        """Return the degrees of freedom at a link's negative and positive end.

        Args:
            link: its index.

        Returns:
            The ground is -1, and never the positive end: a link to the ground grows
            longer as its body moves up.
        """
        first, second = self.links[link].ends
        if second == GROUND:
            first, second = second, first
        return (-1 if first == GROUND else self.index(first)), self.index(second)


def require_tested_masses(model: LumpedModel) -> None:
    """Raise unless every mass is possible for a hammer test.

    Raises:
        UsageError: one is lighter than a microgram or heavier than a million tonnes.
    """
    for body in model.bodies:
        _require_mass(body, *_MASS_RANGE)


def _require_unique(what: str, names: Sequence[str]) -> None:
    """Raise where two bodies or links share a name, or there is none."""
    if len(set(names)) != len(names) or not all(names):
        raise UsageError(
            f"{what} names {list(names)} are not unique ({GROUND!r} is taken); "
            "give each its own"
        )


def _require_ends(link: Link, names: Sequence[str]) -> None:
    """Raise unless a link joins two different ends that exist."""
    known = {GROUND, *names}
    if len(link.ends) != 2 or len(set(link.ends)) != 2 or not known >= set(link.ends):
        raise UsageError(
            f"link {link.name!r} joins {list(link.ends)}; it must join two different "
            f"ones of {sorted(known)}"
        )


def _require_mass(body: Body, least: float, most: float) -> None:
    """Raise unless the mass of a body is within limits [kg]."""
    if not least <= body.mass <= most:
        low, high = _MASS_RANGE
        raise UsageError(
            f"mass of body {body.name!r} is {body.mass:g} kg, a body weighs {low:g} to "
            f"{high:g} kg; give it in kg"
        )


def _require_moderate(link: str, what: str, value: float) -> None:
    """Raise where the stiffness or damping of a link would overflow."""
    if value > _LARGEST_NUMBER:
        raise UsageError(
            f"{what} of link {link!r} is {value:g}, at most {_LARGEST_NUMBER:g} in SI "
            "is computed; give N/m and N s/m"
        )


def _require_number(what: str, value: float, *, above: bool = False) -> None:
    """Raise unless `value` is finite and not negative (or above zero)."""
    if not (math.isfinite(value) and (value > 0 if above else value >= 0)):
        rule = "positive" if above else "zero or positive"
        raise UsageError(f"{what} is {value:g}, it must be finite and {rule}")
