# SPDX-License-Identifier: MIT
"""Modes between the links of a lumped model, including the linear effects of a fit.

The time integration computes the motion caused by nonlinear link forces. It needs the
poles of the model and its shapes across the links for each record, since a preload, a
settling or an attached oscillator changes them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.response.dynamic_stiffness import Action, state_of
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.port_forces import PortModes
from jointbench.analysis.gap.response.response_settings import RESPONSE
from jointbench.analysis.lumped.lumped_matrices import incidence
from jointbench.analysis.lumped.lumped_model import LumpedModel


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """One element as a rational function of s: k + c s + m s^2 + sum rho/(s - q).

    Attributes:
        across: +1 and -1 at its ends, shape (n_bodies,).
        polynomial: k, c, m, shape (n_records, 3).
        poles: q [rad/s], shape (n_poles,).
        strengths: rho, shape (n_records, n_poles).
    """

    across: FloatArray
    polynomial: FloatArray
    poles: ComplexArray
    strengths: ComplexArray


def link_modes(
    model: LumpedModel,
    theta: FloatArray,
    conditions: HitConditions,
    links: Sequence[int],
    actions: Sequence[Action] = (),
) -> PortModes:
    """Return the modes of a model, with links as ports.

    Args:
        model: bodies and links.
        theta: masses, stiffnesses, dampings [SI], shape (n_base,).
        conditions: of each record.
        links: index of the link at each port; a port's motion is its elongation.
        actions: effects; only those with a stiffness hook are used.

    Returns:
        Poles, one of each conjugate pair, and rows of the ports.
    """
    return _modes(LinearQuery(model, theta, conditions, tuple(links), actions))


class LinearQuery:
    """A linear model with its ports, equal to another one if so to the last bit."""

    __slots__ = ("_key", "actions", "conditions", "links", "model", "theta")

    def __init__(
        self,
        model: LumpedModel,
        theta: FloatArray,
        conditions: HitConditions,
        links: tuple[int, ...],
        actions: Sequence[Action],
    ) -> None:
        linear = tuple(a for a in actions if a.entry.stiffness is not None)
        self.model, self.theta, self.conditions = model, theta, conditions
        self.links, self.actions = links, linear
        settling = conditions.settling
        self._key = (
            # Held by this record, so that no other object takes their place.
            id(model),
            tuple(id(a.entry) for a in linear),
            tuple((a.kind, a.index, a.values.tobytes()) for a in linear),
            theta.tobytes(),
            conditions.preload.tobytes(),
            conditions.progress.tobytes(),
            None if settling is None else settling.tobytes(),
            links,
        )

    def __hash__(self) -> int:
        return hash(self._key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LinearQuery) and self._key == other._key


@lru_cache(maxsize=16)
def _modes(query: LinearQuery) -> PortModes:
    """Return the modes, kept for fits that change the parameters of a law alone."""
    across = incidence(query.model)[list(query.links)]
    return modes_across(
        query.model, query.theta, query.conditions, across, query.actions
    )


def modes_across(
    model: LumpedModel,
    theta: FloatArray,
    conditions: HitConditions,
    across: FloatArray,
    actions: Sequence[Action] = (),
) -> PortModes:
    """Return the modes of a model with any ports.

    Args:
        model: bodies and links.
        theta: masses, stiffnesses, dampings [SI], shape (n_base,).
        conditions: of each record.
        across: share of each body's motion in that of a port, shape (n_ports,
            n_bodies): +1 and -1 at the ends of a link, 1 at a body.
        actions: effects; only those with a stiffness hook are used.

    Returns:
        Poles, one of each conjugate pair, and rows of the ports.
    """
    linear = [a for a in actions if a.entry.stiffness is not None]
    rows = incidence(model)
    parts = _base_parts(model, rows, theta, conditions)
    parts += [_part(model, rows, theta, conditions, action) for action in linear]
    variants = max(p.polynomial.shape[0] for p in parts)
    n = across.shape[1]
    inverse, matrix = _state_matrix(theta[:n], parts, variants)
    poles, right = np.linalg.eig(matrix)
    push = np.zeros((variants, poles.shape[1], len(across)), dtype=np.complex128)
    push[:, n : 2 * n] = inverse @ across.T
    left = np.linalg.solve(right, push)
    shapes = np.einsum("pi,rij->rjp", across, right[:, :n])
    poles, inputs, shapes = _one_of_each_pair(poles, left, shapes)
    repeat = conditions.preload.size // variants
    poles, inputs, shapes = (
        np.ascontiguousarray(
            (np.repeat(x, repeat, axis=0) if repeat > 1 else x).transpose(
                *range(1, x.ndim), 0
            )
        )
        for x in (poles, inputs, shapes)
    )
    return PortModes(poles, inputs, shapes)


def _one_of_each_pair(
    poles: ComplexArray, inputs: ComplexArray, shapes: ComplexArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Keep upper poles, with doubled inputs, and real poles; pad with zeros."""
    size = np.abs(poles) + 1e-300
    upper = poles.imag > RESPONSE.real_pole_share * size
    weight = np.where(
        upper, 2.0, np.where(poles.imag < -RESPONSE.real_pole_share * size, 0.0, 1.0)
    )
    order = np.argsort(-weight, axis=1, kind="stable")
    count = int((weight > 0).sum(axis=1).max())
    rows = np.arange(poles.shape[0])[:, None]
    kept = order[:, :count]
    return (
        poles[rows, kept],
        (inputs * weight[:, :, None])[rows, kept],
        shapes[rows, kept],
    )


def _base_parts(
    model: LumpedModel, rows: FloatArray, theta: FloatArray, conditions: HitConditions
) -> list[_Part]:
    n, links = len(model.bodies), len(model.links)
    nothing = np.zeros(0, dtype=np.complex128)
    parts = []
    for j, link in enumerate(model.links):
        factor = np.ones(1)
        if link.joint and conditions.settling is not None:
            factor = np.exp(conditions.settling)
        polynomial = np.zeros((factor.size, 3))
        polynomial[:, 0] = theta[n + j] * factor
        polynomial[:, 1] = theta[n + links + j]
        none = np.zeros((factor.size, 0), dtype=np.complex128)
        parts.append(_Part(rows[j], polynomial, nothing, none))
    return parts


def _part(
    model: LumpedModel,
    rows: FloatArray,
    theta: FloatArray,
    conditions: HitConditions,
    action: Action,
) -> _Part:
    """Decompose an effect's dynamic stiffness exactly into its rational parts."""
    if action.kind == "body":
        across = np.eye(len(model.bodies))[action.index]
    else:
        across = rows[action.index]
    own = np.zeros(0, dtype=np.complex128)
    if action.entry.poles is not None:
        own = np.asarray(action.entry.poles(action.values), dtype=np.complex128)
    scale = float(np.sqrt(theta[len(model.bodies) :].max() / theta[0]))
    turn = np.arange(2 * (3 + own.size)) + 0.5
    s = np.asarray(scale * (0.3 + 1j * turn / turn.size), dtype=np.complex128)
    columns = [np.ones_like(s), s / scale, (s / scale) ** 2]
    columns += [scale / (s - q) for q in own]
    state = state_of(model, theta, s, conditions, action)
    if action.entry.stiffness is None:
        raise ValueError(f"{action.entry.effect.name} has no stiffness hook")
    added = np.asarray(action.entry.stiffness(state, action.values))
    found = np.linalg.lstsq(np.stack(columns, axis=1), added.T, rcond=None)[0].T
    polynomial = found[:, :3].real / np.array([1.0, scale, scale**2])
    strengths = np.asarray(found[:, 3:] * scale, dtype=np.complex128)
    return _Part(across, polynomial, own, strengths)


def _state_matrix(
    masses: FloatArray, parts: Sequence[_Part], variants: int
) -> tuple[FloatArray, ComplexArray]:
    """Return the inverse of the inertia, shape (variants, n, n), and the state matrix.

    The states are displacements, velocities and internal states of the parts.
    """
    n = masses.size
    size = 2 * n + sum(p.poles.size for p in parts)
    across = np.stack([p.across for p in parts])
    polynomials = np.empty((variants, len(parts), 3))
    for j, p in enumerate(parts):
        polynomials[:, j] = p.polynomial
    stiffness, damping, inertia = (
        (across.T * polynomials[:, None, :, power]) @ across for power in range(3)
    )
    inverse = np.asarray(np.linalg.inv(inertia + np.diag(masses)), dtype=np.float64)
    a = np.zeros((variants, size, size), dtype=np.complex128)
    a[:, :n, n : 2 * n] = np.eye(n)
    a[:, n : 2 * n, :n] = -inverse @ stiffness
    a[:, n : 2 * n, n : 2 * n] = -inverse @ damping
    at = 2 * n
    for p in parts:
        for j, q in enumerate(p.poles):
            push = -p.strengths[:, j, None] * p.across
            a[:, n : 2 * n, at] = (inverse @ push[..., None])[..., 0]
            a[:, at, :n] = p.across
            a[:, at, at] = q
            at += 1
    return inverse, a
