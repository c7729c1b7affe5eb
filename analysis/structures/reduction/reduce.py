# SPDX-License-Identifier: MIT
"""Reduce a structure body by body for a whole box of joint stiffnesses."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.bodywise import (
    BodyFactors,
    body_modes,
    factor_bodies,
    solve_bodywise,
)
from jointbench.analysis.structures.reduction.krylov_subspace import orthonormalise
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    frequency_bound,
)
from jointbench.analysis.structures.reduction.rigid_motions import (
    joint_strains,
    unstrained_bodies,
)
from jointbench.analysis.structures.reduction.sparse_factor import Solver

DEFAULT_BOX = (1e6, 1e11)
"""Range of total stiffness of machine joints [N/m]."""

# Trial points of the box, in addition to its lowest and highest corner.
_TRIALS = 128
# Points tried before the basis grows again.
_AT_ONCE = 16
_MOST_POINTS = 60
# First residual norm for the modes of a point: its square is the error of an isolated
# frequency. Where the bound of that point needs more (close modes, soft joints), it is
# reduced to a tenth each time, down to rounding.
_RESIDUAL_NORM = 3e-4
_TIGHTER = 0.1
_SMALLEST_NORM = 1e-7
# Directions of A^-1 this small relative to the largest are rounding.
_RANK = 1e-15


@dataclass(frozen=True, slots=True)
class ReductionStep:
    """Result of one added point.

    Attributes:
        worst: largest bound of all trial points, relative frequency [-].
        size: of the basis.
    """

    worst: float
    size: int


def reduce_structure(
    structure: Structure,
    *,
    modes: int,
    box: tuple[float, float] = DEFAULT_BOX,
    tolerance: float = 5e-5,
    loads: FloatArray | None = None,
    solver: Solver = Solver.AUTO,
    progress: Callable[[ReductionStep], None] | None = None,
) -> ReducedModel:
    """Reduce a structure to a basis valid for all joints in a box.

    The basis starts with the free modes of the bodies. The modes at the point of the
    box with the worst error bound are added, until the bound is small everywhere. No
    factor is larger than that of one body, or of bodies that are glued together.

    Args:
        structure: bodies and joints.
        modes: number of accurate modes, rigid ones included.
        box: smallest and largest total stiffness of any joint and direction [N/m].
        tolerance: of the bound, relative frequency [-].
        loads: rows of `sensor_rows` where forces act or FRFs are read, shape
            (n_points, n_free): the local compliance of the bodies there is added to the
            basis.
        solver: of the factors.
        progress: called after every point.

    Returns:
        The reduced structure.

    Raises:
        BadData: the bound stays above `tolerance` although the modes of its worst point
            are in the basis to rounding, or after so many points.
        UsageError: there is no joint with parameters, or the box is empty.

    Source:
        Rozza et al. 2008, Arch. Comput. Methods Eng. 15, 229-275 (greedy choice).
    """
    _require_box(structure, box)
    factors = factor_bodies(structure, solver)
    space = _Space.over(structure, factors, box[1])
    start = body_modes(structure, modes, solver)
    space.add(orthonormalise(space.basis, structure.mass, start))
    if loads is not None:
        space.add(_compliance(structure, factors, space.basis, loads))
    trials = _trial_points(len(structure.spread), box)
    norm, point = _RESIDUAL_NORM, np.zeros(0)
    for _ in range(_MOST_POINTS):
        model = space.model(box, modes)
        worst, trials = _open_points(model, trials, tolerance)
        if progress is not None:
            progress(ReductionStep(worst, model.size))
        if not trials:
            return model
        # A repeated point was not solved as accurately as its bound requires.
        again = np.array_equal(point, trials[0])
        norm, point = norm * _TIGHTER if again else _RESIDUAL_NORM, trials[0]
        if norm < _SMALLEST_NORM:
            break
        shapes = solve_bodywise(structure, factors, point, space.basis, modes + 2, norm)
        space.add(orthonormalise(space.basis, structure.mass, shapes))
    raise BadData(_stays(worst, tolerance, point, norm))


def _stays(worst: float, tolerance: float, point: FloatArray, norm: float) -> str:
    """Return the reason for a large bound: rounding, or too many points."""
    where = ", ".join(f"{one:.2g}" for one in point)
    text = (
        f"the reduced model's error bound stays at {worst:.2g} of the frequency, "
        f"{tolerance:g} is allowed, "
    )
    if norm < _SMALLEST_NORM:
        return text + (
            f"though the modes at joints of {where} N/m are solved to rounding; these "
            "joints are far softer or stiffer than the bodies: allow a larger "
            "tolerance, or narrow the box"
        )
    return text + (
        f"after {_MOST_POINTS} points, the last at {where} N/m; reduce fewer modes, or "
        "narrow the box"
    )


def _require_box(structure: Structure, box: tuple[float, float]) -> None:
    if not structure.spread or not 0 < box[0] < box[1]:
        raise UsageError(
            f"a reduction over joints from {box[0]:g} to {box[1]:g} N/m with "
            f"{len(structure.spread)} joint directions; give joints, and low below high"
        )


def _compliance(
    structure: Structure, factors: BodyFactors, basis: FloatArray, loads: FloatArray
) -> FloatArray:
    """Return the static response of the bodies to point loads.

    The response to each load at the shift, and the next term of its series.
    """
    first = factors.solve(np.ascontiguousarray(loads.T))
    second = factors.solve(structure.mass @ first)
    return orthonormalise(
        basis, structure.mass, np.concatenate([first, second], axis=1)
    )


def _open_points(
    model: ReducedModel, points: list[FloatArray], tolerance: float
) -> tuple[float, list[FloatArray]]:
    """Return the worst bound found, and the remaining points, the worst first.

    A growing basis only improves: a point within tolerance remains so.
    """
    while points:
        some, rest = points[:_AT_ONCE], points[_AT_ONCE:]
        bounds = np.array([_relative_bound(model, point) for point in some])
        order = [at for at in np.argsort(-bounds) if bounds[at] > tolerance]
        points = [*(some[at] for at in order), *rest]
        if order:
            return float(bounds[order[0]]), points
    return 0.0, points


def _relative_bound(model: ReducedModel, point: FloatArray) -> float:
    frequency, bound = frequency_bound(model, point)
    elastic = frequency > 0
    return float((bound[elastic] / frequency[elastic]).max(initial=0.0))


def _trial_points(count: int, box: tuple[float, float]) -> list[FloatArray]:
    """Spread points evenly over the logarithm of the box; two corners first."""
    low, high = np.log(box[0]), np.log(box[1])
    share = qmc.Sobol(count, seed=0).random(_TRIALS)
    corners = np.stack([np.zeros(count), np.ones(count)])
    return list(np.exp(low + (high - low) * np.concatenate([corners, share])))


@dataclass(slots=True, eq=False)
class _Space:
    """A growing basis, its products with the matrices, and their Riesz vectors."""

    structure: Structure
    factors: BodyFactors
    scale: FloatArray
    strains: FloatArray
    basis: FloatArray
    products: list[FloatArray]
    riesz: list[FloatArray]

    @classmethod
    def over(
        cls, structure: Structure, factors: BodyFactors, largest: float
    ) -> "_Space":
        """Return a basis of the motions that strain no body."""
        count = len(structure.spread)
        empty = [np.zeros((structure.size, 0)) for _ in range(2 + count)]
        still = unstrained_bodies(structure)
        strains = joint_strains(structure, still)
        space = cls(
            structure,
            factors,
            np.full(count, largest),
            strains,
            empty[0],
            empty,
            empty[:],
        )
        space.add(still)
        return space

    def add(self, new: FloatArray) -> None:
        """Append orthonormal columns, if there are any."""
        if not new.shape[1]:
            return
        mass = self.structure.mass @ new
        bodies = self.structure.stiffness @ new + self.structure.glue @ new
        bodies += self.factors.shift * mass
        joints = [
            scale * (spread @ new)
            for scale, spread in zip(self.scale, self.structure.spread, strict=True)
        ]
        products = [bodies, mass, *joints]
        riesz = [new, *(self.factors.solve(part) for part in products[1:])]
        self.basis = np.concatenate([self.basis, new], axis=1)
        self.products = _appended(self.products, products)
        self.riesz = _appended(self.riesz, riesz)

    def model(self, box: tuple[float, float], modes: int) -> ReducedModel:
        """Return the reduced model of the basis as it is."""
        basis, shift = self.basis, self.factors.shift
        bodies, mass, *joints = (_symmetric(basis.T @ part) for part in self.products)
        loss = _symmetric(basis.T @ (self.structure.loss @ basis))
        spread = [part / scale for part, scale in zip(joints, self.scale, strict=True)]
        elastic = bodies - shift * mass
        # Motions without strain have exactly zero strain, not rounding.
        still = self.strains.shape[1]
        for matrix in (elastic, loss):
            matrix[:still] = matrix[:, :still] = 0.0
        return ReducedModel(
            stiffness=elastic,
            spread=np.array(spread),
            loss=loss,
            basis=basis,
            riesz=self._norm(),
            scale=self.scale,
            strains=self.strains,
            shift=shift,
            box=box,
            modes=modes,
            names=self.structure.parameter_names,
        )

    def _norm(self) -> FloatArray:
        """Return a square root of the Gram matrix of the Riesz vectors."""
        gram = np.block(
            [[one.T @ other for other in self.products] for one in self.riesz]
        )
        length = np.sqrt(np.maximum(np.diag(gram), 1e-300))
        value, vector = np.linalg.eigh(_symmetric(gram / np.outer(length, length)))
        kept = value > _RANK * value[-1]
        root = np.sqrt(value[kept])[:, None] * vector[:, kept].T
        return np.asarray(root * length)


def _appended(old: list[FloatArray], new: list[FloatArray]) -> list[FloatArray]:
    return [np.concatenate(pair, axis=1) for pair in zip(old, new, strict=True)]


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray(0.5 * (matrix + matrix.T))
