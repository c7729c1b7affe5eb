# SPDX-License-Identifier: MIT
"""Rigid bodies joined by springs and dashpots: matrices and frequency response."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.records import step
from jointbench.signal.frf import Frf, FrfKind

GROUND = "ground"
# A microgram to a million tonnes [kg]: nothing a hammer tests is outside, and
# eigenvalues of masses beyond lose all their digits.
_MASS_RANGE = (1e-9, 1e9)
# Far above any link [SI]; beyond, squares in the eigenvalue problem overflow.
_LARGEST_NUMBER = 1e30


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body that moves in one direction.

    Attributes:
        name: unique in its model; not ``"ground"``.
        mass: [kg].
        mass_sd: how well it was weighed [kg]; 0 stands for exactly.
    """

    name: str
    mass: float
    mass_sd: float = 0.0


@dataclass(frozen=True, slots=True)
class Link:
    """A spring and a dashpot between two bodies, or a body and the ground.

    Attributes:
        name: unique in its model.
        ends: names of the bodies at its ends; one may be ``"ground"``.
        stiffness: [N/m]; 0 where not known yet.
        damping: viscous [N s/m].
        stiffness_sd: how well the stiffness is known beforehand [N/m]; None: not.
        damping_sd: how well the damping is known beforehand [N s/m]; None: not.
    """

    name: str
    ends: tuple[str, str]
    stiffness: float = 0.0
    damping: float = 0.0
    stiffness_sd: float | None = None
    damping_sd: float | None = None


@dataclass(frozen=True, slots=True)
class LumpedModel:
    """Bodies and the links between them.

    Attributes:
        bodies: each one degree of freedom, in this order in every matrix.
        links: at least one.
    """

    bodies: tuple[Body, ...]
    links: tuple[Link, ...]

    def __post_init__(self) -> None:
        """Check names, ends and numbers once."""
        names = [body.name for body in self.bodies]
        _require_unique("body", [*names, GROUND])
        _require_unique("link", [link.name for link in self.links])
        for body in self.bodies:
            _require_number(f"mass of body {body.name!r}", body.mass, above=True)
            _require_mass(body)
            _require_number(f"mass_sd of body {body.name!r}", body.mass_sd)
        for link in self.links:
            _require_ends(link, names)
            for what in ("stiffness", "damping", "stiffness_sd", "damping_sd"):
                value = getattr(link, what)
                if value is not None:
                    _require_number(f"{what} of link {link.name!r}", value)
                    _require_moderate(link.name, what, value)

    def index(self, body: str) -> int:
        """Return the degree of freedom of `body`.

        Raises:
            UsageError: there is no such body.
        """
        names = [one.name for one in self.bodies]
        if body not in names:
            raise UsageError(f"no body {body!r} in the model; its bodies are {names}")
        return names.index(body)


def incidence(model: LumpedModel) -> FloatArray:
    """Return the elongation of each link per displacement of each body [-].

    Returns:
        Shape (n_links, n_bodies): 1 at one end, -1 at the other; the ground has no
        column. Stiffness matrix = incidence^T diag(stiffness) incidence.
    """
    rows = np.zeros((len(model.links), len(model.bodies)))
    for row, link in zip(rows, model.links, strict=True):
        for sign, end in zip((1.0, -1.0), link.ends, strict=True):
            if end != GROUND:
                row[model.index(end)] = sign
    return rows


def mass_matrix(model: LumpedModel) -> FloatArray:
    """Return M [kg], shape (n_bodies, n_bodies), diagonal."""
    return np.diag([body.mass for body in model.bodies])


def damping_matrix(model: LumpedModel) -> FloatArray:
    """Return C [N s/m], shape (n_bodies, n_bodies)."""
    rows = incidence(model)
    return np.asarray((rows.T * [link.damping for link in model.links]) @ rows)


def stiffness_matrix(model: LumpedModel) -> FloatArray:
    """Return K [N/m], shape (n_bodies, n_bodies)."""
    rows = incidence(model)
    return np.asarray((rows.T * [link.stiffness for link in model.links]) @ rows)


def predict_frf(
    model: LumpedModel,
    frequency: FloatArray,
    *,
    kind: FrfKind = FrfKind.ACCELERANCE,
    outputs: Sequence[str] | None = None,
    inputs: Sequence[str] | None = None,
) -> Frf:
    """Predict what a hammer test would measure.

    Args:
        model: bodies and links, all stiffnesses known.
        frequency: lines [Hz], shape (n_lines,), ascending.
        kind: receptance, mobility or accelerance.
        outputs: bodies whose motion is wanted; default all.
        inputs: bodies that are struck; default all.

    Returns:
        (K + j omega C - omega^2 M)^-1 times (j omega)^derivatives.

    Raises:
        UsageError: a body that the model does not have.

    Source:
        Appl. Sci. 2023, 13, 11680, eq. (4), for several bodies.
    """
    names = tuple(body.name for body in model.bodies)
    rows, columns = tuple(outputs or names), tuple(inputs or names)
    s = 2j * math.pi * np.asarray(frequency, dtype=float)[:, None, None]
    dynamic = (
        s**2 * mass_matrix(model) + s * damping_matrix(model) + stiffness_matrix(model)
    )
    struck = np.eye(len(names))[:, [model.index(name) for name in columns]]
    response = np.linalg.solve(dynamic, struck) * s**kind.derivatives
    chosen = response[:, [model.index(name) for name in rows], :]
    return Frf(
        frequency=np.asarray(frequency, dtype=float),
        response=np.moveaxis(chosen, 0, -1),
        kind=kind,
        outputs=rows,
        inputs=columns,
        provenance=(step("predict_frf", links=", ".join(_links(model))),),
    )


def _links(model: LumpedModel) -> list[str]:
    return [
        f"{link.name}: {link.stiffness:.6g} N/m, {link.damping:.6g} N s/m"
        for link in model.links
    ]


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


def _require_mass(body: Body) -> None:
    """Raise unless a body weighs what a tested body can weigh."""
    low, high = _MASS_RANGE
    if not low <= body.mass <= high:
        raise UsageError(
            f"mass of body {body.name!r} is {body.mass:g} kg, a body weighs {low:g} to "
            f"{high:g} kg; give it in kg"
        )


def _require_moderate(link: str, what: str, value: float) -> None:
    """Raise where a link is stiffer, or damps more, than doubles can carry."""
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
