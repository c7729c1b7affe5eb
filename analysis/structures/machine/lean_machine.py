# SPDX-License-Identifier: MIT
"""A machine in the few coordinates that its variants need.

Glued, jointed, each joint rigid in turn, and joints softer and stiffer by their
uncertainty: the modes of all variants and their static response at the points span a
basis of a few hundred motions, in which every evaluation takes milliseconds.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.machine.complex_modes import (
    PoleSet,
    solve_poles,
    viscous_loss,
)
from jointbench.analysis.structures.machine.reduce_machine import ReducedMachine
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    solve_reduced,
)

# Deviations to either side that the basis holds.
_REACH = 2.0
# Part of a direction outside of the basis below which it is dropped.
_DEPENDENT = 1e-7
# A body takes part in a motion from this share of the largest part on.
_MOVES = 1e-6
# Modes of each variant beyond the band.
_SPARE = 12


@dataclass(frozen=True, slots=True, eq=False)
class Variant:
    """A machine at one set of values.

    Attributes:
        stiffness: of the joints [N/m, N m/rad], shape (n_parameters,).
        damping: of the joints, shape (n_parameters,).
        rigid: numbers of the joints that are rigid.
    """

    stiffness: FloatArray
    damping: FloatArray
    rigid: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "damping")


@dataclass(frozen=True, slots=True, eq=False)
class VariantState:
    """Undamped modes of a variant.

    Attributes:
        eigenvalue: [1/s^2], shape (n,).
        shapes: columns, orthonormal, shape (r, n).
        damping: phi' C phi, loss of the bodies and gyroscopic moments included [1/s],
            shape (n, n).
        loss_damping: the part of each mode that is loss of the bodies [1/s], shape
            (n,).
        rows: motion x, y, z of all points in each mode, shape (n_rows, n).
        static: flexibility from and to all points [m/N], shape (n_rows, n_rows).
    """

    eigenvalue: FloatArray
    shapes: FloatArray
    damping: FloatArray
    loss_damping: FloatArray
    rows: FloatArray
    static: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "eigenvalue", "shapes", "damping", "loss_damping", "rows")
        freeze(self, "static")

    @property
    def poles(self) -> PoleSet:
        """All poles of these modes; modes that are left out respond statically."""
        found = solve_poles(self.eigenvalue, self.damping, self.rows, self.rows)
        known = (self.rows / self.eigenvalue) @ self.rows.T
        return replace(found, residual=self.static - known)


@dataclass(frozen=True, slots=True, eq=False)
class LeanMachine:
    """A machine in few coordinates.

    Attributes:
        machine: of which it is a part.
        model: in these coordinates.
        turn: from them to those of the assembly, shape (n, r).
        points: motion x, y, z of each point, shape (3, r), by name.
        gyroscopic: of the bodies that turn [1/s], shape (r, r).
    """

    machine: ReducedMachine
    model: ReducedModel
    turn: FloatArray
    points: Mapping[str, FloatArray]
    gyroscopic: FloatArray

    def state(self, variant: Variant, modes: int | None = None) -> VariantState:
        """Return the undamped modes of a variant.

        Args:
            variant: its values.
            modes: number of modes; None is all.

        Raises:
            BadData: a body floats.
        """
        values = self.machine.parameters(variant.stiffness, variant.rigid)
        count = self.model.size if modes is None else min(modes, self.model.size)
        found = solve_reduced(self.model, values, count)
        if found.rigid:
            raise BadData(self._floating(found.shapes[:, : found.rigid]))
        shapes = found.shapes
        flex = self.model.spread.between(shapes)[: variant.damping.size]
        damping = np.tensordot(variant.damping, flex, 1)
        damping += shapes.T @ (self.model.damping + self.gyroscopic) @ shapes
        loss = viscous_loss(found.eigenvalue, shapes.T @ self.model.loss @ shapes)
        damping += np.diag(loss)
        rows = np.concatenate(list(self.points.values()))
        static = rows @ np.linalg.solve(self.model.with_joints(values), rows.T)
        return VariantState(
            found.eigenvalue, shapes, damping, loss, rows @ shapes, static
        )

    def _floating(self, motions: FloatArray) -> str:
        """Return the message on bodies that motions without strain move."""
        moved = self.turn @ motions
        parts = [float((moved[one.place] ** 2).sum()) for one in self.machine.bodies]
        names = [
            repr(body.name)
            for body, part in zip(self.machine.bodies, parts, strict=True)
            if part > _MOVES * max(parts)
        ]
        return (
            f"{', '.join(names)} can move in {motions.shape[1]} ways without strain (a "
            "body floats): hold it by a support, a joint or a spring with stiffness in "
            "these directions"
        )


def lean_machine(machine: ReducedMachine, band_hz: float) -> LeanMachine:
    """Return a machine in the coordinates that its variants need.

    Args:
        machine: over all coordinates of its bodies.
        band_hz: highest frequency of interest [Hz].

    Returns:
        The machine in few coordinates.
    """
    whole = machine.assembled.model
    still = whole.strains.shape[1]
    rows = np.concatenate(list(machine.points.values()))
    columns = [np.zeros((whole.size, 0))]
    for variant in _machine_variants(machine):
        values = machine.parameters(variant.stiffness, variant.rigid)
        found = solve_reduced(whole, values, whole.size)
        count = int(np.searchsorted(found.natural_frequency, band_hz)) + _SPARE
        columns.append(found.shapes[:, :count])
        level = found.eigenvalue + whole.shift
        columns.append((found.shapes / level) @ (rows @ found.shapes).T)
    turn = _basis(np.concatenate(columns, axis=1), still)
    return LeanMachine(
        machine,
        whole.restricted(turn),
        turn,
        {name: own @ turn for name, own in machine.points.items()},
        turn.T @ machine.gyroscopic @ turn,
    )


def whole_machine(machine: ReducedMachine) -> LeanMachine:
    """Return a machine in all coordinates of its bodies."""
    model = machine.assembled.model
    return LeanMachine(
        machine, model, np.eye(model.size), machine.points, machine.gyroscopic
    )


def _machine_variants(machine: ReducedMachine) -> list[Variant]:
    """Return glued, jointed, each joint rigid alone, softer and stiffer."""
    nominal, damping = machine.stiffness, machine.damping
    everything = tuple(range(machine.rigid.size))
    found = [glued(machine), jointed(machine)]
    if len(everything) > 1:
        found += [Variant(nominal, damping, (one,)) for one in everything]
    spread = _REACH * log_deviation(machine.deviations[0])
    if spread.any():
        found += [
            Variant(nominal * np.exp(sign * spread), damping) for sign in (-1.0, 1.0)
        ]
    return found


def jointed(machine: ReducedMachine) -> Variant:
    """Return the machine at its nominal values."""
    return Variant(machine.stiffness, machine.damping)


def glued(machine: ReducedMachine) -> Variant:
    """Return the machine with rigid joints, whose dampers do not move."""
    everything = tuple(range(machine.rigid.size))
    return Variant(machine.stiffness, np.zeros_like(machine.damping), everything)


def log_deviation(relative: FloatArray) -> FloatArray:
    """Return the deviation of the logarithm of a log-normal value [-].

    Args:
        relative: standard deviation over mean [-].
    """
    return np.asarray(np.sqrt(np.log1p(relative**2)))


def _basis(columns: FloatArray, still: int) -> FloatArray:
    """Return orthonormal columns: the first coordinates, then what remains of all."""
    rest = columns.copy()
    rest[:still] = 0.0
    size = np.linalg.norm(rest, axis=0)
    rest = rest / np.where(size > 0.0, size, 1.0)
    vector, value, _ = np.linalg.svd(rest, full_matrices=False)
    kept = vector[:, value > _DEPENDENT * value[0]]
    return np.asarray(np.concatenate([np.eye(columns.shape[0], still), kept], axis=1))
