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
        tractions = self._no_tractions(motion)
        stretch = np.ones(len(self.components))
        stretch[list(self.factors)] = factors
        rest = np.zeros(motion.shape[1])
        at = 0
        for joint in self.joints:
            count = joint.moments.shape[0]
            own = np.s_[at : at + count]
            moved = motion[joint.columns]
            moments = joint.moments @ moved
            for number, columns, sign in joint.loads:
                one = ties[own, None, :] * moments
                tractions[number][columns] += sign * one.reshape(-1, motion.shape[1])
            left = np.sum(np.abs(joint.rest @ moved) ** 2, axis=1)
            rest += _rest_bound(left, ties[own], stiffness[own], joint.compliance)
            at += count
        whole = np.zeros(motion.shape[1])
        for number, (place, traction) in enumerate(
            zip(self.places, tractions, strict=True)
        ):
            part = _body_square(
                self.components[number],
                stretch[number] * motion[place],
                inertia * motion[place],
                traction,
            )
            whole += part
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
    left: FloatArray, ties: Motion, stiffness: FloatArray, compliance: float
) -> FloatArray:
    """Bound the norm of tractions outside of the patterns of one joint.

    By the faces' compliance C and the softest direction: C / (1 + k C), as J A^-1 J' of
    A = A0 + k J'J; or by the joint's own stiffness, direction by direction.

    Args:
        left: squared relative motion outside of the patterns, shape (n_directions, m).
        ties: [N/m], shape (n_directions, m).
        stiffness: [N/m], shape (n_directions,).
        compliance: of both sides [m/N].

    Returns:
        Shape (m,).
    """
    square = np.abs(ties) ** 2 * left
    soft = compliance / (1.0 + float(stiffness.min(initial=np.inf)) * compliance)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(square > 0, square / stiffness[:, None], 0.0).sum(axis=0)
    return np.asarray(np.sqrt(np.minimum(soft * square.sum(axis=0), own)))
