# SPDX-License-Identifier: MIT
"""Reduce one body: rigid motions, elastic modes, static response at its ports.

The factor of K + shift M of the body is made here and freed on return: memory is that
of the largest body, not of the machine.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.reduction.component import (
    BodyMatrices,
    BodyPort,
    Component,
    Residual,
)
from jointbench.analysis.structures.reduction.full_modes import lowest_modes
from jointbench.analysis.structures.reduction.krylov_subspace import (
    largest_of_inverse,
    orthonormalise,
)
from jointbench.analysis.structures.reduction.sparse_factor import (
    Solve,
    Solver,
    factorise,
)

# Elastic modes are kept up to this multiple of the band.
_REACH = 2.0
# Shift as a multiple of the band's highest frequency. It is positive because bodies are
# free, and small so that the attached responses are nearly static.
_SHIFT = 0.1
# The modes are a part of a basis: their own error matters little.
_MODE_RESIDUAL = 1e-4
# Directions of A^-1 this small relative to the largest are rounding.
_RANK = 1e-15
# Iterations for the largest compliance of a face, and vectors in one block.
_COMPLIANCE_STEPS = 8
_COMPLIANCE_BLOCK = 4
_RIGID_MOTIONS = 6
# Loads this small relative to the largest of a port are rounding.
_NO_LOAD = 1e-9


def shift_of_band(band_hz: float) -> float:
    """Return the shift [1/s^2] that all bodies of a machine share.

    Raises:
        BadData: the band is not above zero.
    """
    if not band_hz > 0:
        raise BadData(f"the band ends at {band_hz:g} Hz; it must be above 0 Hz")
    return float((_SHIFT * 2.0 * np.pi * band_hz) ** 2)


@dataclass(frozen=True, slots=True, eq=False)
class FactoredBody:
    """A body with the factor of K + shift M and its own modes.

    Attributes:
        body: its matrices.
        factor: solves with K + shift M.
        rigid: motions without strain, orthonormal in M, shape (n, k).
        modes: elastic modes, orthonormal in M, shape (n, m).
        band_hz: highest frequency of interest [Hz].
        shift: [1/s^2].
    """

    body: BodyMatrices
    factor: Solve
    rigid: FloatArray
    modes: FloatArray
    band_hz: float
    shift: float

    def reduce(
        self, ports: Sequence[BodyPort], inertia: FloatArray | None = None
    ) -> Component:
        """Reduce to given ports; see `reduce_body`.

        Args:
            ports: joint faces, sensors, loads, ends of springs.
            inertia: motions whose forces of inertia the basis answers, shape (n, k).
        """
        body, factor, rigid = self.body, self.factor, self.rigid
        _require_ports(body, ports)
        none = np.zeros((body.mass.shape[0], 0))
        load = np.concatenate([none, *(_port_loads(p) for p in ports)], axis=1)
        attached = factor(load) if load.shape[1] else load
        parts = [self.modes, attached]
        if inertia is not None and inertia.shape[1]:
            parts.append(factor(np.asarray(body.mass @ inertia)))
        limit = _limit(self.band_hz)
        metric = Sparse(body.mass + body.stiffness / limit)
        space = rigid
        for part in parts:
            new = orthonormalise(space, metric, part)
            space = np.concatenate([space, new], axis=1)
        level, space = _modal_coordinates(body, space, rigid.shape[1])
        root = _residual_root(body, factor, space, load, attached, rigid.shape[1])
        compliance = {p.name: _largest_compliance(p, factor) for p in ports}
        return Component(
            name=body.name,
            stiffness=np.diag(level),
            loss=_reduced_loss(body, level, space, rigid.shape[1]),
            damping=np.zeros((level.size,) * 2),
            rows={p.name: np.asarray(p.rows @ space) for p in ports},
            rigid=rigid.shape[1],
            source=body.source,
            basis=space,
            residual=Residual(
                root, {p.name: p.patterns for p in ports}, compliance, self.shift
            ),
            loss_factor=body.loss_factor,
            error_bound=_band_error(
                root, level, rigid.shape[1], self.band_hz, self.shift
            ),
        )


def factor_body(
    body: BodyMatrices,
    band_hz: float,
    *,
    shift: float | None = None,
    least_modes: int = 0,
    solver: Solver = Solver.AUTO,
) -> FactoredBody:
    """Factor a body and find its own modes; see `reduce_body`."""
    shift = shift_of_band(band_hz) if shift is None else shift
    factor = factorise(Sparse(body.stiffness + shift * body.mass), solver)
    rigid = _rigid(body, solver)
    modes = _elastic_modes(body, factor, rigid, shift, _limit(band_hz), least_modes)
    return FactoredBody(body, factor, rigid, modes, band_hz, shift)


def reduce_body(
    body: BodyMatrices,
    ports: Sequence[BodyPort],
    band_hz: float,
    *,
    shift: float | None = None,
    least_modes: int = 0,
    solver: Solver = Solver.AUTO,
) -> Component:
    """Reduce a body to its behaviour at its ports within a band.

    Args:
        body: its matrices.
        ports: joint faces, sensors, loads, ends of springs.
        band_hz: highest frequency of interest [Hz]; elastic modes are kept up to twice
            that.
        shift: of the attached responses and of the norm of the residual [1/s^2], equal
            for all bodies of a machine; None is that of the band.
        least_modes: number of elastic modes to keep at least.
        solver: of the factor.

    Returns:
        The reduced body.

    Raises:
        BadData: the matrices cannot be factored, or two ports share a name.

    Source:
        Craig and Chang 1977, NASA CR-145 (residual attachment modes of free bodies).
    """
    found = factor_body(
        body, band_hz, shift=shift, least_modes=least_modes, solver=solver
    )
    return found.reduce(ports)


def _limit(band_hz: float) -> float:
    """Return the largest eigenvalue of the modes that are kept [1/s^2]."""
    return float((2.0 * np.pi * _REACH * band_hz) ** 2)


def _reduced_loss(
    body: BodyMatrices, level: FloatArray, space: FloatArray, rigid: int
) -> FloatArray:
    if body.loss is None:
        return np.diag(body.loss_factor * level)
    loss = _symmetric(space.T @ (body.loss @ space))
    loss[:rigid] = loss[:, :rigid] = 0.0
    return loss


def _port_loads(port: BodyPort) -> FloatArray:
    """Return the loads of the patterns, shape (n, n_patterns).

    A pattern finer than the mesh loads no node: exactly zero, not rounding.
    """
    load = np.asarray(port.rows.T @ port.patterns)
    size = np.linalg.norm(load, axis=0)
    load[:, size <= _NO_LOAD * size.max(initial=0.0)] = 0.0
    return load


def _require_ports(body: BodyMatrices, ports: Sequence[BodyPort]) -> None:
    names = [port.name for port in ports]
    if len(set(names)) != len(names):
        raise BadData(f"ports of body {body.name!r} share a name: {names}")
    for port in ports:
        if port.rows.shape[1] != body.mass.shape[0]:
            raise BadData(
                f"port {port.name!r} has {port.rows.shape[1]} columns; body "
                f"{body.name!r} has {body.mass.shape[0]} degrees of freedom"
            )


def _rigid(body: BodyMatrices, solver: Solver) -> FloatArray:
    """Return the motions without strain, orthonormal in M."""
    if body.rigid is not None:
        return body.rigid
    count = min(_RIGID_MOTIONS + 1, body.mass.shape[0] - 2)
    found = lowest_modes(body.stiffness, body.mass, count, solver)
    return np.asarray(found.shapes[found.natural_frequency == 0.0].T)


def _elastic_modes(
    body: BodyMatrices,
    factor: Solve,
    rigid: FloatArray,
    shift: float,
    limit: float,
    least: int,
) -> FloatArray:
    """Return the modes of the body alone up to a limit [1/s^2], and the next one."""
    room = body.mass.shape[0] - rigid.shape[1]
    if room <= 0:
        return np.zeros((body.mass.shape[0], 0))
    _, shapes = largest_of_inverse(
        factor,
        body.mass,
        min(max(least, 1), room),
        rigid,
        down_to=1.0 / (limit + shift),
        converged=_MODE_RESIDUAL,
    )
    return shapes


def _modal_coordinates(
    body: BodyMatrices, space: FloatArray, rigid: int
) -> tuple[FloatArray, FloatArray]:
    """Return eigenvalues and a basis orthonormal in M that makes K diagonal."""
    elastic = space[:, rigid:]
    stiffness = _symmetric(elastic.T @ (body.stiffness @ elastic))
    mass = _symmetric(elastic.T @ (body.mass @ elastic))
    # K may be far larger than M: the roles are changed for accuracy of low modes.
    value, vector = np.linalg.eigh(mass)
    scaled = vector / np.sqrt(value)
    level, turn = np.linalg.eigh(_symmetric(scaled.T @ stiffness @ scaled))
    both = np.concatenate([space[:, :rigid], elastic @ (scaled @ turn)], axis=1)
    return np.concatenate([np.zeros(rigid), np.maximum(level, 0.0)]), both


def _residual_root(
    body: BodyMatrices,
    factor: Solve,
    space: FloatArray,
    load: FloatArray,
    attached: FloatArray,
    rigid: int,
) -> FloatArray:
    """Return a square root of the Gram matrix of K V, M V and P in A^-1."""
    force = np.asarray(body.stiffness @ space)
    # Motions without strain have exactly no force, not rounding.
    force[:, :rigid] = 0.0
    weighted = body.mass @ space
    images = [factor(force), factor(weighted), attached]
    forces = [force, weighted, load]
    return root_of(np.block([[one.T @ other for other in images] for one in forces]))


def root_of(gram: FloatArray) -> FloatArray:
    """Return R with R' R = gram, without directions that are rounding."""
    length = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    value, vector = np.linalg.eigh(_symmetric(gram / np.outer(length, length)))
    kept = value > _RANK * value[-1]
    return np.asarray((np.sqrt(value[kept])[:, None] * vector[:, kept].T) * length)


def _largest_compliance(port: BodyPort, factor: Solve) -> float:
    """Return the largest eigenvalue of rows A^-1 rows' outside of the patterns [m/N].

    A block Krylov iteration; the residual of its largest vector is added.
    """
    count, known = port.patterns.shape
    if known >= count:
        return 0.0

    def outside(part: FloatArray) -> FloatArray:
        return part - port.patterns @ (port.patterns.T @ part)

    block = min(_COMPLIANCE_BLOCK, count - known)
    start = outside(np.random.default_rng(0).standard_normal((count, block)))
    new = np.linalg.qr(start)[0]
    space, images = np.zeros((count, 0)), np.zeros((count, 0))
    for _ in range(_COMPLIANCE_STEPS):
        image = outside(port.rows @ factor(np.asarray(port.rows.T @ new)))
        space = np.concatenate([space, new], axis=1)
        images = np.concatenate([images, image], axis=1)
        value, vector = np.linalg.eigh(_symmetric(space.T @ images))
        left = images @ vector[:, -1] - value[-1] * (space @ vector[:, -1])
        new = outside(image - space @ (space.T @ image))
        new = np.linalg.qr(new - space @ (space.T @ new))[0]
        if space.shape[1] + block > count - known:
            break
    return float(value[-1] + np.linalg.norm(left))


def _band_error(
    root: FloatArray, level: FloatArray, rigid: int, band_hz: float, shift: float
) -> float:
    """Return the largest bound of the relative frequency error in the band [-].

    That of single modes, to first order: half the squared residual over the next gap.
    """
    size = level.size
    inside = np.flatnonzero((np.sqrt(level) <= 2 * np.pi * band_hz) & (level > 0))
    inside = inside[inside >= rigid]
    if not inside.size:
        return 0.0
    unit = np.eye(size)[:, inside]
    other = np.zeros((root.shape[1] - 2 * size, inside.size))
    stack = np.concatenate([unit, -level[inside] * unit, other])
    left = np.linalg.norm(root @ stack, axis=0) / np.sqrt(level[inside] + shift)
    return float((0.5 * left * (1.0 + shift / level[inside])).max())


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray(0.5 * (matrix + matrix.T))


def joint_patterns(
    position: FloatArray, weight: FloatArray, order: int, directions: int = 3
) -> FloatArray:
    """Return force patterns over a joint face: polynomials, direction by direction.

    Args:
        position: of the quadrature points in the plane [m], shape (n_points, 2).
        weight: share of the area of each point [-], shape (n_points,).
        order: of the polynomials; 1 holds all rigid motions of the face.
        directions: of the joint.

    Returns:
        Orthonormal, shape (directions n_points, directions n_polynomials) [-].
    """
    middle = 0.5 * (position.max(axis=0) + position.min(axis=0))
    reach = 0.5 * np.maximum(np.ptp(position, axis=0), 1e-12)
    place = (position - middle) / reach
    x, y = (
        np.polynomial.legendre.legvander(place[:, axis], order) for axis in range(2)
    )
    columns = [
        x[:, i] * y[:, j] for i in range(order + 1) for j in range(order + 1 - i)
    ]
    vector, size, _ = np.linalg.svd(
        np.sqrt(weight)[:, None] * np.array(columns).T, full_matrices=False
    )
    each = vector[:, size > 1e-9 * size[0]]
    return np.asarray(block_diag(*[each] * directions))
