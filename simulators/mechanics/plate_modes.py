# SPDX-License-Identifier: MIT
"""Bending modes of one free thick plate: Ritz's method on Mindlin's plate.

Source:
    Mindlin, J. Appl. Mech. 18 (1951) 31 (shear and rotatory inertia); the Ritz
    functions are products of Legendre polynomials (Liew et al., J. Sound Vib. 168
    (1993) 39).
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.polynomial import legendre

from jointbench.acquisition.basics.arrays import FloatArray, freeze

SHEAR_FACTOR = 5 / 6  # [-], of a rectangular section
_TERMS = 10  # polynomials in each direction: the tenth mode is converged to 1e-4
RIGID_MODES = 3  # heave, roll, pitch


@dataclass(frozen=True, slots=True)
class PlateDesign:
    """A rectangular plate.

    Attributes:
        length: along x [m].
        width: along y [m].
        thickness: [m].
        youngs_modulus: [Pa].
        poisson_ratio: [-].
        density: [kg/m^3].
    """

    length: float = 0.5
    width: float = 0.3
    thickness: float = 0.05
    youngs_modulus: float = 55e9
    poisson_ratio: float = 0.25
    density: float = 2600.0


@dataclass(frozen=True, slots=True, eq=False)
class PlateModes:
    """Mass-normalised bending modes of a free plate.

    Attributes:
        design: the plate.
        omega: angular frequencies, rigid modes first [rad/s], shape (n_modes,).
        shapes: coefficients of deflection and of the slopes of the normal [1/kg^0.5],
            shape (3, n_functions, n_modes).
    """

    design: PlateDesign
    omega: FloatArray
    shapes: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "omega", "shapes")


def plate_modes(design: PlateDesign, *, elastic: int) -> PlateModes:
    """Return the three rigid modes and the first elastic ones of a free plate.

    Args:
        design: the plate.
        elastic: number of elastic modes.
    """
    stiffness, mass = _matrices(design)
    last = RIGID_MODES + elastic - 1
    values, vectors = scipy.linalg.eigh(stiffness, mass, subset_by_index=[0, last])
    omega = np.sqrt(np.abs(values))
    omega[:RIGID_MODES] = 0.0
    # The sign of a mode is arbitrary: the corner at (0, 0) moves up.
    modes = PlateModes(design, omega, vectors.reshape(3, _TERMS**2, -1))
    corner = deflection(modes, 0.0, 0.0)
    return PlateModes(design, omega, modes.shapes * np.where(corner < 0, -1.0, 1.0))


def deflection(modes: PlateModes, x: float, y: float) -> FloatArray:
    """Return the deflection of each mode at a place, from a corner [1/kg^0.5].

    Args:
        modes: of the plate.
        x: along the length [m].
        y: along the width [m].

    Returns:
        Deflection out of plane, shape (n_modes,).
    """
    return np.asarray(_functions(modes, x, y) @ modes.shapes[0])


def slope(modes: PlateModes, x: float, y: float) -> FloatArray:
    """Return the rotation of the normal about y and x by each mode [1/(m kg^0.5)].

    Returns:
        Shape (2, n_modes): in the x-z plane, then in the y-z plane.
    """
    return np.asarray(np.einsum("f,cfm->cm", _functions(modes, x, y), modes.shapes[1:]))


def _functions(modes: PlateModes, x: float, y: float) -> FloatArray:
    design = modes.design
    along = legendre.legvander(np.array([2 * x / design.length - 1]), _TERMS - 1)[0]
    across = legendre.legvander(np.array([2 * y / design.width - 1]), _TERMS - 1)[0]
    return np.asarray(np.kron(along, across))


def _matrices(design: PlateDesign) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass of the Ritz functions, shape (3 n, 3 n)."""
    e, nu, h = design.youngs_modulus, design.poisson_ratio, design.thickness
    bending = e * h**3 / 12 / (1 - nu**2)
    twist = bending * (1 - nu) / 2
    shear = SHEAR_FACTOR * e / 2 / (1 + nu) * h
    mx, cx, kx = _integrals(design.length)
    my, cy, ky = _integrals(design.width)
    area = np.kron(mx, my)
    blocks = [
        [
            shear * (np.kron(kx, my) + np.kron(mx, ky)),
            shear * np.kron(cx, my),
            shear * np.kron(mx, cy),
        ],
        [
            shear * np.kron(cx, my).T,
            bending * np.kron(kx, my) + twist * np.kron(mx, ky) + shear * area,
            bending * nu * np.kron(cx, cy.T) + twist * np.kron(cx.T, cy),
        ],
        [
            shear * np.kron(mx, cy).T,
            (bending * nu * np.kron(cx, cy.T) + twist * np.kron(cx.T, cy)).T,
            bending * np.kron(mx, ky) + twist * np.kron(kx, my) + shear * area,
        ],
    ]
    turning = design.density * h**3 / 12
    mass = scipy.linalg.block_diag(
        design.density * h * area, turning * area, turning * area
    )
    return np.block(blocks), np.asarray(mass)


def _integrals(length: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the integrals of P_i P_j, P_i' P_j and P_i' P_j' over a side."""
    nodes, weights = legendre.leggauss(_TERMS + 1)
    values = legendre.legvander(nodes, _TERMS - 1).T
    slopes = np.array(
        [
            legendre.legval(nodes, legendre.legder(unit)) if i else np.zeros_like(nodes)
            for i, unit in enumerate(np.eye(_TERMS))
        ]
    )
    return (
        (values * weights) @ values.T * length / 2,
        (slopes * weights) @ values.T,
        (slopes * weights) @ slopes.T * 2 / length,
    )
