# SPDX-License-Identifier: MIT
"""Equations of motion of lumped bodies, assembled independently for the second route.

Mass, stiffness and damping matrices of every record come from the effects' parameters,
with an oscillator hung on as a further body; the fast route has dynamic stiffnesses
instead, and no matrices.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.excitation import Excitation
from jointbench.analysis.gap.second_method.laws import (
    ContinuousLaw,
    has_law,
    law_of,
    values_by_name,
)
from jointbench.analysis.lumped.lumped_model import LumpedModel

LINEAR = (
    "added_mass",
    "extra_damping",
    "hidden_mode",
    "preload_stiffness",
    "preload_damping",
    "loosening",
)
"""Effects that change the matrices."""


@dataclass(slots=True, eq=False)
class Matrices:
    """Matrices of each record while effects are being added.

    Attributes:
        mass: of each body, hidden ones last [kg], shape (n_records, n).
        stiffness: [N/m], shape (n_records, n, n).
        damping: [N s/m], same shape.
    """

    mass: FloatArray
    stiffness: FloatArray
    damping: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class System:
    """Equations of motion of all records.

    Attributes:
        mass: shape (n_records, n).
        stiffness: over the mass of its row [1/s^2], shape (n_records, n, n).
        damping: over the mass of its row [1/s], same shape.
        input: force on each body over its mass [1/kg], shape (n_records, n).
        laws: of links.
        ends: elongation of each law per motion, shape (n_laws, n).
    """

    mass: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    input: FloatArray
    laws: tuple[ContinuousLaw, ...]
    ends: FloatArray

    @property
    def width(self) -> int:
        """Number of states of a record."""
        return 2 * int(self.mass.shape[1]) + sum(law.states for law in self.laws)

    def rates(self, force: FloatArray, state: FloatArray) -> FloatArray:
        """Return the rates of the states, acceleration after velocity.

        Args:
            force: on the body that was hit [N], shape (..., n_records).
            state: displacements, velocities, states of the laws, shape
                (..., n_records, width).
        """
        n = self.mass.shape[1]
        x, v = state[..., :n], state[..., n : 2 * n]
        acceleration = force[..., None] * self.input
        acceleration -= _applied(self.stiffness, x) + _applied(self.damping, v)
        parts, at = [v, acceleration], 2 * n
        for law, ends in zip(self.laws, self.ends, strict=True):
            r, speed, own = x @ ends, v @ ends, state[..., at : at + law.states]
            acceleration -= law.force(r, speed, own)[..., None] * ends / self.mass
            if law.states:
                parts.append(law.rate(r, speed, own))
                at += law.states
        return np.concatenate(parts, axis=-1)


def _applied(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return each record's matrix times its vector, shape (..., n_records, n)."""
    if len(matrices) == 1:
        return np.asarray(vectors @ matrices[0].T)
    return np.asarray((matrices @ vectors[..., None])[..., 0])


def make_system(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action],
) -> System:
    """Put the equations of motion together.

    Args:
        model: bodies and links.
        theta: base parameters [SI], shape (n_base,).
        excitation: which body was hit, under which conditions.
        actions: effects on links and bodies; those on channels are passed over.

    Raises:
        UsageError: an effect of the catalogue has no second route.
    """
    moving = [a for a in actions if a.kind != "channel"]
    bent = [a for a in moving if has_law(a)]
    hidden = [a for a in moving if _name(a) == "hidden_mode" and a.values[0] > 0]
    matrices = _base_matrices(model, theta, excitation, len(hidden))
    for k, action in enumerate(hidden):
        _attach(matrices, action, len(model.bodies) + k)
    for action in moving:
        if not has_law(action) and _name(action) != "hidden_mode":
            _change(matrices, model, theta, excitation, action)
    total = matrices.mass.shape[1]
    rows = np.arange(excitation.hit.size)
    push = np.zeros_like(matrices.mass)
    push[rows, excitation.hit] = 1.0 / matrices.mass[rows, excitation.hit]
    return System(
        mass=matrices.mass,
        stiffness=matrices.stiffness / matrices.mass[:, :, None],
        damping=matrices.damping / matrices.mass[:, :, None],
        input=push,
        laws=tuple(law_of(a) for a in bent),
        ends=np.array([_ends(model, a.index, total) for a in bent]).reshape(-1, total),
    )


def _name(action: Action) -> str:
    return action.entry.effect.name


def _ends(model: LumpedModel, link: int, total: int) -> FloatArray:
    """Return the elongation of a link per motion of each body, shape (total,)."""
    e = np.zeros(total)
    first, second = model.ends(link)
    e[second] = 1.0
    if first >= 0:
        e[first] = -1.0
    return e


def _base_matrices(
    model: LumpedModel, theta: FloatArray, excitation: Excitation, hidden: int
) -> Matrices:
    n, links = len(model.bodies), len(model.links)
    total, records = n + hidden, excitation.hit.size
    mass = np.ones((records, total))
    mass[:, :n] = theta[:n]
    matrices = Matrices(
        mass, np.zeros((records, total, total)), np.zeros((records, total, total))
    )
    settling = excitation.conditions.settling
    for j, link in enumerate(model.links):
        e = _ends(model, j, total)
        settled = np.ones(records)
        if link.joint and settling is not None:
            settled = np.exp(settling)
        square = np.outer(e, e)
        matrices.stiffness += theta[n + j] * settled[:, None, None] * square
        matrices.damping += theta[n + links + j] * square
    return matrices


def _attach(matrices: Matrices, action: Action, index: int) -> None:
    """Hang an oscillator, the body of that index, on a body."""
    p = values_by_name(action)
    omega = 2 * np.pi * p["f"]
    e = np.zeros(matrices.mass.shape[1])
    e[index], e[action.index] = 1.0, -1.0
    matrices.mass[:, index] = p["m"]
    matrices.stiffness += p["m"] * omega**2 * np.outer(e, e)
    matrices.damping += 2 * p["zeta"] * omega * p["m"] * np.outer(e, e)


def _change(
    matrices: Matrices,
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    action: Action,
) -> None:
    """Change matrices by a linear effect."""
    name, p = _name(action), values_by_name(action)
    n, links, at = len(model.bodies), len(model.links), action.index
    conditions = excitation.conditions
    if name == "added_mass":
        matrices.mass[:, at] += p["m"]
        return
    if name == "extra_damping":
        matrices.damping[:, at, at] += p["c"]
        return
    if name not in LINEAR:
        raise UsageError(
            f"effect {name!r} has no second route; write what it does to the "
            "matrices in jointbench.analysis.gap.second_method.system beside "
            f"{', '.join(LINEAR)}"
        )
    e = _ends(model, at, matrices.mass.shape[1])
    square = np.outer(e, e)
    if name == "preload_damping":
        rise = theta[n + links + at] * (conditions.preload ** p["n"] - 1.0)
        matrices.damping += rise[:, None, None] * square
    elif name == "preload_stiffness":
        rise = theta[n + at] * (conditions.preload ** p["n"] - 1.0)
        matrices.stiffness += rise[:, None, None] * square
    else:
        loss = theta[n + at] * p["frac"] * conditions.progress
        matrices.stiffness -= loss[:, None, None] * square
