# SPDX-License-Identifier: MIT
"""A joint as CalculiX springs node by node, and a whole model to check it with.

CalculiX has no matrix input and no dashpots of zero length: the stiffness is a network
of SPRING2 and SPRING1 elements, the damping is left out.

Source: CalculiX CrunchiX User's Manual 2.20, *SPRING, SPRING1, SPRING2, *FREQUENCY.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import FormatError
from jointbench.analysis.structures.exchange.spring_network import (
    SpringNetwork,
    matrix_of,
    network_of,
)
from jointbench.analysis.structures.matrices.element_assembly import Material, Sparse
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.meshes.elements import (
    ElementKind,
    shape_functions,
)
from jointbench.analysis.structures.meshes.mesh import Mesh

_TYPES = {ElementKind.HEX20: "C3D20", ElementKind.TET10: "C3D10"}
# Digits of a constant: the reader takes 20 columns.
_DIGITS = 12
# Entries of a matrix below this share of the largest one are rounding.
_ROUNDING = 1e-14
# Mode, eigenvalue, rad/s, cycles/s, imaginary part.
_COLUMNS = 5


@dataclass(frozen=True, slots=True, eq=False)
class CalculixModel:
    """What a whole model needs beside the joint.

    Attributes:
        structure: bodies, supports and masses on their meshes.
        materials: of the bodies, in order.
        points: nodes of attached masses and their masses [kg].
        modes: number of modes to ask for.
    """

    structure: Structure
    materials: tuple[Material, ...]
    points: tuple[tuple[int, float], ...]
    modes: int


def springs_text(matrix: Sparse, head: Sequence[str], first: int) -> str:
    """Return a stiffness as springs between the nodes of a mesh.

    Args:
        matrix: over the degrees of freedom x, y, z of all nodes [N/m].
        head: lines of comment.
        first: number of the first element. CalculiX takes memory for all numbers below
            the highest one: the springs should follow the solids.
    """
    lines = [f"** {one}" for one in head]
    return "\n".join([*lines, *_springs(network_of(matrix), first), ""])


def read_springs(text: str, count: int) -> Sparse:
    """Read `springs_text` back, over `count` nodes.

    Raises:
        FormatError: a set of springs has no constant.
    """
    sets: dict[str, list[list[int]]] = {}
    constants: dict[str, tuple[list[int], float]] = {}
    rows: list[str] = []
    name = ""
    for line in [*text.splitlines(), "*END"]:
        if line.startswith("**") or not line.strip():
            continue
        if not line.startswith("*"):
            rows.append(line)
            continue
        if name.startswith("*ELEMENT"):
            own = sets.setdefault(_set_of(name), [])
            own += [[int(w) for w in row.split(",")[1:]] for row in rows]
        elif name.startswith("*SPRING"):
            freedoms = [int(one) for one in rows[0].split(",") if one.strip()]
            constants[_set_of(name)] = (freedoms, float(rows[1]))
        name, rows = line.upper(), []
    if set(sets) != set(constants):
        raise FormatError("a set of springs has no constant; write the file again")
    return matrix_of(_network(sets, constants), 3 * count)


def model_text(model: CalculixModel, joints: Iterable[Sparse]) -> str:
    """Return a whole model that asks for natural frequencies.

    Args:
        model: bodies, supports, masses.
        joints: their stiffness over the degrees of freedom of all nodes [N/m].
    """
    structure = model.structure
    lines = ["** Written by jointbench; SI units.", "*NODE, NSET=ALL"]
    lines += [
        f"{at + 1}, {x:.{_DIGITS}g}, {y:.{_DIGITS}g}, {z:.{_DIGITS}g}"
        for at, (x, y, z) in enumerate(structure.nodes.tolist())
    ]
    lines += _solids(model)
    first = solid_count(structure) + 1
    for at, (node, mass) in enumerate(model.points):
        lines += [
            f"*ELEMENT, TYPE=MASS, ELSET=MASS{at}",
            f"{first}, {node + 1}",
            f"*MASS, ELSET=MASS{at}",
            f"{mass:.{_DIGITS - 1}e}",
        ]
        first += 1
    for matrix in [*joints, *_tied(structure)]:
        network = network_of(matrix)
        lines += _springs(network, first)
        first += network.constant.size
    held = np.setdiff1d(np.arange(3 * len(structure.nodes)), structure.free)
    if held.size:
        lines.append("*BOUNDARY")
        lines += [f"{k // 3 + 1}, {k % 3 + 1}, {k % 3 + 1}" for k in held.tolist()]
    lines += ["*STEP", "*FREQUENCY", f"{model.modes}", "*NODE FILE", "U", "*END STEP"]
    return "\n".join([*lines, ""])


def read_frequencies(text: str) -> FloatArray:
    """Return the natural frequencies of a ``.dat`` file [Hz], rigid motions as zero.

    Raises:
        FormatError: there is no table of eigenvalues.
    """
    _, found, table = text.partition("E I G E N V A L U E   O U T P U T")
    if not found:
        raise FormatError("CalculiX wrote no eigenvalues; look at its messages")
    rows = []
    for line in table.partition("P A R T I C I P A T I O N")[0].splitlines():
        words = line.split()
        if len(words) == _COLUMNS and words[0].isdigit():
            rows.append(float(words[1]))
    value = np.array(rows)
    return np.asarray(np.sqrt(np.maximum(value, 0.0)) / (2.0 * np.pi))


def calculix_mass(model: CalculixModel) -> Sparse:
    """Return the mass matrix as CalculiX integrates it, over the free freedoms [kg].

    It takes four points for a tet10, which is not exact; a hex20 is as ours.
    """
    structure = model.structure
    change = []
    for body, material in zip(structure.bodies, model.materials, strict=True):
        if body.mesh.kind is ElementKind.TET10:
            own = _four_point_mass(body.mesh, material.density)
            change.append(Sparse(own - body.mass))
        else:
            change.append(Sparse(body.mass.shape))
    whole = sparse.block_diag(change, format="csr")
    kept = Sparse(whole[structure.free][:, structure.free])
    return Sparse(structure.mass + kept)


def _four_point_mass(mesh: Mesh, density: float) -> Sparse:
    """Return the mass with the rule of four points; edges are straight."""
    a, b = (5.0 + 3.0 * np.sqrt(5.0)) / 20.0, (5.0 - np.sqrt(5.0)) / 20.0
    points = np.full((4, 3), b)
    points[[1, 2, 3], [0, 1, 2]] = a
    value, _ = shape_functions(mesh.kind, points)
    corner = mesh.nodes[mesh.cells[:, :4]]
    volume = np.linalg.det(corner[:, 1:] - corner[:, :1]) / 6.0
    block = density * value.T @ value / 4.0
    wide = mesh.cells.shape[1]
    rows = np.repeat(mesh.cells, wide, axis=1).ravel()
    columns = np.tile(mesh.cells, (1, wide)).ravel()
    entries = (volume[:, None, None] * block).ravel()
    shape = (len(mesh.nodes), len(mesh.nodes))
    scalar = sparse.coo_array((entries, (rows, columns)), shape=shape).tocsr()
    return Sparse(sparse.kron(scalar, np.eye(3), format="csr"))


def solid_count(structure: Structure) -> int:
    """Return the number of solid elements of all bodies."""
    return sum(len(body.mesh.cells) for body in structure.bodies)


def over_all_nodes(structure: Structure, matrix: Sparse) -> Sparse:
    """Return a matrix of the free degrees of freedom over those of all nodes.

    Entries that are rounding are left out.
    """
    coo = matrix.tocoo()
    size = 3 * len(structure.nodes)
    large = np.abs(coo.data) > _ROUNDING * np.abs(coo.data).max(initial=0.0)
    row, column = structure.free[coo.row[large]], structure.free[coo.col[large]]
    return Sparse((coo.data[large], (row, column)), shape=(size, size))


def _tied(structure: Structure) -> list[Sparse]:
    """Return the springs of supports and the glue of glued joints."""
    parts = [structure.springs, structure.glue]
    return [over_all_nodes(structure, one) for one in parts if one.nnz]


def _solids(model: CalculixModel) -> list[str]:
    lines, number = [], 1
    for at, body in enumerate(model.structure.bodies):
        first = int(model.structure.first_node[at]) + 1
        lines.append(f"*ELEMENT, TYPE={_TYPES[body.mesh.kind]}, ELSET=BODY{at}")
        for cell in (body.mesh.cells + first).tolist():
            words = [str(number), *map(str, cell)]
            # At most 16 entries a line.
            lines.append(", ".join(words[:11]) + ("," if len(words) > 11 else ""))
            if len(words) > 11:
                lines.append(", ".join(words[11:]))
            number += 1
        own = model.materials[at]
        lines += [f"*MATERIAL, NAME=MAT{at}", "*ELASTIC"]
        lines.append(f"{own.youngs_modulus:.{_DIGITS - 1}e}, {own.poisson_ratio:.9g}")
        lines += ["*DENSITY", f"{own.density:.{_DIGITS - 1}e}"]
        lines.append(f"*SOLID SECTION, ELSET=BODY{at}, MATERIAL=MAT{at}")
    return lines


def _springs(network: SpringNetwork, first: int) -> list[str]:
    """Return springs, those of one constant and one pair of directions in one set."""
    groups: dict[tuple[int, int, str], list[tuple[int, int]]] = defaultdict(list)
    for i, j, k in zip(
        network.first.tolist(),
        network.second.tolist(),
        network.constant.tolist(),
        strict=True,
    ):
        other = j % 3 if j >= 0 else -1
        # Without a point, twelve digits are no number for CalculiX 2.20.
        groups[i % 3, other, f"{k:.{_DIGITS - 1}e}"].append((i // 3, j // 3))
    lines = []
    number = first
    for (own, other, constant), pairs in groups.items():
        kind = "SPRING1" if other < 0 else "SPRING2"
        name = f"SPR{number}"
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        for i, j in pairs:
            ends = f"{i + 1}" if other < 0 else f"{i + 1}, {j + 1}"
            lines.append(f"{number}, {ends}")
            number += 1
        freedoms = f"{own + 1}" if other < 0 else f"{own + 1}, {other + 1}"
        lines += [f"*SPRING, ELSET={name}", freedoms, constant]
    return lines


def _set_of(keyword: str) -> str:
    return keyword.split("ELSET=")[1].split(",")[0].strip()


def _network(
    sets: dict[str, list[list[int]]], constants: dict[str, tuple[list[int], float]]
) -> SpringNetwork:
    first: list[int] = []
    second: list[int] = []
    value: list[float] = []
    for name, ends in sets.items():
        freedoms, constant = constants[name]
        for nodes in ends:
            first.append(3 * (nodes[0] - 1) + freedoms[0] - 1)
            tied = len(nodes) > 1
            second.append(3 * (nodes[1] - 1) + freedoms[1] - 1 if tied else -1)
            value.append(constant)
    return SpringNetwork(_whole(first), _whole(second), np.array(value, float))


def _whole(values: Sequence[int]) -> IntArray:
    return np.array(values, np.int64)
