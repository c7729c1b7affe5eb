# SPDX-License-Identifier: MIT
"""Boundary elements of two plates under bolts: layers, or half-spaces.

The normal displacement of the sides is 0, so that pressures are sums of cosines, and
the motion of each surface under a wave of pressure on either surface is known in closed
form for every thickness (Sneddon, Fourier Transforms (1951), sec. 45-46). Short waves
see half-spaces; for blocks only these are used. Solved by Newton's method with
conjugate gradients, each product by a cosine transform.
"""

from dataclasses import dataclass

import numpy as np
from scipy import fft, ndimage
from scipy.sparse.linalg import LinearOperator, cg

from jointbench.analysis.structures.pressure.pressure_totals import OPEN

MODULUS, POISSON = 200e9, 0.3
SIDE = 0.2
_LEAST = 1e-9
_FINER = 8


@dataclass(frozen=True)
class Plates:
    """Two plates of one thickness, four bolts at equal distance from the middle.

    Attributes:
        name: of the case.
        thickness: [m].
        reach: of the bolts from the middle along x and y [m].
        head: diameter [m].
        preload: of each bolt [N].
        stiffness: of the law at 1 MPa [N/m^3].
        exponent: of the law [-].
        crown: gap at the corners of a quarter of each plate, a paraboloid about its
            middle [m].
        half_space: the reference has no second surface.
    """

    name: str
    thickness: float
    reach: float
    head: float
    preload: float
    stiffness: float
    exponent: float
    crown: float = 0.0
    half_space: bool = False


@dataclass(frozen=True)
class LayerContact:
    """What boundary elements say: shares of the surface, stiffness of four bolts.

    Attributes:
        closed: at 1 % of the mean pressure or more [-].
        touching: with any pressure [-].
        normal: [N/m].
        rocking: about the middle of the four [N m/rad].
    """

    closed: float
    touching: float
    normal: float
    rocking: float


def layer_contact(case: Plates, cells: int) -> LayerContact:
    """Solve a quarter of the plates, with a mirror at each of its sides.

    Args:
        case: the plates.
        cells: along each side of the quarter.
    """
    side = SIDE / 2
    step = side / cells
    own, across = _waves(case, cells)
    centre = (np.arange(cells) + 0.5) * step
    x, y = np.meshgrid(centre, centre, indexing="ij")
    gap = case.crown * ((x - side / 2) ** 2 + (y - side / 2) ** 2) / (side**2 / 2)
    free = -_moved(across, _heads(case, x, y, step)) - gap
    pressure, level = _solved(case, own, free, step**2)
    mean = case.preload / side**2
    approach = free + level - _moved(own, pressure)
    power = case.stiffness * (OPEN * mean / 1e6) ** case.exponent
    edge = OPEN * mean / power / (1 - case.exponent)
    # The approach is smooth across the edge: a spline finds the edge within the cells.
    fine = ndimage.zoom(approach, _FINER, order=3, grid_mode=True, mode="reflect")
    stiffness = 4 * step**2 * case.stiffness * (pressure / 1e6) ** case.exponent
    return LayerContact(
        float((fine >= edge).mean()),
        float((fine > 0).mean()),
        float(stiffness.sum()),
        float((stiffness * y**2).sum()),
    )


def _waves(case: Plates, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Return inward motion of an inner surface by its own pressure, and by the heads'.

    Shape (cells, cells) each, for waves of 1 Pa [m/Pa].
    """
    wave = np.pi * np.arange(cells) / (SIDE / 2)
    size = np.hypot(wave[:, None], wave[None])
    size[0, 0] = 1.0
    half = 2 / (MODULUS / (1 - POISSON**2) * size)
    reach = np.minimum(size * case.thickness, 300.0)
    even = half * (np.cosh(reach) - 1) / (np.sinh(reach) + reach)
    odd = half * (np.cosh(reach) + 1) / (np.sinh(reach) - reach)
    own, across = 0.5 * (even + odd), 0.5 * (even - odd)
    if case.half_space:
        own, across = half, np.zeros_like(half)
    own[0, 0] = across[0, 0] = 0.0
    return own, across


def _moved(factor: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """Return the motion of both bodies together [m]."""
    return 2 * fft.idctn(factor * fft.dctn(pressure, norm="ortho"), norm="ortho")


def _heads(case: Plates, x: np.ndarray, y: np.ndarray, step: float) -> np.ndarray:
    """Return the pressure below the head, cells cut by its edge in part [Pa]."""
    fine = ((np.arange(16) + 0.5) / 16 - 0.5) * step
    covered = np.zeros_like(x)
    for a in fine:
        for b in fine:
            from_bolt = np.hypot(x + a - case.reach, y + b - case.reach)
            covered += from_bolt <= case.head / 2
    return covered * case.preload / (covered.sum() * step**2)


def _solved(
    case: Plates, own: np.ndarray, free: np.ndarray, area: float
) -> tuple[np.ndarray, float]:
    """Return pressures p >= 0 with approach(p) + G p - free = c where p > 0, and c.

    The law is the power law itself, without a straight start.
    """
    even = case.preload / (area * free.size)
    least = _LEAST * even
    pressure = np.full(free.shape, even)
    for _ in range(200):
        slope = case.stiffness * (np.maximum(pressure, least) / 1e6) ** case.exponent
        residual = free - pressure / slope / (1 - case.exponent) - _moved(own, pressure)
        on = pressure > 0
        change, level = _step(
            own, on, 1 / slope[on], residual[on], area, case, pressure
        )
        new = np.zeros_like(pressure)
        new[on] = np.clip(pressure[on] + change, 0.1 * pressure[on], 10 * pressure[on])
        new[new < least] = 0.0
        back = ~on & (free + level - _moved(own, new) > 0)
        new[back] = 2 * least
        moved = np.abs(new - pressure).sum() / new.sum()
        pressure = new
        if moved < 1e-7:
            return pressure, level
    raise RuntimeError(f"{case.name}: the boundary elements did not settle")


def _step(
    own: np.ndarray,
    on: np.ndarray,
    soft: np.ndarray,
    residual: np.ndarray,
    area: float,
    case: Plates,
    pressure: np.ndarray,
) -> tuple[np.ndarray, float]:
    """Return changes of the closed pressures, and the level that keeps the force."""

    def product(value: np.ndarray) -> np.ndarray:
        whole = np.zeros(on.shape)
        whole[on] = value
        return _moved(own, whole)[on] + soft * value

    scale = 1 / (soft + 2 * own[own.shape[0] // 3, own.shape[1] // 3])
    shape = (soft.size, soft.size)
    system = LinearOperator(shape, matvec=product)
    near = LinearOperator(shape, matvec=lambda value: scale * value)
    fixed, _ = cg(system, residual, rtol=1e-8, M=near, maxiter=3000)
    lifted, _ = cg(system, np.ones(soft.size), rtol=1e-8, M=near, maxiter=3000)
    missing = case.preload / area - pressure.sum() - fixed.sum()
    level = float(missing / lifted.sum())
    return fixed + level * lifted, level
