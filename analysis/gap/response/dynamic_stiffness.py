# SPDX-License-Identifier: MIT
"""Dynamic stiffness of lumped bodies and links, including effects."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.response.effect_hooks import (
    ElementState,
    HitConditions,
    LumpedEffect,
)
from jointbench.analysis.lumped.lumped_model import LumpedModel


@dataclass(frozen=True, slots=True)
class Action:
    """A catalogue entry at a site with its values [SI].

    Attributes:
        entry: the entry.
        kind: ``"link"``, ``"body"`` or ``"channel"``.
        index: of the link, body or channel; -1 for every channel.
        values: shape (n_parameters,).
    """

    entry: LumpedEffect
    kind: str
    index: int
    values: FloatArray


def dynamic_stiffness(
    model: LumpedModel,
    theta: FloatArray,
    s: ComplexArray,
    conditions: HitConditions,
    actions: Sequence[Action],
) -> ComplexArray:
    """Assemble the dynamic stiffness.

    Args:
        model: bodies and links.
        theta: masses, stiffnesses, dampings [SI], shape (n_base,).
        s: Laplace variable [rad/s], shape (n_lines,).
        conditions: of each record.
        actions: effects; those without a stiffness hook are ignored.

    Returns:
        [N/m], shape (n_bodies, n_bodies, 1 or n_records, n_lines).
    """
    n, links = len(model.bodies), len(model.links)
    square = (s * s)[None, :]
    elements: list[tuple[tuple[int, ...], ComplexArray]] = [
        ((i,), theta[i] * square) for i in range(n)
    ]
    for j, link in enumerate(model.links):
        ends = tuple(e for e in model.ends(j) if e >= 0)
        stiffness = (theta[n + j] + theta[n + links + j] * s)[None, :]
        if link.joint and conditions.settling is not None:
            rise = theta[n + j] * np.expm1(conditions.settling)
            stiffness = stiffness + rise[:, None]
        elements.append((ends, stiffness))
    for action in actions:
        if action.entry.stiffness is None:
            continue
        state = state_of(model, theta, s, conditions, action)
        added = action.entry.stiffness(state, action.values)
        if action.kind == "body":
            elements.append(((action.index,), added))
        else:
            ends = tuple(e for e in model.ends(action.index) if e >= 0)
            elements.append((ends, added))
    return _assembled(n, elements)


def _assembled(
    n: int, elements: Sequence[tuple[tuple[int, ...], ComplexArray]]
) -> ComplexArray:
    """Add elements between bodies, or between a body and the ground.

    Returns:
        [N/m], shape (n, n, 1 or n_records, n_lines), symmetric in the bodies.
    """
    # Those common to all records first: their sums are short.
    ordered = sorted(elements, key=lambda element: element[1].shape[0])
    variants, lines = ordered[-1][1].shape[0], ordered[0][1].shape[1]
    z = np.empty((n, n, variants, lines), dtype=np.complex128)
    for a in range(n):
        _add([value for ends, value in ordered if a in ends], z[a, a])
        for b in range(a):
            _add([v for ends, v in ordered if a in ends and b in ends], z[a, b])
            np.negative(z[a, b], out=z[b, a])
            z[a, b] = z[b, a]
    return z


def _add(values: Sequence[ComplexArray], out: ComplexArray) -> None:
    """Write the sum of values, the short ones first, to a larger array."""
    if len(values) < 2:
        out[...] = values[0] if values else 0.0
        return
    total = values[0]
    for value in values[1:-1]:
        total = total + value
    np.add(total, values[-1], out=out)


def state_of(
    model: LumpedModel,
    theta: FloatArray,
    s: ComplexArray,
    conditions: HitConditions,
    action: Action,
) -> ElementState:
    """Return the inputs of an effect's hook at Laplace variables `s`."""
    n, links = len(model.bodies), len(model.links)
    body = action.kind == "body"
    return ElementState(
        s=s,
        mass=float(theta[action.index]) if body else 0.0,
        stiffness=0.0 if body else float(theta[n + action.index]),
        damping=0.0 if body else float(theta[n + links + action.index]),
        conditions=conditions,
    )


def invert(z: ComplexArray) -> ComplexArray:
    """Invert dynamic stiffnesses, shape (n, n, ...): closed form up to two bodies."""
    if z.shape[0] == 1:
        return 1.0 / z
    if z.shape[0] == 2:
        scale = 1.0 / (z[0, 0] * z[1, 1] - z[0, 1] * z[1, 0])
        out = np.empty_like(z)
        np.multiply(z[1, 1], scale, out=out[0, 0])
        np.multiply(z[0, 0], scale, out=out[1, 1])
        np.negative(scale, out=scale)
        np.multiply(z[0, 1], scale, out=out[0, 1])
        np.multiply(z[1, 0], scale, out=out[1, 0])
        return out
    moved = np.moveaxis(z, (0, 1), (-2, -1))
    inverse: ComplexArray = np.linalg.inv(moved).astype(np.complex128)
    return np.moveaxis(inverse, (-2, -1), (0, 1))
