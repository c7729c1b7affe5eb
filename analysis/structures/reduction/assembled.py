# SPDX-License-Identifier: MIT
"""Reduced bodies closed over their joints."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.reduction.assembled_response import (
    DampedModes,
    complex_modes,
    receptance,
)
from jointbench.analysis.structures.reduction.component import Component
from jointbench.analysis.structures.reduction.joint_spread import JointSpread
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    frequency_bound,
    solve_reduced,
)
from jointbench.analysis.structures.reduction.residual_norm import (
    JointMotion,
    ResidualNorm,
)

Side = tuple[str, str]
"""Names of a body and of one of its ports."""

# Relative strain energy of a joint, of a motion that is rigid to rounding.
_NO_STRAIN = 1e-18
# Modes beyond the wanted ones in the start of a solution.
_GUESS_SPARE = 4


@dataclass(frozen=True, slots=True)
class PortJoint:
    """Two ports, or a port and the ground, with a stiffness for each direction.

    Attributes:
        name: of the joint.
        first: body and port.
        second: body and port, None is the ground. Motion is that of the first side
            relative to the second.
        directions: the rows of the ports are as many equal groups, in order.
    """

    name: str
    first: Side
    second: Side | None
    directions: tuple[str, ...]

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """``"<joint>.<direction>"``."""
        return tuple(f"{self.name}.{one}" for one in self.directions)


@dataclass(frozen=True, slots=True, eq=False)
class PortSpring:
    """A known spring and damper between two ports, or a port and the ground.

    Attributes:
        name: of the spring.
        first: body and port.
        second: body and port, None is the ground.
        stiffness: symmetric, shape (n_rows, n_rows) [N/m, N/rad, N m/rad].
        damping: the same [N s/m ...].
    """

    name: str
    first: Side
    second: Side | None
    stiffness: FloatArray
    damping: FloatArray

    def __post_init__(self) -> None:
        """Check symmetry and sign."""
        for word, matrix in (("stiffness", self.stiffness), ("damping", self.damping)):
            scale = float(np.abs(matrix).max(initial=0.0))
            if np.abs(matrix - matrix.T).max(initial=0.0) > 1e-9 * scale:
                raise BadData(f"{word} of {self.name!r} is not symmetric")
            least = float(np.linalg.eigvalsh(matrix).min(initial=0.0))
            if least < -1e-9 * scale:
                raise BadData(
                    f"{word} of {self.name!r} has the eigenvalue {least:.3g}; springs "
                    "and dampers must not give energy"
                )
        freeze(self, "stiffness", "damping")


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
        return _number(self.components, body)

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
            rows, columns = _relative(self.components, self.places, spring)
            found[spring.name] = _energy(spring.stiffness, rows[0] @ shape[columns])
        own = values.stiffness * self.model.spread.diagonal(column)[:, 0]
        found |= dict(zip(self.parameter_names, own.tolist(), strict=True))
        whole = sum(found.values())
        return {name: one / whole for name, one in found.items()} if whole else found

    def rows(self, side: Side) -> FloatArray:
        """Return the motion of a port from the coordinates of `model`."""
        return _wide(self.components, self.places, side, self.model.size)


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
    places = _places(bodies)
    size = sum(body.size for body in bodies)
    still = sum(body.rigid for body in bodies)
    motions, strains, moved, blocks = [], [], [], []
    for joint in joints:
        rows, columns = _relative(bodies, places, joint)
        motions.append(_joint_motion(bodies, joint, rows, columns))
        moved.append(columns)
        blocks.append(np.array([own.T @ own for own in rows]))
        strains += [_strain(own, columns, still) for own in rows]
    stiffness, loss, damping = (np.zeros((size, size)) for _ in range(3))
    for body, place in zip(bodies, places, strict=True):
        own = np.ix_(place, place)
        stiffness[own], loss[own] = body.stiffness, body.loss
        damping[own] = body.damping
    held = np.zeros((still, still))
    for spring in springs:
        rows, columns = _relative(bodies, places, spring)
        own = np.ix_(columns, columns)
        held += _strain(_square_root(spring.stiffness) @ rows[0], columns, still)
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


def _number(bodies: Sequence[Component], name: str) -> int:
    names = [body.name for body in bodies]
    if name not in names:
        raise UsageError(f"no body {name!r}; the assembly has {names}")
    return names.index(name)


def _places(bodies: Sequence[Component]) -> tuple[IntArray, ...]:
    """Return the coordinates of each body: rigid ones of all bodies come first."""
    rigid, elastic = 0, sum(body.rigid for body in bodies)
    found = []
    for body in bodies:
        moving = body.size - body.rigid
        found.append(
            np.concatenate(
                [
                    np.arange(rigid, rigid + body.rigid),
                    np.arange(elastic, elastic + moving),
                ]
            )
        )
        rigid, elastic = rigid + body.rigid, elastic + moving
    return tuple(found)


def _sides(joint: PortJoint | PortSpring) -> list[tuple[Side, float]]:
    both = [(joint.first, 1.0)]
    return both if joint.second is None else [*both, (joint.second, -1.0)]


def _wide(
    bodies: Sequence[Component], places: Sequence[IntArray], side: Side, size: int
) -> FloatArray:
    at = _number(bodies, side[0])
    rows = bodies[at].port(side[1])
    wide = np.zeros((rows.shape[0], size))
    wide[:, places[at]] = rows
    return wide


def _relative(
    bodies: Sequence[Component],
    places: Sequence[IntArray],
    joint: PortJoint | PortSpring,
) -> tuple[list[FloatArray], IntArray]:
    """Return the relative motion of each direction, and the coordinates it needs."""
    parts = []
    for side, sign in _sides(joint):
        at = _number(bodies, side[0])
        parts.append((at, sign * bodies[at].port(side[1])))
    counts = {rows.shape[0] for _, rows in parts}
    groups = len(joint.directions) if isinstance(joint, PortJoint) else 1
    if len(counts) > 1 or counts.copy().pop() % max(groups, 1):
        raise BadData(
            f"ports of {joint.name!r} have {sorted(counts)} rows; both sides need the "
            f"same number, a multiple of {groups}"
        )
    used = sorted({at for at, _ in parts})
    columns = np.concatenate([places[at] for at in used])
    start = np.cumsum([0] + [bodies[at].size for at in used])
    rows = np.zeros((counts.pop(), columns.size))
    for at, part in parts:
        begin = int(start[used.index(at)])
        rows[:, begin : begin + part.shape[1]] += part
    return np.split(rows, groups), columns


def _joint_motion(
    bodies: Sequence[Component],
    joint: PortJoint,
    rows: Sequence[FloatArray],
    columns: IntArray,
) -> JointMotion:
    """Split the relative motion into that on the patterns and the rest."""
    patterns, loads, compliance = None, [], 0.0
    for side, sign in _sides(joint):
        at = _number(bodies, side[0])
        residual = bodies[at].residual
        if residual is None:
            continue
        patterns = residual.patterns[side[1]]
        loads.append((at, residual.columns()[side[1]], sign))
        compliance += residual.compliance[side[1]]
    if patterns is None:
        none = np.zeros((len(rows), 0, columns.size))
        return JointMotion(columns, none, none, 0.0, ())
    blocks = pattern_blocks(patterns, len(rows))
    moments = [block.T @ own for block, own in zip(blocks, rows, strict=True)]
    rest = [
        _root(own - block @ moment)
        for own, block, moment in zip(rows, blocks, moments, strict=True)
    ]
    return JointMotion(
        columns, np.array(moments), np.array(rest), compliance, tuple(loads)
    )


def pattern_blocks(patterns: FloatArray, groups: int) -> list[FloatArray]:
    """Return the diagonal blocks of patterns that act in one direction each."""
    count = patterns.shape[1] // groups
    return [
        part[:, at * count : (at + 1) * count]
        for at, part in enumerate(np.split(patterns, groups))
    ]


def _root(rows: FloatArray) -> FloatArray:
    """Return R with R'R = rows' rows, square."""
    size = rows.shape[1]
    if rows.shape[0] < size:
        return np.concatenate([rows, np.zeros((size - rows.shape[0], size))])
    return np.asarray(np.linalg.qr(rows, mode="r"))


def _square_root(matrix: FloatArray) -> FloatArray:
    """Return R with R'R = matrix, positive semi-definite."""
    value, vector = np.linalg.eigh(matrix)
    return np.asarray(np.sqrt(np.maximum(value, 0.0))[:, None] * vector.T)


def _strain(rows: FloatArray, columns: IntArray, still: int) -> FloatArray:
    """Return the strain of a joint by rigid motions: zero, or of trace one."""
    motion = np.zeros((rows.shape[0], still))
    rigid = columns < still
    motion[:, columns[rigid]] = rows[:, rigid]
    _, size, vector = np.linalg.svd(motion, full_matrices=False)
    scale = float((rows**2).sum(axis=0).max(initial=0.0))
    value = np.where(size**2 > _NO_STRAIN * scale, size**2, 0.0)
    whole = float(value.sum())
    strain = np.asarray((vector.T * value) @ vector)
    return strain / whole if whole > 0 else strain
