# SPDX-License-Identifier: MIT
"""Meshed bodies of another thickness, in few coordinates.

Where a mesh is stretched along one side by a factor f, its stiffness is f A + B + C / f
and its mass f M: strains along that side fall with f, the volume grows. Three assembled
thicknesses give A, B and C, and the reduced coordinates at all three of them span the
motions in between. So the modes at any factor are those of two small matrices.

The bolted areas stay where they are on the mesh; a hammer point or sensor moves with
the surface that it is on.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies
from jointbench.analysis.structures.matrices.element_assembly import Sparse, assemble
from jointbench.analysis.structures.reduction.component import BodyMatrices
from jointbench.analysis.structures.reduction.krylov_subspace import orthonormalise
from jointbench.station.bolted.interface_motions import BoltedArea
from jointbench.station.bolted.modal_rows import BodyModes, jointed_rows
from jointbench.station.bolted.reduced_bodies import reduced_body
from jointbench.station.joints.gap_table import StructureGapTable
from jointbench.station.joints.structure_model import StructureModel, material_of

FACTORS = (0.8, 1.0, 1.25)
"""Thicknesses that are assembled, over the nominal one."""
# Elastic modes are above this share of the band.
_RIGID = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class ThickBody:
    """A body whose thickness is free.

    Attributes:
        bodies: all bodies; of this one, coordinates that are no modes.
        own: these coordinates.
        stiffness: A, B and C, shape (3, n, n) [N/m].
        mass: parts that stay and that grow with the factor, shape (2, n, n) [kg].
        still: angular frequency below which a mode is a rigid motion [rad/s].
    """

    bodies: JointedBodies
    own: slice
    stiffness: FloatArray
    mass: FloatArray
    still: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "mass")

    def at(self, factor: float) -> JointedBodies:
        """Return the bodies with this one thicker by a factor."""
        k = np.einsum("p,pij->ij", [factor, 1.0, 1.0 / factor], self.stiffness)
        value, vector = scipy.linalg.eigh(k, self.mass[0] + factor * self.mass[1])
        omega = self.bodies.omega.copy()
        omega[self.own] = np.sqrt(np.where(value > self.still**2, value, 0.0))
        shapes = np.eye(omega.size)
        shapes[self.own, self.own] = vector
        return self.bodies.in_modes(shapes, omega, self.bodies.body)


def thickness_laws(
    model: StructureModel,
    gap: StructureGapTable,
    areas: Sequence[BoltedArea],
    modes: BodyModes,
    points: FloatArray,
) -> Mapping[str, Callable[[float], JointedBodies]]:
    """Return the bodies over the thickness of each that is assembled from its mesh.

    The matrices of another program belong to one thickness. Nothing is computed before
    a law is called.

    Args:
        model: of the structure.
        gap: its table [gap].
        areas: bolted areas.
        modes: of the bodies.
        points: motion at hits and sensors, shape (n_rows, n_free).
    """
    if gap.frequency_sd > 0.0:
        # Uncertain frequencies belong to single modes, which change here.
        return {}

    def law(number: int) -> Callable[[float], JointedBodies]:
        prepared = cache(lambda: _prepared(model, gap, areas, modes, points, number))

        @lru_cache(maxsize=8)
        def at(factor: float) -> JointedBodies:
            return prepared().at(factor)

        return at

    return {
        name: law(number)
        for number, name in enumerate(modes.names)
        if name in model.bodies and model.bodies[name].stiffness is None
    }


def _prepared(
    model: StructureModel,
    gap: StructureGapTable,
    areas: Sequence[BoltedArea],
    modes: BodyModes,
    points: FloatArray,
    number: int,
) -> ThickBody:
    """Assemble a body at three thicknesses, and reduce them together."""
    name, structure = modes.names[number], modes.structure
    at = [one.name for one in structure.bodies].index(name)
    rows = slice(int(structure.blocks[at]), int(structure.blocks[at + 1]))
    table = model.bodies[name]
    material = material_of(model.materials[table.material or ""])
    within = structure.free[rows] - 3 * int(structure.first_node[at])
    mesh = structure.bodies[at].mesh
    stretch = np.ones(3)
    side = int(np.argmin(np.ptp(mesh.nodes, axis=0)))
    stiffness, mass = [], []
    for factor in FACTORS:
        stretch[side] = factor
        k, m = assemble(replace(mesh, nodes=mesh.nodes * stretch), material)
        stiffness.append(Sparse(k[within][:, within]))
        mass.append(Sparse(m[within][:, within]))
    # Springs of supports and masses of sensors do not grow with the body.
    held = Sparse(structure.stiffness[rows, rows] - stiffness[1])
    carried = Sparse(structure.mass[rows, rows] - mass[1])
    ports = {area.name: area.every_row[:, rows] for area in areas}
    own = np.flatnonzero(modes.body == number)
    space = modes.basis[rows][:, own]
    for k, m in zip(stiffness[::2], mass[::2], strict=True):
        matrices = BodyMatrices(name, Sparse(k + held), Sparse(m + carried))
        _, found = reduced_body(matrices, ports, points[:, rows], gap.band)
        new = orthonormalise(space, Sparse(mass[1] + carried), found)
        space = np.concatenate([space, new], axis=1)
    small = np.stack([space.T @ (k @ space) for k in stiffness])
    powers = np.array([[factor, 1.0, 1.0 / factor] for factor in FACTORS])
    parts = np.einsum("pf,fij->pij", np.linalg.inv(powers), small)
    parts[1] += space.T @ (held @ space)
    wide, columns = _with_space(modes, number, rows, space)
    return ThickBody(
        jointed_rows(model, gap, areas, wide),
        columns,
        parts,
        np.stack([space.T @ (carried @ space), space.T @ (mass[1] @ space)]),
        _RIGID * 2.0 * np.pi * gap.band,
    )


def _with_space(
    modes: BodyModes, number: int, rows: slice, space: FloatArray
) -> tuple[BodyModes, slice]:
    """Return the modes with those of one body replaced, and the place of the new."""
    own = np.flatnonzero(modes.body == number)
    first, count = int(own[0]), space.shape[1]
    columns = slice(first, first + count)
    before, after = slice(0, first), slice(first + own.size, None)
    basis = np.zeros((modes.basis.shape[0], modes.body.size - own.size + count))
    basis[:, :first] = modes.basis[:, before]
    basis[:, first + count :] = modes.basis[:, after]
    basis[rows, columns] = space

    def spliced(old: FloatArray, new: float) -> FloatArray:
        return np.concatenate([old[before], np.full(count, new), old[after]])

    return (
        replace(
            modes,
            basis=basis,
            omega=spliced(modes.omega, 0.0),
            body=spliced(modes.body.astype(float), number).astype(np.int64),
        ),
        columns,
    )
