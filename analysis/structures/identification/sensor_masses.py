# SPDX-License-Identifier: MIT
"""Masses of sensors as parameters of a reduced structure.

A factor on the mass of a sensor changes M by a matrix of rank three. The reduced
coordinates are turned so that their mass is the unit matrix again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_triangular

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.joint_matrices import nearest_node
from jointbench.analysis.structures.matrices.parts import PointMass
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    rows_of,
)

MASS = "mass"


@dataclass(frozen=True, slots=True, eq=False)
class SensorMasses:
    """Sensors whose masses are unknown around their nominal values.

    Attributes:
        names: of the parameters, factors on the masses: ``"<sensor>.mass"``.
        deviations: standard deviations of the logarithms of the factors [-].
        rows: of the nodes that carry them, times the root of the nominal mass, over the
            degrees of freedom of the mesh [kg^1/2], shape (n, 3, n_free).
        reduced: the same over the reduced coordinates [1], shape (n, 3, r).
    """

    names: tuple[str, ...]
    deviations: tuple[float, ...]
    rows: FloatArray
    reduced: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "rows", "reduced")


def mass_name(sensor: str) -> str:
    """Return the name of the parameter of a sensor: factor on its nominal mass."""
    return f"{sensor}.{MASS}"


def is_mass(name: str) -> bool:
    """Return whether a parameter is a factor on a mass."""
    return name.endswith(f".{MASS}")


def sensor_masses(
    structure: Structure,
    model: ReducedModel,
    masses: Mapping[str, PointMass],
    deviations: Mapping[str, float],
) -> SensorMasses:
    """Return the masses that are unknown.

    Args:
        structure: with the nominal masses.
        model: the reduced structure.
        masses: of the sensors, by name.
        deviations: relative standard deviations of those that are unknown.

    Raises:
        UsageError: a sensor does not exist, or has no mass.
    """
    found = []
    for name in deviations:
        if name not in masses or not masses[name].mass > 0:
            raise UsageError(
                f"the mass of sensor {name!r} is unknown by mass_sd, but the model has "
                f"none; sensors with a mass are {list(masses)}"
            )
        found.append(_rows(structure, masses[name]))
    rows = np.array(found).reshape(-1, 3, structure.size)
    reduced = np.array([rows_of(model, one) for one in found])
    return SensorMasses(
        tuple(map(mass_name, deviations)),
        tuple(deviations.values()),
        rows,
        reduced.reshape(-1, 3, model.size),
    )


def _rows(structure: Structure, one: PointMass) -> FloatArray:
    at = [body.name for body in structure.bodies].index(one.body)
    node = nearest_node(structure.bodies[at].mesh, one.position)
    place = 3 * (node + int(structure.first_node[at])) + np.arange(3)
    return np.asarray(np.sqrt(one.mass) * (structure.free == place[:, None]))


def with_mass_factors(
    model: ReducedModel, masses: SensorMasses, factors: FloatArray
) -> tuple[ReducedModel, FloatArray]:
    """Return a model with other masses, and the turn from its coordinates.

    Args:
        model: at the nominal masses.
        masses: which are unknown.
        factors: on these, shape (n,) [-].

    Returns:
        The model in coordinates with unit mass, and a matrix from these to the present
        ones, shape (r, r). Motions without strain stay the first coordinates.
    """
    change = np.einsum("s,sir,sit->rt", factors - 1.0, masses.reduced, masses.reduced)
    lower = np.linalg.cholesky(np.eye(model.size) + change)
    turn = solve_triangular(lower, np.eye(model.size), lower=True).T
    still = model.strains.shape[1]
    rigid = turn[:still, :still]
    fixed = model.fixed_strain
    return (
        replace(
            model.restricted(turn),
            strains=rigid.T @ model.strains @ rigid,
            fixed_strain=None if fixed is None else rigid.T @ fixed @ rigid,
        ),
        turn,
    )


def structure_with_masses(
    structure: Structure, masses: SensorMasses, factors: Sequence[float]
) -> Structure:
    """Return a structure with other masses of its sensors.

    Args:
        structure: at the nominal masses.
        masses: which are unknown.
        factors: on these [-].
    """
    whole = structure.mass
    for rows, factor in zip(masses.rows, factors, strict=True):
        sparse = Sparse(rows)
        whole = whole + (factor - 1.0) * (sparse.T @ sparse)
    return replace(structure, mass=Sparse(whole))
