# SPDX-License-Identifier: MIT
"""Complex modes of a lumped model, and their derivatives by its parameters."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    freeze,
)
from jointbench.analysis.lumped.lumped_matrices import (
    damping_matrix,
    mass_matrix,
    stiffness_matrix,
)
from jointbench.analysis.lumped.lumped_model import LumpedModel, require_tested_masses

# Relative stiffness against rigid motion of a part of the bench below which it is
# rounding, and the part is free.
_FREE = 1e-12
# Above this damping ratio a pole pair counts as two decays: it has no natural
# frequency.
_OVERDAMPED = 1 - 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class ComplexModes:
    """The oscillating modes of a viscously damped system, by natural frequency.

    Attributes:
        poles: with positive imaginary part [rad/s], shape (n_modes,).
        shapes: mass-normalised, shape (n_modes, n_bodies) [kg^-1/2]: scaled so that
            shape^T (2 pole M + C) shape = 2j Im(pole), which without damping is
            shape^T M shape = 1.
    """

    poles: ComplexArray
    shapes: ComplexArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "poles", "shapes")

    @property
    def natural_frequency(self) -> FloatArray:
        """Magnitude of the poles as a frequency [Hz], shape (n_modes,)."""
        return np.asarray(np.abs(self.poles) / (2 * np.pi))

    @property
    def damping_ratio(self) -> FloatArray:
        """Viscous damping ratio [-], shape (n_modes,)."""
        return np.asarray(-self.poles.real / np.abs(self.poles))


def solve_modes(model: LumpedModel) -> ComplexModes:
    """Find the modes of a lumped model.

    Args:
        model: bodies and links.

    Returns:
        Oscillating modes; rigid-body motions and overdamped decays are left out. The
        receptance of the rest is the sum of shape shape^T / (2j Im(pole) (s - pole))
        and its conjugate.

    Raises:
        UsageError: a mass is impossible for a hammer test.

    Source:
        Ewins, Modal Testing (2000), sec. 2.7.
    """
    require_tested_masses(model)
    return modes_of(
        np.diag(mass_matrix(model)), damping_matrix(model), stiffness_matrix(model)
    )


def modes_of(
    mass: FloatArray, damping: FloatArray, stiffness: FloatArray
) -> ComplexModes:
    """Find the modes of matrices; see `solve_modes`.

    Args:
        mass: diagonal of the mass matrix [kg], shape (n,).
        damping: symmetric [N s/m], shape (n, n).
        stiffness: symmetric [N/m], shape (n, n).

    Returns:
        Oscillating modes, by natural frequency.
    """
    root = np.sqrt(mass)
    moving = _straining(stiffness, root)
    n, m = moving.shape
    # Straining displacements, then all velocities: motions without a restoring spring
    # have no displacement here, and no double pole at zero.
    state = np.zeros((m + n, m + n))
    state[:m, m:] = moving.T
    state[m:, :m] = -(stiffness / np.outer(root, root)) @ moving
    state[m:, m:] = -damping / np.outer(root, root)
    poles, vectors = np.linalg.eig(state)
    size = np.abs(poles)
    wanted = (poles.imag > 0) & (-poles.real < _OVERDAMPED * size)
    order = np.flatnonzero(wanted)[np.argsort(size[wanted])]
    chosen = poles[order].astype(complex)
    # Shapes are those of the velocities: pole times displacement.
    shapes = (vectors[m:, order] / root[:, None] / chosen).T.astype(complex)
    return ComplexModes(chosen, _normalised(chosen, shapes, mass, damping))


def _straining(stiffness: FloatArray, root: FloatArray) -> FloatArray:
    """Return the motions that strain springs, times the root of mass, orthonormal.

    The parts of the bench without a spring to the ground are free; a soft spring in
    parallel with a stiff one also ties a part.
    """
    own = _pieces(stiffness != 0.0).astype(float)
    restoring = np.abs(((own @ stiffness) * own).sum(axis=1))
    size = ((own @ np.abs(stiffness)) * own).sum(axis=1)
    free = (own[restoring <= _FREE * size] * root).T
    turn, _ = np.linalg.qr(free, mode="complete")
    return np.asarray(turn[:, free.shape[1] :])


def _pieces(tied: BoolArray) -> BoolArray:
    """Return which bodies hang together, a row a piece, (n_pieces, n_bodies).

    By squaring, which for a handful of bodies is sooner than a search of a graph.

    Args:
        tied: True where a link joins two bodies, symmetric, shape (n, n).
    """
    count = len(tied)
    reached = tied | np.eye(count, dtype=np.bool_)
    for _ in range(count.bit_length()):
        reached = reached @ reached
    first = np.argmax(reached, axis=1)
    return np.asarray(reached[first == np.arange(count)])


def _normalised(
    poles: ComplexArray, shapes: ComplexArray, mass: FloatArray, damping: FloatArray
) -> ComplexArray:
    """Scale shapes by mass, the largest component with a positive real part."""
    curvature = modal_curvature(poles, shapes, mass, damping)
    scaled = shapes * np.sqrt(2j * poles.imag / curvature)[:, None]
    rows = np.arange(poles.size)
    lead = scaled[rows, np.argmax(np.abs(scaled), axis=1)]
    return np.asarray(scaled * np.where(lead.real < 0, -1.0, 1.0)[:, None])


def modal_curvature(
    poles: ComplexArray, shapes: ComplexArray, mass: FloatArray, damping: FloatArray
) -> ComplexArray:
    """Return shape^T (2 pole M + C) shape of each mode, shape (n_modes,)."""
    inertia = 2 * poles * np.einsum("ri,i,ri->r", shapes, mass, shapes)
    return np.asarray(inertia + np.einsum("ri,ij,rj->r", shapes, damping, shapes))


def mode_derivatives(
    pole: complex,
    shape: ComplexArray,
    reference: int,
    matrices: tuple[FloatArray, FloatArray, FloatArray],
    change: tuple[ComplexArray, FloatArray],
) -> tuple[ComplexArray, ComplexArray]:
    """Differentiate one pole, and its shape relative to one component.

    Args:
        pole: [rad/s].
        shape: of any scale, shape (n,).
        reference: component that is fixed at 1.
        matrices: diagonal of M, C and K.
        change: factors a, shape (n_parameters,), and vectors v, shape (n_parameters,
            n), of the derivatives a v v^T of the dynamic stiffness
            pole^2 M + pole C + K by each parameter.

    Returns:
        Derivatives of the pole, shape (n_parameters,), and of shape/shape[reference],
        shape (n_parameters, n).

    Source:
        Nelson 1976, AIAA J. 14, 1201-1205, for the quadratic eigenvalue problem.
    """
    mass, damping, stiffness = matrices
    factor, vectors = change
    unit = shape / shape[reference]
    slope = (2 * pole * np.diag(mass) + damping) @ unit
    stretch = factor * (vectors @ unit)
    by_pole = -stretch * (vectors @ unit) / (unit @ slope)
    load = -(stretch[:, None] * vectors + by_pole[:, None] * slope)
    rest = np.arange(unit.size) != reference
    dynamic = pole**2 * np.diag(mass) + pole * damping + stiffness
    by_shape = np.zeros(load.shape, complex)
    if rest.any():
        kept = dynamic[np.ix_(rest, rest)]
        by_shape[:, rest] = np.linalg.solve(kept, load[:, rest].T).T
    return by_pole, by_shape
