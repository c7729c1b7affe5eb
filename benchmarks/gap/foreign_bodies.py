# SPDX-License-Identifier: MIT
"""Two steel plates by scikit-fem: K and M, their mesh, and the interface node by node.

Nothing here is of jointbench: meshes are of scikit-fem (tetrahedra with ten nodes), and
springs of a joint sit at single pairs of nodes, each with its share of the area.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse

Array = np.ndarray
Sparse = scipy.sparse.csr_matrix
YOUNGS_MODULUS, POISSON_RATIO, DENSITY = 206e9, 0.3, 7850.0
STEP = 0.02
"""Size of an element [m]; nodes are at half of it."""
PATCHES = {
    "left": ((0.04, 0.05), (0.08, 0.15)),
    "right": ((0.28, 0.05), (0.32, 0.15)),
}
"""Joints: two corners of each bolted area [m]."""
INTERFACE = 0.02
"""Height of the interface [m]."""


@dataclass(frozen=True, eq=False)
class FemBody:
    """A body as another library sees it.

    Attributes:
        name: of the body.
        nodes: [m], shape (n_nodes, 3).
        cells: corners, then middles of edges, shape (n_cells, 10).
        stiffness: K [N/m], node by node x, y, z.
        mass: M [kg].
        basis: scalar basis of scikit-fem, for values between nodes.
        order: node of each degree of freedom of that basis.
    """

    name: str
    nodes: Array
    cells: Array
    stiffness: Sparse
    mass: Sparse
    basis: object
    order: Array

    def at(self, places: Array) -> Sparse:
        """Return values at places from those at nodes, shape (n_places, n_nodes)."""
        # A place on the surface would be outside by rounding.
        inside = np.asarray(places) + 1e-7 * (self.nodes.mean(axis=0) - places)
        found = scipy.sparse.coo_matrix(self.basis.probes(inside.T))
        shape = (len(places), len(self.nodes))
        return Sparse((found.data, (found.row, self.order[found.col])), shape=shape)

    def export(self, folder: Path) -> None:
        """Write the mesh as an Abaqus file, and both matrices (Matrix Market)."""
        nodes = [f"{k}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in _numbered(self.nodes)]
        cells = [
            f"{k}, {', '.join(str(n + 1) for n in c)}" for k, c in _numbered(self.cells)
        ]
        head, middle = "*NODE", "*ELEMENT, TYPE=C3D10"
        text = "\n".join([head, *nodes, middle, *cells, ""])
        (folder / f"{self.name}.inp").write_text(text, encoding="utf-8")
        for word, matrix in (("k", self.stiffness), ("m", self.mass)):
            scipy.io.mmwrite(
                folder / f"{self.name}_{word}.mtx", matrix, symmetry="symmetric"
            )


def _numbered(rows: Array) -> list[tuple[int, list]]:
    return list(enumerate(rows.tolist(), 1))


def plates(thickness: tuple[float, float] = (0.02, 0.016)) -> tuple[FemBody, FemBody]:
    """Return the lower and the upper plate.

    Args:
        thickness: of both [m]; the nominal one if it is left out. The interface stays.
    """
    lower = _plate(
        "lower", (0.0, 0.0, INTERFACE - thickness[0]), (0.36, 0.2, thickness[0])
    )
    upper = _plate("upper", (0.03, 0.02, INTERFACE), (0.3, 0.16, thickness[1]))
    return lower, upper


def _plate(name: str, corner: tuple[float, ...], size: tuple[float, ...]) -> FemBody:
    import skfem
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    lines = [
        np.linspace(low, low + length, max(round(length / STEP), 1) + 1)
        for low, length in zip(corner, size, strict=True)
    ]
    mesh = skfem.MeshTet.init_tensor(*lines)
    vector = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTetP2()), intorder=4)
    scalar = skfem.Basis(mesh, skfem.ElementTetP2(), intorder=4)
    law = lame_parameters(YOUNGS_MODULUS, POISSON_RATIO)

    @skfem.BilinearForm
    def inertia(u: Array, v: Array, _: object) -> Array:
        return DENSITY * sum(u[a] * v[a] for a in range(3))

    own = np.concatenate([vector.nodal_dofs, vector.edge_dofs], axis=1).T.ravel()
    stiffness = Sparse(linear_elasticity(*law).assemble(vector))[own][:, own]
    mass = Sparse(inertia.assemble(vector))[own][:, own]
    nodes = np.concatenate([mesh.p.T, mesh.p[:, mesh.edges].mean(axis=1).T])
    cells = np.concatenate([mesh.t, mesh.t2e + mesh.p.shape[1]]).T
    numbers = np.concatenate([scalar.nodal_dofs, scalar.edge_dofs], axis=1).ravel()
    return FemBody(
        name,
        nodes,
        _turned(nodes, cells),
        (stiffness + stiffness.T) / 2,
        (mass + mass.T) / 2,
        scalar,
        np.argsort(numbers),
    )


def _turned(nodes: Array, cells: Array) -> Array:
    """Return the elements with corners that turn the right way."""
    sides = nodes[cells[:, 1:4]] - nodes[cells[:, :1]]
    wrong = np.linalg.det(sides) < 0
    cells[wrong] = cells[wrong][
        :, [0, 2, 1, 3, 2 + 4, 1 + 4, 0 + 4, 3 + 4, 5 + 4, 4 + 4]
    ]
    return cells


@dataclass(frozen=True, eq=False)
class NodePairs:
    """Pairs of nodes of a joint.

    Attributes:
        lower: node of the lower plate, shape (n_pairs,).
        upper: of the upper plate.
        share: of the area [-]; they sum to 1.
    """

    lower: Array
    upper: Array
    share: Array


def node_pairs(lower: FemBody, upper: FemBody, joint: str) -> NodePairs:
    """Return the pairs of nodes in a bolted area."""
    (x0, y0), (x1, y1) = PATCHES[joint]
    found = []
    for body in (lower, upper):
        x, y, z = body.nodes.T
        near = 1e-6
        inside = (x > x0 - near) & (x < x1 + near) & (y > y0 - near) & (y < y1 + near)
        own = np.flatnonzero(inside & (np.abs(z - INTERFACE) < near))
        place = np.round(body.nodes[own, :2], 6)
        found.append(own[np.lexsort(place.T)])
    x, y, _ = lower.nodes[found[0]].T
    share = _simpson(x) * _simpson(y)
    return NodePairs(found[0], found[1], share / share.sum())


def _simpson(places: Array) -> Array:
    """Return weights of Simpson's rule: nodes are ends and middles of elements."""
    levels, line = np.unique(np.round(places, 6), return_inverse=True)
    weights = np.where(np.arange(levels.size) % 2 == 1, 4.0, 2.0)
    weights[[0, -1]] = 1.0
    return weights[line]
