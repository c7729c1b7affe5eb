# SPDX-License-Identifier: MIT
"""Each body of a machine reduced once, then closed over joints and springs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.structures.machine.body_geometry import (
    Surface,
    orthonormal_motions,
)
from jointbench.analysis.structures.machine.machine_bodies import (
    RawBody,
    beam_bodies,
    link_joint,
    rigid_bodies,
    rows_of_point,
    solid_bodies,
    spring_joint,
)
from jointbench.analysis.structures.machine.machine_parts import (
    JointSetting,
    Machine,
    MachineSpring,
)
from jointbench.analysis.structures.machine.measured_parts import (
    MachineLink,
    MeasuredPart,
    rigid_link_stiffness,
)
from jointbench.analysis.structures.machine.rigid_joints import (
    rigid_joint,
    rigid_stiffness,
)
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.reduction.assembled import (
    Assembled,
    assemble_components,
)
from jointbench.analysis.structures.reduction.component import (
    Component,
    point_port,
)
from jointbench.analysis.structures.reduction.port_joints import PortJoint, Side
from jointbench.analysis.structures.reduction.reduce_body import reduce_body
from jointbench.analysis.structures.reduction.reduction_cache import (
    body_key,
    cached_component,
)

MACHINE_MODES = 30
"""Modes that the assembly of a machine is asked for."""

MACHINE_BOX = (1e5, 1e11)
"""Stiffness of its joints [N/m]."""


@dataclass(frozen=True, slots=True, eq=False)
class MachineBody:
    """A body in the coordinates of the assembly.

    Attributes:
        name: of the body; glued ones are joined by ``"+"``.
        place: its coordinates among those of the assembly, shape (r,).
        stiffness: of the body alone in them [1/s^2], shape (r, r).
        rigid: parts of the kinetic energy in three displacements and three rotations,
            see `orthonormal_motions`, shape (6, r).
        surfaces: for pictures, with names.
        motions: of the nodes of each surface, shape (3 n, r).
        gyroscopic: of a turn about its axis at 1 rad/s [1], shape (r, r).
    """

    name: str
    place: IntArray
    stiffness: FloatArray
    rigid: FloatArray
    surfaces: tuple[tuple[str, Surface], ...]
    motions: tuple[FloatArray, ...]
    gyroscopic: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "place", "stiffness", "rigid", "gyroscopic")


@dataclass(frozen=True, slots=True, eq=False)
class ReducedMachine:
    """A machine over the coordinates of its reduced bodies.

    Attributes:
        assembled: bodies closed over joints.
        bodies: for energies, shapes and pictures.
        stiffness: nominal values [N/m, N m/rad], shape (n_parameters,).
        damping: nominal values, shape (n_parameters,).
        deviations: relative standard deviations of both, shape (2, n_parameters) [-].
        joints: with springs.
        rigid: stiffness that makes each joint rigid, zero otherwise; these parameters
            of the assembly follow the nominal ones, shape (n_joints,) [N/m].
        points: motion x, y, z of each point, shape (3, r), by name.
        sides: body and port of each point, by name.
        freedoms: of the meshes and beams before the reduction.
        speeds: of the bodies that turn, by name [rad/s].
        measured: bodies that were measured alone, the last ones.
        band_hz: highest frequency of interest [Hz].
    """

    assembled: Assembled
    bodies: tuple[MachineBody, ...]
    stiffness: FloatArray
    damping: FloatArray
    deviations: FloatArray
    joints: tuple[PortJoint, ...]
    rigid: FloatArray
    points: Mapping[str, FloatArray]
    sides: Mapping[str, Side]
    freedoms: int
    speeds: Mapping[str, float]
    measured: tuple[MeasuredPart, ...] = ()
    band_hz: float = 0.0

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "damping", "deviations", "rigid")

    @property
    def joint_of(self) -> IntArray:
        """Number of the joint of every nominal value, shape (n_parameters,)."""
        counts = [len(joint.directions) for joint in self.joints]
        return np.repeat(np.arange(len(counts)), counts)

    @property
    def gyroscopic(self) -> FloatArray:
        """G at the speeds of the bodies [1/s], antisymmetric, shape (n, n)."""
        found = np.zeros((self.assembled.model.size,) * 2)
        for one in self.bodies:
            speed = self.speeds.get(one.name, 0.0)
            if speed:
                found[np.ix_(one.place, one.place)] += speed * one.gyroscopic
        return found

    def parameters(
        self, stiffness: FloatArray, rigid: Sequence[int] = ()
    ) -> FloatArray:
        """Return the parameters of the assembly.

        Args:
            stiffness: of the joints, shape (n_parameters,).
            rigid: numbers of joints that are rigid.
        """
        held = np.zeros(self.rigid.size)
        held[list(rigid)] = self.rigid[list(rigid)]
        return np.concatenate([stiffness, held])


def reduce_machine(
    machine: Machine, band_hz: float, *, cache: Path | None = None
) -> ReducedMachine:
    """Reduce every body of a machine once and close them over their joints.

    Args:
        machine: its parts.
        band_hz: highest frequency of interest [Hz].
        cache: folder that keeps reduced bodies by content.

    Returns:
        The machine in reduced coordinates.

    Raises:
        BadData: a piece of a body has no nodes, a point is not on its body, a body
            cannot be factored.
    """
    raw, joints = solid_bodies(machine)
    raw |= beam_bodies(machine) | rigid_bodies(machine)
    extra = [spring_joint(machine, raw, one) for one in machine.springs]
    point_of: dict[str, Side] = {}
    for name in machine.points:
        body, rows = rows_of_point(machine, name)
        raw[body].ports.append(point_port(f"point {name}", Sparse(rows[:3])))
        point_of[name] = (body, f"point {name}")
    links = [link_joint(machine, raw, one) for one in machine.links]
    every = (*joints, *extra, *links)
    rigid = [rigid_joint(raw, one) for one in (*joints, *extra)]
    rigid += [replace(one, name=f"{one.name} rigid") for one in links]
    components = [_reduced(one, band_hz, cache) for one in raw.values()]
    components += [one.component(band_hz) for one in machine.measured]
    assembled = assemble_components(
        components, [*every, *rigid], box=MACHINE_BOX, modes=MACHINE_MODES
    )
    values = nominal_values(machine.settings, (*machine.springs, *machine.links), every)
    held = [rigid_stiffness(raw, one) for one in (*joints, *extra)]
    held += [rigid_link_stiffness(components, one) for one in machine.links]
    meshed = [
        _machine_body(one, component, place)
        for one, component, place in zip(
            raw.values(), components, assembled.places, strict=False
        )
    ]
    return ReducedMachine(
        assembled=assembled,
        bodies=(*meshed, *_measured_bodies(assembled, len(meshed))),
        stiffness=values[0],
        damping=values[1],
        deviations=values[2:],
        joints=tuple(every),
        rigid=np.array(held),
        points={name: assembled.rows(side) for name, side in point_of.items()},
        sides=point_of,
        freedoms=sum(one.matrices.mass.shape[0] for one in raw.values()),
        speeds=machine.speeds,
        measured=machine.measured,
        band_hz=band_hz,
    )


def _measured_bodies(assembled: Assembled, first: int) -> list[MachineBody]:
    """Return the bodies without a mesh: their rigid motions are part of their modes."""
    return [
        MachineBody(
            name=one.name,
            place=place,
            stiffness=one.stiffness,
            rigid=np.zeros((6, one.size)),
            surfaces=(),
            motions=(),
            gyroscopic=np.zeros((one.size,) * 2),
        )
        for one, place in zip(
            assembled.components[first:], assembled.places[first:], strict=True
        )
    ]


def redrawn(machine: ReducedMachine, random: np.random.Generator) -> ReducedMachine:
    """Return a machine whose measured bodies are drawn from their uncertainty.

    Args:
        machine: with measured bodies.
        random: source of the draw.
    """
    whole = machine.assembled
    first = len(whole.components) - len(machine.measured)
    drawn = [one.drawn(random, machine.band_hz) for one in machine.measured]
    assembled = assemble_components(
        [*whole.components[:first], *drawn],
        whole.joints,
        box=MACHINE_BOX,
        modes=MACHINE_MODES,
    )
    meshed = [
        replace(one, place=place)
        for one, place in zip(machine.bodies[:first], assembled.places, strict=False)
    ]
    return replace(
        machine,
        assembled=assembled,
        bodies=(*meshed, *_measured_bodies(assembled, first)),
        points={name: assembled.rows(side) for name, side in machine.sides.items()},
    )


def _reduced(raw: RawBody, band_hz: float, cache: Path | None) -> Component:
    key = body_key(raw.matrices, raw.ports, band_hz)
    return cached_component(
        cache, key, lambda: reduce_body(raw.matrices, raw.ports, band_hz)
    )


def nominal_values(
    settings: Mapping[str, JointSetting],
    springs: Sequence[MachineSpring | MachineLink],
    joints: Sequence[PortJoint],
) -> FloatArray:
    """Return stiffness, damping and their relative deviations of all joints.

    Coupled matrices are multiplied by one.

    Args:
        settings: of the joints over areas, by name.
        springs: between pieces, and links of measured bodies.
        joints: in the order of the parameters.

    Returns:
        Shape (4, n_parameters).
    """
    named = {one.name: one for one in springs}
    found = [np.zeros((4, 0))]
    for joint in joints:
        if joint.name in settings:
            one = settings[joint.name]
            values: list[tuple[float, ...]] = [one.stiffness, one.damping]
            deviations = (one.stiffness_sd, one.damping_sd)
        else:
            spring = named[joint.name]
            values = [spring.stiffness, spring.damping]
            if spring.matrices is not None:
                values = [(1.0, 0.0), (0.0, 1.0)]
            deviations = spring.deviations
        spread = np.outer(deviations, np.ones(len(joint.directions)))
        found.append(np.concatenate([np.array(values), spread]))
    return np.concatenate(found, axis=1)


def _machine_body(raw: RawBody, component: Component, place: IntArray) -> MachineBody:
    mass = raw.matrices.mass
    rows = np.asarray(mass @ orthonormal_motions(raw.motions, mass)).T
    return MachineBody(
        name=component.name,
        place=place,
        stiffness=component.stiffness,
        rigid=rows @ component.basis,
        surfaces=raw.surfaces,
        motions=tuple(one.rows @ component.basis for _, one in raw.surfaces),
        gyroscopic=_turning(raw, component),
    )


def _turning(raw: RawBody, component: Component) -> FloatArray:
    """Return the gyroscopic matrix of a body in reduced coordinates."""
    if raw.gyroscopic is None:
        return np.zeros((component.size,) * 2)
    found = component.basis.T @ (raw.gyroscopic @ component.basis)
    return np.asarray(0.5 * (found - found.T))
