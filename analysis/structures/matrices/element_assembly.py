# SPDX-License-Identifier: MIT
"""Stiffness and mass of a mesh of linear elastic solids."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_positive
from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.block_pattern import (
    Sparse,
    add_elements,
    node_pattern,
    scalar_matrix,
    vector_matrix,
)
from jointbench.analysis.structures.meshes.elements import shape_functions, volume_rule
from jointbench.analysis.structures.meshes.mesh import Mesh

__all__ = ["Material", "Sparse", "assemble"]

# Elements that agree to this share of their size share one matrix.
_SAME_ELEMENT = 1e-9
# Least Jacobian of a valid element, as a share of its mean.
_NO_VOLUME = 1e-6
# Different elements that are integrated at a time: about 100 MB for hex20.
_CHUNK = 1000


@dataclass(frozen=True, slots=True)
class Material:
    """A linear elastic, isotropic solid.

    Attributes:
        youngs_modulus: [Pa].
        poisson_ratio: [-].
        density: [kg/m^3].
        loss_factor: of structural damping [-].
    """

    youngs_modulus: float
    poisson_ratio: float
    density: float
    loss_factor: float = 0.0

    def __post_init__(self) -> None:
        """Check signs and bounds once."""
        require_positive("youngs_modulus", self.youngs_modulus)
        require_positive("density", self.density)
        if not -1.0 < self.poisson_ratio < 0.5:
            raise BadData(
                f"poisson_ratio is {self.poisson_ratio:g}; it must be between -1 and "
                "0.5, both excluded"
            )
        if not 0.0 <= self.loss_factor < 1.0:
            raise BadData(f"loss_factor is {self.loss_factor:g}; it must be in 0 to 1")


def assemble(mesh: Mesh, material: Material) -> tuple[Sparse, Sparse]:
    """Assemble stiffness and consistent mass.

    Args:
        mesh: of the body.
        material: of all its elements.

    Returns:
        K [N/m] and M [kg], shape (3 n_nodes, 3 n_nodes); degrees of freedom run x, y,
        z node by node.

    Raises:
        BadData: an element is inverted or has no volume.

    Source:
        Zienkiewicz and Taylor, The Finite Element Method, vol. 1 (2000), ch. 6 and 9.
    """
    pattern = node_pattern(mesh.cells, mesh.nodes.shape[0])
    stiffness = np.zeros(9 * pattern.pairs)
    mass = np.zeros(pattern.pairs)
    form, kind_of = _distinct_elements(mesh)
    # Elements of one shape are neighbours in this order, a chunk holds whole shapes.
    order = np.argsort(kind_of, kind="stable")
    edges = np.searchsorted(kind_of[order], np.arange(form.size + 1))
    for at in range(0, form.size, _CHUNK):
        end = min(at + _CHUNK, form.size)
        k, m = _chunk_matrices(mesh, form[at:end], material)
        chosen = order[edges[at] : edges[end]]
        cells, kinds = mesh.cells[chosen], kind_of[chosen] - at
        add_elements(stiffness, pattern, cells, k, kinds)
        add_elements(mass, pattern, cells, m, kinds)
    return vector_matrix(stiffness, pattern), scalar_matrix(mass, pattern)


def _distinct_elements(mesh: Mesh) -> tuple[IntArray, IntArray]:
    """Return one element of each shape, and the shape of every element."""
    corners = mesh.nodes[mesh.cells]
    relative = corners - corners[:, :1]
    step = _SAME_ELEMENT * np.abs(relative).max()
    rounded = np.round(relative.reshape(mesh.cells.shape[0], -1) / step)
    _, first, inverse = np.unique(
        rounded, axis=0, return_index=True, return_inverse=True
    )
    return first.astype(np.int64), inverse.ravel()


def _chunk_matrices(
    mesh: Mesh, chosen: IntArray, material: Material
) -> tuple[FloatArray, FloatArray]:
    point, weight = volume_rule(mesh.kind)
    value, slope = shape_functions(mesh.kind, point)
    corner = mesh.nodes[mesh.cells[chosen]]
    jacobian = np.einsum("qia,eib->eqab", slope, corner)
    volume = np.linalg.det(jacobian)
    _require_volume(volume, chosen)
    # One gradient for each point: slope by natural coordinates times inverse Jacobian.
    gradient = np.linalg.solve(
        jacobian, np.swapaxes(np.broadcast_to(slope, (chosen.size, *slope.shape)), 2, 3)
    )
    gradient = np.swapaxes(gradient, 2, 3)  # (elements, points, nodes, axes)
    scaled = weight * volume
    n_nodes = value.shape[1]
    flat = gradient.reshape(*gradient.shape[:2], 3 * n_nodes)
    product = np.swapaxes(flat * scaled[..., None], 1, 2) @ flat
    mass = material.density * np.einsum("eq,qi,qj->eij", scaled, value, value)
    return _isotropic(product, material), mass


def _isotropic(product: FloatArray, material: Material) -> FloatArray:
    """Return the stiffness of each element from integrals of gradient products."""
    e, nu = material.youngs_modulus, material.poisson_ratio
    first = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    shear = e / (2.0 * (1.0 + nu))
    n_nodes = product.shape[1] // 3
    blocks = product.reshape(-1, n_nodes, 3, n_nodes, 3)
    crossed = np.swapaxes(blocks, 2, 4)
    trace = np.einsum("eiaja->eij", blocks)
    whole = first * blocks + shear * crossed
    for axis in range(3):
        whole[:, :, axis, :, axis] += shear * trace
    return np.asarray(whole.reshape(product.shape))


def _require_volume(volume: FloatArray, chosen: IntArray) -> None:
    mean = np.abs(volume).mean(axis=1)
    bad = np.flatnonzero(volume.min(axis=1) <= _NO_VOLUME * mean)
    if bad.size:
        at = int(bad[0])
        raise BadData(
            f"element {chosen[at]}: Jacobian {volume[at].min():.3g} m^3 at one of its "
            "points, it must be above zero everywhere; the element is flat, inside out "
            "or badly distorted: mesh again"
        )
