# SPDX-License-Identifier: MIT
"""The norm of the residual of an assembled motion, from small matrices alone.

With A0 = K + shift M of the bodies without joints, K(theta) + shift M >= A0, so the
norm of a residual in the inverse of A0 is an upper bound of its dual norm at any joint
values. The tractions of a joint are split into those of the patterns, whose responses
are known exactly, and the rest, which the largest compliance of the faces bounds; or
the stiffness of the joint itself, since K(theta) >= k R'R.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.structures.reduction.component import Component

Motion = NDArray[Any]
"""Real or complex reduced coordinates as columns."""


@dataclass(frozen=True, slots=True, eq=False)
class JointMotion:
    """Relative motion at a joint from the coordinates of the assembly.

    Attributes:
        columns: coordinates that move it, shape (n_columns,).
        moments: of each direction on the patterns, shape (n_directions, n_patterns,
            n_columns).
        rest: square root of the Gram matrix of what is outside of the patterns, each
            direction, shape (n_directions, n_rank, n_columns).
        compliance: of both sides for tractions outside of the patterns [m/N].
        loads: body and pattern columns of each side, and its sign.
    """

    columns: IntArray
    moments: FloatArray
    rest: FloatArray
    compliance: float
    loads: tuple[tuple[int, slice, float], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Forces:
    """Forces on the bodies of an assembly, as columns.

    Attributes:
        stretched: K times this motion of the bodies, coordinates of the assembly, shape
            (n, m).
        heavy: M times this motion [.. 1/s^2], shape (n, m).
        springs: motions, shape (n, m), and what multiplies the springs of the joints in
            each, shape (n_parameters, m) [N/m].
        loads: body, its pattern columns, and forces on these, shape (n_columns, m).
    """

    stretched: Motion
    heavy: Motion
    springs: tuple[tuple[Motion, Motion], ...]
    loads: tuple[tuple[int, slice, Motion], ...]


@dataclass(frozen=True, slots=True, eq=False)
class ResidualNorm:
    """What the norm of a residual needs.

    Attributes:
        components: of the assembly.
        places: coordinates of each component in the assembly.
        joints: with parameters, in their order.
        turn: from reduced coordinates to those of the assembly, shape (n, r).
        factors: bodies whose stiffness has a factor, in the order of the parameters
            that follow those of the joints.
    """

    components: tuple[Component, ...]
    places: tuple[IntArray, ...]
    joints: tuple[JointMotion, ...]
    turn: FloatArray
    factors: tuple[int, ...] = ()

    def restricted(self, turn: FloatArray) -> "ResidualNorm":
        """Return the norm in fewer coordinates, `turn` from them to the present."""
        return replace(self, turn=self.turn @ turn)

    def of_modes(
        self, shapes: FloatArray, level: FloatArray, stiffness: FloatArray
    ) -> FloatArray:
        """Return the norm for Ritz pairs.

        Args:
            shapes: columns, shape (r, m).
            level: eigenvalues [1/s^2], shape (m,).
            stiffness: of the joints [N/m], shape (n_parameters,).

        Returns:
            Shape (m,).
        """
        values = np.asarray(stiffness, float)
        joints = values[: values.size - len(self.factors)]
        own = values[joints.size :]
        ties = np.repeat(joints[:, None], level.size, axis=1)
        norm = self.of_motion(self.turn @ shapes, -level, ties, joints, own)
        # K of a softer body is at least its factor times the nominal one.
        return np.asarray(norm / np.sqrt(min(1.0, *own, 1.0)))

    def of_motion(
        self,
        motion: Motion,
        inertia: Motion,
        ties: Motion,
        stiffness: FloatArray,
        factors: FloatArray,
    ) -> FloatArray:
        """Return the norm of (K + inertia M + ties) motion.

        Args:
            motion: coordinates of the assembly, shape (n, m).
            inertia: factor of M of each column [1/s^2], shape (m,).
            ties: factor of the joints, k + s c [N/m], shape (n_parameters, m).
            stiffness: real stiffness of the joints [N/m], shape (n_parameters,).
            factors: on the stiffness of bodies, in the order of `factors` [-].

        Returns:
            Shape (m,).
        """
        stretch = np.ones(motion.shape[0])
        for number, factor in zip(self.factors, factors.tolist(), strict=True):
            stretch[self.places[number]] = factor
        forces = Forces(
            stretch[:, None] * motion, inertia * motion, ((motion, ties),), ()
        )
        return self.of_forces(forces, stiffness)

    def of_forces(self, forces: Forces, stiffness: FloatArray) -> FloatArray:
        """Return the norm of forces, an upper bound of their dual norm.

        Args:
            forces: on all bodies.
            stiffness: real stiffness of the joints [N/m], shape (n_parameters,).

        Returns:
            Shape (m,).
        """
        count = forces.heavy.shape[1]
        tractions = self._no_tractions(forces.heavy)
        for number, columns, load in forces.loads:
            tractions[number][columns] += load
        rest = np.zeros(count)
        at = 0
        for joint in self.joints:
            own = np.s_[at : at + joint.moments.shape[0]]
            moved = sum(
                ties[own, None, :] * motion[joint.columns]
                for motion, ties in forces.springs
            )
            moments = (joint.moments @ moved).reshape(-1, count)
            for number, columns, sign in joint.loads:
                tractions[number][columns] += sign * moments
            square = np.sum(np.abs(joint.rest @ moved) ** 2, axis=1)
            rest += _rest_bound(square, stiffness[own], joint.compliance)
            at += joint.moments.shape[0]
        whole = np.zeros(count)
        for body, place, traction in zip(
            self.components, self.places, tractions, strict=True
        ):
            whole += _body_square(
                body, forces.stretched[place], forces.heavy[place], traction
            )
        return np.asarray(np.sqrt(whole) + rest)

    def _no_tractions(self, motion: Motion) -> list[Motion]:
        """Return zero forces on the patterns of each body."""
        kind = np.result_type(motion, float)
        return [
            np.zeros((_pattern_count(body), motion.shape[1]), kind)
            for body in self.components
        ]


def _pattern_count(body: Component) -> int:
    if body.residual is None:
        return sum(rows.shape[0] for rows in body.rows.values())
    return sum(one.shape[1] for one in body.residual.patterns.values())


def _body_square(
    body: Component, stretched: Motion, heavy: Motion, traction: Motion
) -> FloatArray:
    """Return the squared norm of one body's part."""
    if body.residual is None:
        return np.zeros(stretched.shape[1])
    stack = np.concatenate([stretched, heavy, traction])
    return np.asarray(np.sum(np.abs(body.residual.root @ stack) ** 2, axis=0))


def _rest_bound(
    square: FloatArray, stiffness: FloatArray, compliance: float
) -> FloatArray:
    """Bound the norm of tractions outside of the patterns of one joint.

    By the faces' compliance C and the softest direction: C / (1 + k C), as J A^-1 J' of
    A = A0 + k J'J; or by the joint's own stiffness, direction by direction.

    Args:
        square: squared size of these tractions [N^2], shape (n_directions, m).
        stiffness: [N/m], shape (n_directions,).
        compliance: of both sides [m/N].

    Returns:
        Shape (m,).
    """
    soft = compliance / (1.0 + float(stiffness.min(initial=np.inf)) * compliance)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(square > 0, square / stiffness[:, None], 0.0).sum(axis=0)
    return np.asarray(np.sqrt(np.minimum(soft * square.sum(axis=0), own)))
