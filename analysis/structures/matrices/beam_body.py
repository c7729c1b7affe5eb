# SPDX-License-Identifier: MIT
"""Timoshenko beams for spindles, screws and columns: six motions for each node.

Bending with shear, rotary inertia, stretch and torsion of straight, stepped beams.
Shape functions are the static solutions of a uniform element, so that a point load at a
node is exact for any number of elements. Frequencies converge with the square of the
length of an element, because shear is constant within it. A beam that turns about its
axis has gyroscopic moments.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_positive
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.element_assembly import Material, Sparse

# Nodes closer than this share of the beam are one.
_SAME = 1e-9
_GAUSS = 4


@dataclass(frozen=True, slots=True)
class BeamSection:
    """A stretch of a beam with a solid or hollow round section.

    Attributes:
        length: [m].
        diameter: outer [m].
        bore: inner diameter [m].
        elements: number of elements.
    """

    length: float
    diameter: float
    bore: float = 0.0
    elements: int = 8

    def __post_init__(self) -> None:
        """Check sizes."""
        require_positive("length", self.length)
        require_positive("elements", self.elements)
        if not 0.0 <= self.bore < self.diameter:
            raise BadData(
                f"a section of diameter {self.diameter:g} m with a bore of "
                f"{self.bore:g} m; the bore must be smaller, and not negative"
            )

    @property
    def area(self) -> float:
        """Of the section [m^2]."""
        return float(np.pi / 4 * (self.diameter**2 - self.bore**2))

    @property
    def second_moment(self) -> float:
        """Of the area, about a diameter [m^4]."""
        return float(np.pi / 64 * (self.diameter**4 - self.bore**4))

    def shear_factor(self, poisson: float) -> float:
        """Return kappa [-] of the section.

        Args:
            poisson: Poisson's ratio [-].

        Source:
            Cowper 1966, J. Appl. Mech. 33, 335-340: hollow circle.
        """
        m2 = (self.bore / self.diameter) ** 2
        whole = 6 * (1 + poisson) * (1 + m2) ** 2
        return float(
            whole / ((7 + 6 * poisson) * (1 + m2) ** 2 + (20 + 12 * poisson) * m2)
        )


@dataclass(frozen=True, slots=True, eq=False)
class BeamBody:
    """A straight beam.

    Attributes:
        name: of the body.
        nodes: on the axis [m], shape (n_nodes, 3).
        stiffness: K; each node has displacement x, y, z [m] and rotation x, y, z [rad],
            shape (6 n_nodes, 6 n_nodes).
        mass: M, same shape.
        radius: outer, at each node [m], shape (n_nodes,).
        loss_factor: of the material [-].
        gyroscopic: G of a turn about the axis at 1 rad/s: moments are G times velocity
            [kg m^2], antisymmetric, same shape as M.
    """

    name: str
    nodes: FloatArray
    stiffness: Sparse
    mass: Sparse
    radius: FloatArray
    loss_factor: float
    gyroscopic: Sparse

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "nodes", "radius")

    def motion_at(self, position: Sequence[float]) -> Sparse:
        """Return the motion of a point carried by the nearest node.

        Args:
            position: of the point [m]: on the axis, or within the outer radius of it.

        Returns:
            Displacement and rotation x, y, z, shape (6, 6 n_nodes).

        Raises:
            BadData: the point is not on the beam.
        """
        point = np.asarray(position, float)
        distance = np.linalg.norm(self.nodes - point, axis=1)
        at = int(np.argmin(distance))
        step = float(np.linalg.norm(self.nodes[1] - self.nodes[0]))
        reach = float(self.radius[at]) + 0.5 * step
        if distance[at] > reach:
            raise BadData(
                f"point {point.tolist()} m is {distance[at]:.3g} m from the nearest "
                f"node of beam {self.name!r}; at most {reach:.3g} m is on it"
            )
        carried = np.eye(6)
        carried[:3, 3:] = -cross_matrix(point - self.nodes[at])
        rows = np.zeros((6, 6 * len(self.nodes)))
        rows[:, 6 * at : 6 * at + 6] = carried
        return Sparse(rows)


def beam_body(
    name: str,
    begin: Sequence[float],
    direction: Sequence[float],
    sections: Sequence[BeamSection],
    material: Material,
) -> BeamBody:
    """Return a stepped beam.

    Args:
        name: of the body.
        begin: first end [m].
        direction: of the axis, of any length.
        sections: from the first end on.
        material: of all sections.

    Returns:
        The beam.

    Raises:
        BadData: there is no section, or the axis has no direction.

    Source:
        Przemieniecki, Theory of Matrix Structural Analysis (1968), sec. 5.6; Friedman
        and Kosmatka 1993, Comput. Struct. 47, 473-481.
    """
    axis = np.asarray(direction, float)
    length = float(np.linalg.norm(axis))
    if not sections or not length > _SAME:
        raise BadData(f"beam {name!r} needs an axis and one section at the least")
    pieces = [one for one in sections for _ in range(one.elements)]
    steps = [one.length / one.elements for one in pieces]
    along = np.concatenate([[0.0], np.cumsum(steps)])
    nodes = np.asarray(begin, float) + np.outer(along, axis / length)
    size = 6 * nodes.shape[0]
    stiffness, mass, gyroscopic = (np.zeros((size, size)) for _ in range(3))
    turn = np.kron(np.eye(4), _frame(axis / length))
    for at, (one, step) in enumerate(zip(pieces, steps, strict=True)):
        own = slice(6 * at, 6 * at + 12)
        k, m = _element(one, step, material)
        stiffness[own, own] += turn.T @ k @ turn
        mass[own, own] += turn.T @ m @ turn
        gyroscopic[own, own] += turn.T @ _gyroscopic(one, step, material) @ turn
    half = [one.diameter / 2 for one in pieces]
    radius = np.maximum([half[0], *half], [*half, half[-1]])
    return BeamBody(
        name,
        nodes,
        Sparse(stiffness),
        Sparse(mass),
        radius,
        material.loss_factor,
        Sparse(gyroscopic),
    )


def _frame(axis: FloatArray) -> FloatArray:
    """Return rows: the axis and two directions across it."""
    across = np.eye(3)[int(np.argmin(np.abs(axis)))]
    second = np.cross(axis, across)
    second /= np.linalg.norm(second)
    return np.stack([axis, second, np.cross(axis, second)])


def cross_matrix(arm: FloatArray) -> FloatArray:
    """Return the matrix of the cross product from the left."""
    x, y, z = arm
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _element(
    section: BeamSection, length: float, material: Material
) -> tuple[FloatArray, FloatArray]:
    """Return K and M in the frame of the axis: u, v, w and their rotations twice."""
    shear = material.youngs_modulus / (2.0 * (1.0 + material.poisson_ratio))
    bar = np.array([[1.0, -1.0], [-1.0, 1.0]]) / length
    heavy = np.array([[2.0, 1.0], [1.0, 2.0]]) * length / 6.0 * material.density
    polar = 2.0 * section.second_moment
    bend, inert = _bending(section, length, material)
    k, m = np.zeros((12, 12)), np.zeros((12, 12))
    parts = (
        ((0, 6), material.youngs_modulus * section.area * bar, section.area * heavy),
        ((3, 9), shear * polar * bar, polar * heavy),
        ((1, 5, 7, 11), bend, inert),
        ((2, 4, 8, 10), _mirrored(bend), _mirrored(inert)),
    )
    for places, stiff, weight in parts:
        own = np.ix_(places, places)
        k[own] += stiff
        m[own] += weight
    return k, m


def _mirrored(matrix: FloatArray) -> FloatArray:
    """Return the matrix of the other plane: a rotation about y lowers w."""
    sign = np.array([1.0, -1.0, 1.0, -1.0])
    return np.asarray(matrix * np.outer(sign, sign))


def _bending(
    section: BeamSection, length: float, material: Material
) -> tuple[FloatArray, FloatArray]:
    """Return K and M for deflection and slope at both ends of an element."""
    shear = material.youngs_modulus / (2.0 * (1.0 + material.poisson_ratio))
    rigid = material.youngs_modulus * section.second_moment
    sheared = section.shear_factor(material.poisson_ratio) * shear * section.area
    g = rigid / sheared
    polynomial = _polynomial(length, g)
    point, weight = np.polynomial.legendre.leggauss(_GAUSS)
    x, weight = 0.5 * length * (1.0 + point), 0.5 * length * weight
    deflection, slope = (one @ polynomial for one in _both(x, g))
    zero = np.zeros_like(x)
    curved = np.stack([zero, zero, zero + 2.0, 6.0 * x], axis=1) @ polynomial
    glide = np.stack([zero, zero, zero, zero - 6.0 * g], axis=1) @ polynomial

    def square(rows: FloatArray) -> FloatArray:
        return np.asarray((rows * weight[:, None]).T @ rows)

    stiffness = rigid * square(curved) + sheared * square(glide)
    inertia = section.area * square(deflection) + section.second_moment * square(slope)
    return stiffness, material.density * inertia


def _polynomial(length: float, g: float) -> FloatArray:
    """Return the coefficients of the static shapes of deflection and slope.

    Deflection a + b x + c x^2 + d x^3, slope of the section b + 2 c x + (3 x^2 + 6
    g) d.
    """
    ends = [row for x in (0.0, length) for row in _both(np.array([x]), g)]
    return np.asarray(np.linalg.inv(np.concatenate(ends)))


def _gyroscopic(section: BeamSection, length: float, material: Material) -> FloatArray:
    """Return G in the frame of the axis, at 1 rad/s about it.

    The angular momentum along the axis follows the sections as they tilt.
    """
    shear = material.youngs_modulus / (2.0 * (1.0 + material.poisson_ratio))
    factor = section.shear_factor(material.poisson_ratio)
    g = (
        material.youngs_modulus
        * section.second_moment
        / (factor * shear * section.area)
    )
    point, weight = np.polynomial.legendre.leggauss(_GAUSS)
    x, weight = 0.5 * length * (1.0 + point), 0.5 * length * weight
    slope = _both(x, g)[1] @ _polynomial(length, g)
    about_y, about_z = np.zeros((2, x.size, 12))
    about_z[:, (1, 5, 7, 11)] = slope
    about_y[:, (2, 4, 8, 10)] = -slope * np.array([1.0, -1.0, 1.0, -1.0])
    polar = material.density * 2.0 * section.second_moment
    half = polar * (about_y * weight[:, None]).T @ about_z
    return np.asarray(half - half.T)


def _both(x: FloatArray, g: float) -> tuple[FloatArray, FloatArray]:
    """Return rows of deflection and slope for the polynomial's coefficients."""
    one, zero = np.ones_like(x), np.zeros_like(x)
    deflection = np.stack([one, x, x**2, x**3], axis=1)
    slope = np.stack([zero, one, 2.0 * x, 3.0 * x**2 + 6.0 * g], axis=1)
    return deflection, slope
