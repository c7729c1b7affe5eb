# SPDX-License-Identifier: MIT
"""Modes of a free elastic block: Ritz's method in three dimensions.

Each displacement is a sum of products of Legendre polynomials; a block is symmetric
about its three middle planes, so its modes fall into eight classes of parity, each with
a small eigenvalue problem.

Source:
    Leissa and Zhang, J. Acoust. Soc. Am. 73 (1983) 2013; Visscher et al., J. Acoust.
    Soc. Am. 90 (1991) 2154.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
import scipy.linalg
from numpy.polynomial import legendre

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze

RIGID = 6  # motions without strain
_AXES = 3


@dataclass(frozen=True, slots=True)
class ElasticBlock:
    """A homogeneous rectangular block.

    Attributes:
        size: along x, y and z [m].
        youngs_modulus: [Pa].
        poisson_ratio: [-].
        density: [kg/m^3].
    """

    size: tuple[float, float, float]
    youngs_modulus: float
    poisson_ratio: float
    density: float

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.density * float(np.prod(self.size))


@dataclass(frozen=True, slots=True, eq=False)
class BlockModes:
    """Mass-normalised modes of a free block, rigid ones first.

    Attributes:
        block: the block.
        terms: polynomials along each side.
        frequency: natural frequencies [Hz], shape (n_modes,).
        coefficients: of the polynomials [1/kg^0.5], shape (3, *terms, n_modes).
    """

    block: ElasticBlock
    terms: tuple[int, int, int]
    frequency: FloatArray
    coefficients: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "coefficients")


@lru_cache(maxsize=16)
def block_modes(
    block: ElasticBlock, *, terms: tuple[int, int, int], elastic: int
) -> BlockModes:
    """Return the six rigid and the first elastic modes of a free block.

    Args:
        block: the block.
        terms: polynomials along each side, each at least 2.
        elastic: number of elastic modes.
    """
    count = RIGID + elastic
    found: list[tuple[float, FloatArray]] = []
    for parity in product((0, 1), repeat=_AXES):
        chosen = [_chosen(parity, axis, terms) for axis in range(_AXES)]
        stiffness, mass = _matrices(block, chosen)
        last = min(count, mass.shape[0]) - 1
        values, vectors = scipy.linalg.eigh(
            stiffness, mass, subset_by_index=[0, last], driver="gvx"
        )
        for value, vector in zip(values, vectors.T, strict=True):
            found.append((float(value), _spread(vector, chosen, terms)))
    found.sort(key=lambda pair: pair[0])
    kept = found[:count]
    omega = np.sqrt(np.maximum([value for value, _ in kept], 0.0))
    omega[:RIGID] = 0.0
    shapes = np.stack([shape for _, shape in kept], axis=-1)
    return BlockModes(block, terms, omega / (2 * np.pi), shapes)


def displacement(modes: BlockModes, place: FloatArray) -> FloatArray:
    """Return the displacement of each mode at a place [1/kg^0.5], shape (3, n_modes).

    Args:
        modes: of the block.
        place: from the corner with the least coordinates [m], shape (3,).
    """
    x, y, z = _values(modes, place, None)
    return np.asarray(np.einsum("cijkm,i,j,k->cm", modes.coefficients, x, y, z))


def displacements(modes: BlockModes, places: FloatArray) -> FloatArray:
    """Return the displacement of each mode at places, shape (n_places, 3, n_modes).

    Args:
        modes: of the block.
        places: from the corner with the least coordinates [m], shape (n_places, 3).
    """
    x, y, z = (
        legendre.legvander(2 * at / side - 1, count - 1)
        for at, side, count in zip(places.T, modes.block.size, modes.terms, strict=True)
    )
    products = np.einsum("ni,nj,nk->nijk", x, y, z).reshape(len(places), -1)
    shapes = modes.coefficients.reshape(_AXES, products.shape[1], -1)
    return np.asarray((products @ shapes).transpose(1, 0, 2))


def displacement_gradient(modes: BlockModes, place: FloatArray) -> FloatArray:
    """Return the derivatives of the displacement at a place [1/(m kg^0.5)].

    Args:
        modes: of the block.
        place: from the corner with the least coordinates [m], shape (3,).

    Returns:
        Shape (3, 3, n_modes): derivative along x, y, z; component; mode.
    """
    rows = []
    for axis in range(_AXES):
        x, y, z = _values(modes, place, axis)
        rows.append(np.einsum("cijkm,i,j,k->cm", modes.coefficients, x, y, z))
    return np.stack(rows)


def _values(
    modes: BlockModes, place: FloatArray, slope: int | None
) -> tuple[FloatArray, ...]:
    """Return the polynomials of each axis at a place, one axis differentiated."""
    rows = []
    for axis, (side, count) in enumerate(
        zip(modes.block.size, modes.terms, strict=True)
    ):
        at = np.array([2 * place[axis] / side - 1])
        if axis == slope:
            slopes = legendre.legder(np.eye(count), axis=0)
            rows.append(legendre.legval(at, slopes)[:, 0] * 2 / side)
        else:
            rows.append(legendre.legvander(at, count - 1)[0])
    return tuple(rows)


def _chosen(
    parity: tuple[int, ...], axis: int, terms: tuple[int, int, int]
) -> list[IntArray]:
    """Return the polynomials of a displacement in one class, along each side.

    A displacement is odd about its own middle plane where the others are even.
    """
    return [
        np.arange((parity[side] + (side == axis)) % 2, terms[side], 2)
        for side in range(_AXES)
    ]


def _spread(
    vector: FloatArray, chosen: list[list[IntArray]], terms: tuple[int, int, int]
) -> FloatArray:
    """Return the coefficients among all polynomials, the largest one positive."""
    whole = np.zeros((_AXES, *terms))
    start = 0
    for axis, (i, j, k) in enumerate(chosen):
        size = i.size * j.size * k.size
        block = vector[start : start + size].reshape(i.size, j.size, k.size)
        whole[axis][np.ix_(i, j, k)] = block
        start += size
    largest = whole.flat[int(np.argmax(np.abs(whole)))]
    return np.asarray(whole * np.sign(largest))


def _matrices(
    block: ElasticBlock, chosen: list[list[IntArray]]
) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass of one class."""
    shear = block.youngs_modulus / 2 / (1 + block.poisson_ratio)
    lame = 2 * shear * block.poisson_ratio / (1 - 2 * block.poisson_ratio)
    tables = [
        _integrals(side, 1 + max(int(rows[axis][-1]) for rows in chosen))
        for axis, side in enumerate(block.size)
    ]

    def integral(a: int, b: int, left: int | None, right: int | None) -> FloatArray:
        """Integrate displacements a and b, differentiated along left and right."""
        factors = [
            tables[side][left == side][right == side][
                np.ix_(chosen[a][side], chosen[b][side])
            ]
            for side in range(_AXES)
        ]
        return np.asarray(np.kron(np.kron(factors[0], factors[1]), factors[2]))

    stiffness, mass = [], []
    for a, b in product(range(_AXES), repeat=2):
        # Strain energy: lambda (div u)^2 + mu (sum over i, j of u_i,j (u_i,j + u_j,i)).
        part = lame * integral(a, b, a, b) + shear * integral(a, b, b, a)
        if a == b:
            part += shear * sum(integral(a, a, d, d) for d in range(_AXES))
            mass.append(block.density * integral(a, a, None, None))
        stiffness.append(part)
    rows = [np.hstack(stiffness[_AXES * a : _AXES * a + _AXES]) for a in range(_AXES)]
    return np.vstack(rows), np.asarray(scipy.linalg.block_diag(*mass))


@lru_cache(maxsize=32)
def _integrals(
    side: float, count: int
) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    """Return integrals of P_i P_j: [i differentiated][j differentiated]."""
    nodes, weights = legendre.leggauss(count + 1)
    values = legendre.legvander(nodes, count - 1)
    slopes = legendre.legval(nodes, legendre.legder(np.eye(count), axis=0)).T
    weighted = weights[:, None] * values
    plain = weighted.T @ values * side / 2
    mixed = slopes.T @ weighted
    bent = slopes.T @ (weights[:, None] * slopes) * 2 / side
    return (plain, mixed.T), (mixed, bent)
