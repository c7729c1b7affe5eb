# SPDX-License-Identifier: MIT
"""A body reduced once: small matrices, rows of its ports, and what it leaves out."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.element_assembly import Sparse


class BodySource(StrEnum):
    """Where the matrices of a body are from."""

    MESH = "mesh"
    MATRICES = "matrices"
    MODAL_TABLE = "modal table"
    FRF_BLOCK = "FRF block"


@dataclass(frozen=True, slots=True, eq=False)
class BodyMatrices:
    """The matrices of one body before its reduction.

    Attributes:
        name: of the body.
        stiffness: K with its supports [N/m], shape (n, n).
        mass: M with masses attached to it [kg], shape (n, n).
        rigid: motions without strain, orthonormal in M, shape (n, k); None finds them
            among the modes.
        loss_factor: of structural damping [-].
        loss: loss factor times stiffness where parts of the body have different ones
            [N/m], shape (n, n); then `loss_factor` is the largest.
        source: of the matrices.
    """

    name: str
    stiffness: Sparse
    mass: Sparse
    rigid: FloatArray | None = None
    loss_factor: float = 0.0
    loss: Sparse | None = None
    source: BodySource = BodySource.MATRICES

    def __post_init__(self) -> None:
        """Check shapes and symmetry."""
        for name, matrix in (("stiffness", self.stiffness), ("mass", self.mass)):
            require_symmetric(f"{name} of body {self.name!r}", matrix)
        if self.stiffness.shape != self.mass.shape:
            raise BadData(
                f"body {self.name!r}: stiffness has shape {self.stiffness.shape}, mass "
                f"{self.mass.shape}; they must be equal"
            )


# Largest asymmetry of a symmetric matrix, as a share of its largest value.
_ASYMMETRY = 1e-8


def require_symmetric(name: str, matrix: Sparse) -> None:
    """Refuse a matrix that is not square and symmetric.

    Raises:
        BadData: the matrix is not symmetric.
    """
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise BadData(f"{name} has shape {matrix.shape}; it must be square")
    apart, largest = abs(matrix - matrix.T).max(), abs(matrix).max()
    if not apart <= _ASYMMETRY * largest:
        raise BadData(
            f"{name} is not symmetric: entries differ by {apart / largest:.2g} of the "
            f"largest, at most {_ASYMMETRY:g} is allowed; export symmetric K and M"
        )


@dataclass(frozen=True, slots=True, eq=False)
class BodyPort:
    """Where a body is joined, loaded or measured.

    Attributes:
        name: of the port.
        rows: from the degrees of freedom of the body to the motion of the port; a
            force on a row acts along it. Rows of a joint face are those of its
            quadrature points, weighted by the square root of their share of the area,
            direction by direction. Shape (n_rows, n).
        patterns: orthonormal force patterns whose static response is part of the
            basis, shape (n_rows, n_patterns).
    """

    name: str
    rows: Sparse
    patterns: FloatArray

    def __post_init__(self) -> None:
        """Check the shapes; make the array read-only."""
        if self.patterns.shape[0] != self.rows.shape[0]:
            raise BadData(
                f"port {self.name!r} has {self.rows.shape[0]} rows and patterns of "
                f"{self.patterns.shape[0]}"
            )
        freeze(self, "patterns")


def point_port(name: str, rows: Sparse | FloatArray) -> BodyPort:
    """Return a port of a few rows: a sensor, a load, the end of a spring.

    Args:
        name: of the port.
        rows: shape (n_rows, n).
    """
    sparse = Sparse(np.atleast_2d(rows)) if isinstance(rows, np.ndarray) else rows
    return BodyPort(name, sparse, np.eye(sparse.shape[0]))


@dataclass(frozen=True, slots=True, eq=False)
class Residual:
    """What is needed for the norm of the residual of a body.

    The norm is that of the inverse of A = K + shift M. For motions V y, the residual
    is a K V y + b M V y + P t + remainders, with the loads P of the patterns; the norm
    of the first three is that of root @ (a y, b y, t).

    Attributes:
        root: shape (n_rank, 2 r + n_patterns).
        patterns: of every port, in the order of the columns; shape (n_rows,
            n_patterns).
        compliance: of every port: largest eigenvalue of rows A^-1 rows' for forces
            outside of the patterns [m/N]; zero where the patterns are all forces.
        shift: [1/s^2].
    """

    root: FloatArray
    patterns: Mapping[str, FloatArray]
    compliance: Mapping[str, float]
    shift: float

    def columns(self) -> dict[str, slice]:
        """Return the columns of every port among the pattern columns."""
        found, at = {}, 0
        for name, pattern in self.patterns.items():
            found[name] = slice(at, at + pattern.shape[1])
            at += pattern.shape[1]
        return found


@dataclass(frozen=True, slots=True, eq=False)
class Component:
    """A reduced body in its own modal coordinates: its mass is the unit matrix.

    Attributes:
        name: of the body.
        stiffness: shape (r, r) [1/s^2]; exactly zero for the first `rigid` rows.
        loss: loss factor times stiffness, shape (r, r) [1/s^2].
        damping: viscous, shape (r, r) [1/s].
        rows: of every port, from reduced coordinates to its motion, shape (n_rows, r)
            [kg^-1/2].
        rigid: number of motions without strain, the first ones.
        source: of the body.
        basis: from reduced to the body's degrees of freedom, shape (n, r); no columns
            of n where there is no mesh.
        residual: for error bounds; None where the body is these coordinates and no
            more, as with measured bodies.
        loss_factor: of structural damping, the largest of its parts [-].
        error_bound: largest relative error of the free body's elastic frequencies in
            the band [-]; of a measured body two standard deviations.
    """

    name: str
    stiffness: FloatArray
    loss: FloatArray
    damping: FloatArray
    rows: Mapping[str, FloatArray]
    rigid: int
    source: BodySource
    basis: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    residual: Residual | None = None
    loss_factor: float = 0.0
    error_bound: float = 0.0

    def __post_init__(self) -> None:
        """Check the shapes; make the arrays read-only."""
        size = self.stiffness.shape[0]
        for name, rows in self.rows.items():
            if rows.shape[1] != size:
                raise BadData(
                    f"port {name!r} of {self.name!r} has {rows.shape[1]} columns; its "
                    f"body has {size}"
                )
        freeze(self, "stiffness", "loss", "damping", "basis")

    @property
    def size(self) -> int:
        """Number of reduced coordinates."""
        return int(self.stiffness.shape[0])

    @property
    def mass(self) -> FloatArray:
        """The unit matrix, shape (r, r)."""
        return np.eye(self.size)

    def port(self, name: str) -> FloatArray:
        """Return the rows of a port.

        Raises:
            UsageError: there is no such port.
        """
        if name not in self.rows:
            raise UsageError(
                f"body {self.name!r} has no port {name!r}; it has {list(self.rows)}"
            )
        return self.rows[name]
