# SPDX-License-Identifier: MIT
"""Reduced bodies closed over their joints."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.reduction.assembled_response import (
    DampedModes,
    complex_modes,
    frf_bound,
    receptance,
)
from jointbench.analysis.structures.reduction.component import Component
from jointbench.analysis.structures.reduction.joint_spread import JointSpread
from jointbench.analysis.structures.reduction.port_joints import (
    PortJoint,
    PortSpring,
    Side,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    frequency_bound,
    solve_reduced,
)
from jointbench.analysis.structures.reduction.relative_motion import (
    body_number,
    body_places,
    joint_motion,
    port_rows,
    relative_rows,
    rigid_strain,
)
from jointbench.analysis.structures.reduction.residual_norm import (
    ResidualNorm,
)

# Modes beyond the wanted ones in the start of a solution.
_GUESS_SPARE = 4


@dataclass(frozen=True, slots=True, eq=False)
class Assembled:
    """Reduced bodies and joints.

    Attributes:
        components: reduced bodies.
        joints: with parameters.
        springs: without parameters.
        places: coordinates of each body; rigid motions of all bodies come first.
        model: matrices over all coordinates of the bodies.
    """

    components: tuple[Component, ...]
    joints: tuple[PortJoint, ...]
    springs: tuple[PortSpring, ...]
    places: tuple[IntArray, ...]
    model: ReducedModel

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """``"<joint>.<direction>"``, joint by joint."""
        return self.model.names

    def number(self, body: str) -> int:
        """Return the place of a body.

        Raises:
            UsageError: there is no such body.
        """
        return body_number(self.components, body)

    def modes(self, values: JointValues, count: int) -> tuple[FloatArray, FloatArray]:
        """Return natural frequencies [Hz] and shapes of the lowest modes.

        Args:
            values: of the joints.
            count: number of modes, rigid ones included.

        Returns:
            Frequencies without damping, shape (count,), and mass-normalised shapes in
            the coordinates of `model`, shape (r, count).
        """
        found = solve_reduced(self.model, values.stiffness, count)
        return found.natural_frequency, found.shapes

    def bound(self, values: JointValues, count: int) -> FloatArray:
        """Return the largest error of these frequencies [Hz], see `frequency_bound`."""
        return frequency_bound(self.model, values.stiffness, count)[1]

    def complex_modes(self, values: JointValues) -> DampedModes:
        """Return modes with the dampers of the joints, see `complex_modes`."""
        return complex_modes(self.model, values)

    def frf(
        self,
        values: JointValues,
        frequency: FloatArray,
        outputs: FloatArray,
        inputs: FloatArray,
    ) -> ComplexArray:
        """Return receptances [m/N].

        Args:
            values: of the joints.
            frequency: lines [Hz], shape (n_lines,).
            outputs: of `rows`, shape (n_outputs, r).
            inputs: of `rows`, shape (n_inputs, r).

        Returns:
            Shape (n_outputs, n_inputs, n_lines).
        """
        lines = np.asarray(2j * np.pi * frequency, complex)
        return receptance(self.model, values, lines, outputs, inputs)

    def frf_bound(
        self, values: JointValues, frequency: FloatArray, side: Side
    ) -> FloatArray:
        """Bound the error of receptances between the rows of a port [m/N].

        Args:
            values: of the joints.
            frequency: lines [Hz], shape (n_lines,); the highest is that of `frf`.
            side: body and port.

        Returns:
            Against the full mesh, shape (n_rows, n_rows, n_lines).
        """
        omega = np.asarray(2.0 * np.pi * frequency)
        number = self.number(side[0])
        residual = self.components[number].residual
        rows = self.rows(side)
        columns = slice(0, len(rows))
        if residual is not None:
            columns = residual.columns()[side[1]]
        return frf_bound(self.model, values, omega, rows, (number, columns))

    def energy(self, values: JointValues, shape: FloatArray) -> dict[str, float]:
        """Return the share of the strain energy of a shape by joint and body [-].

        Args:
            values: of the joints.
            shape: in the coordinates of `model`, shape (r,).

        Returns:
            Names of bodies, of springs and of joint parameters, with shares that sum to
            one.
        """
        column = shape[:, None]
        found = {
            body.name: _energy(body.stiffness, shape[place])
            for body, place in zip(self.components, self.places, strict=True)
        }
        for spring in self.springs:
            rows, columns = relative_rows(self.components, self.places, spring)
            found[spring.name] = _energy(spring.stiffness, rows[0] @ shape[columns])
        own = values.stiffness * self.model.spread.diagonal(column)[:, 0]
        found |= dict(zip(self.parameter_names, own.tolist(), strict=True))
        whole = sum(found.values())
        return {name: one / whole for name, one in found.items()} if whole else found

    def rows(self, side: Side) -> FloatArray:
        """Return the motion of a port from the coordinates of `model`."""
        return port_rows(self.components, self.places, side, self.model.size)


def assemble_components(
    components: Sequence[Component],
    joints: Sequence[PortJoint],
    springs: Sequence[PortSpring] = (),
    *,
    box: tuple[float, float],
    modes: int,
) -> Assembled:
    """Close reduced bodies over their joints.

    Args:
        components: reduced bodies with different names and one shift.
        joints: with parameters.
        springs: without parameters.
        box: smallest and largest stiffness of any joint and direction [N/m].
        modes: number of modes that are wanted, rigid ones included.

    Returns:
        The assembly, in all coordinates of the bodies.

    Raises:
        BadData: ports of a joint do not fit each other, or the bodies were reduced with
            different shifts.
        UsageError: there is no such body or port.
    """
    bodies = tuple(components)
    shift = _common_shift(bodies)
    places = body_places(bodies)
    size = sum(body.size for body in bodies)
    still = sum(body.rigid for body in bodies)
    motions, strains, moved, blocks = [], [], [], []
    for joint in joints:
        rows, columns = relative_rows(bodies, places, joint)
        motions.append(joint_motion(bodies, joint, rows, columns))
        moved.append(columns)
        blocks.append(np.array([own.T @ own for own in rows]))
        strains += [rigid_strain(own, columns, still) for own in rows]
    stiffness, loss, damping = (np.zeros((size, size)) for _ in range(3))
    for body, place in zip(bodies, places, strict=True):
        own = np.ix_(place, place)
        stiffness[own], loss[own] = body.stiffness, body.loss
        damping[own] = body.damping
    held = np.zeros((still, still))
    for spring in springs:
        rows, columns = relative_rows(bodies, places, spring)
        own = np.ix_(columns, columns)
        held += rigid_strain(_square_root(spring.stiffness) @ rows[0], columns, still)
        stiffness[own] += rows[0].T @ spring.stiffness @ rows[0]
        damping[own] += rows[0].T @ spring.damping @ rows[0]
    names = tuple(name for joint in joints for name in joint.parameter_names)
    model = ReducedModel(
        stiffness=stiffness,
        spread=JointSpread(size, tuple(moved), tuple(blocks)),
        loss=loss,
        damping=damping,
        residual=ResidualNorm(bodies, places, tuple(motions), np.eye(size)),
        strains=np.array(strains).reshape(-1, still, still),
        shift=shift,
        box=box,
        modes=modes,
        names=names,
        fixed_strain=held if springs else None,
    )
    model = replace(model, guess=_guess(model))
    return Assembled(bodies, tuple(joints), tuple(springs), places, model)


def _guess(model: ReducedModel) -> FloatArray:
    """Return the modes in the middle of the box: a start for those at any joints."""
    middle = np.full(len(model.names), float(np.sqrt(model.box[0] * model.box[1])))
    count = min(model.modes + _GUESS_SPARE, model.size)
    return solve_reduced(model, middle, count).shapes


def _energy(stiffness: FloatArray, motion: FloatArray) -> float:
    return float(motion @ stiffness @ motion)


def _common_shift(bodies: Sequence[Component]) -> float:
    found = {body.residual.shift for body in bodies if body.residual is not None}
    if len(found) > 1:
        raise BadData(
            f"bodies were reduced with shifts {sorted(found)} 1/s^2; reduce all of "
            "them for one band"
        )
    return found.pop() if found else 1.0


def _square_root(matrix: FloatArray) -> FloatArray:
    """Return R with R'R = matrix, positive semi-definite."""
    value, vector = np.linalg.eigh(matrix)
    return np.asarray(np.sqrt(np.maximum(value, 0.0))[:, None] * vector.T)
