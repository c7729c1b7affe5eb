# SPDX-License-Identifier: MIT
"""The bodies as they are, beside the modal table that describes them.

An exact table lists all modes that the simulated body has. A table of real life is
that of the drawing: the true frequencies are off by 0.2 to 1 %, the true shapes are a
rotation of those of the table by 2 %, and the body may have modes that the table lacks.
"""

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.flexible.block_modes import (
    RIGID,
    BlockModes,
    block_modes,
    displacement,
    displacement_gradient,
    displacements,
)
from jointbench.simulators.flexible.flexible_specimen import (
    BoltedSpecimen,
    ElasticBody,
    Vector,
    table_size,
)

WORLDS = ("exact", "life")
FREQUENCY_ERRORS = (0.002, 0.01)
"""Relative standard deviation of the frequencies of a table, drawn log-uniformly."""
MESHED_EFFECTS = ("thickness",)
"""Effects that a model of meshed bodies shows, and a modal table does not."""
SHAPE_ERROR = 0.02
"""Mean norm of what is mixed into a mode shape [-]."""
_NEAR = 0.3  # distance in the logarithm of the frequency that halves the mixing


@dataclass(frozen=True, slots=True, eq=False)
class PhysicalBody:
    """A body with its true modes, and the table that describes it.

    Attributes:
        body: size, material and place.
        modes: those of the drawing; the table lists the first `listed` of them.
        listed: number of modes in the table, rigid ones included.
        frequency: true ones [Hz], shape (n_modes,).
        mixing: true modes in those of the drawing, shape (n_modes, n_modes).
        grown: modes of the body as it is, where a side has another length than in the
            drawing; places on it are where they are on the body of the drawing.
    """

    body: ElasticBody
    modes: BlockModes
    listed: int
    frequency: FloatArray
    mixing: FloatArray
    grown: BlockModes | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "mixing")

    def rows(self, place: Vector) -> FloatArray:
        """Return the true displacement at a place [1/kg^0.5], shape (3, n_modes)."""
        at = self.body.within(place)
        if self.grown is None:
            return displacement(self.modes, at) @ self.mixing
        ratio = np.array(self.grown.block.size) / np.array(self.modes.block.size)
        return displacement(self.grown, at * ratio) @ self.mixing

    def table_rows(self, place: Vector) -> FloatArray:
        """Return the displacement at a place in the table, shape (3, listed)."""
        rows = displacement(self.modes, self.body.within(place))
        return rows[:, : self.listed]

    def table_nodes(self, places: FloatArray) -> FloatArray:
        """Return the displacement at places [m] in the table, (n, 3, listed)."""
        rows = displacements(self.modes, places - np.array(self.body.corner))
        return rows[..., : self.listed]

    def table_gradient(self, place: Vector) -> FloatArray:
        """Return its derivatives in the table, shape (3, 3, listed)."""
        rows = displacement_gradient(self.modes, self.body.within(place))
        return rows[..., : self.listed]

    @property
    def table_frequency(self) -> FloatArray:
        """Natural frequencies in the table [Hz], shape (listed,)."""
        return self.modes.frequency[: self.listed]


def physical_bodies(
    specimen: BoltedSpecimen, world: str, *, beyond: int, rng: np.random.Generator
) -> tuple[PhysicalBody, PhysicalBody]:
    """Return the bodies of a specimen as they are.

    Args:
        specimen: as drawn.
        world: ``exact`` or ``life``.
        beyond: modes that the bodies have and the tables lack.
        rng: source of the deviations from the drawing.

    Raises:
        UsageError: there is no such world.
    """
    if world not in WORLDS:
        raise UsageError(f"world is {world!r}; it is {' or '.join(WORLDS)}")
    first, second = (
        _physical(body, world == "exact", beyond, rng) for body in specimen.bodies
    )
    return first, second


def thicker_body(body: PhysicalBody, factor: float) -> PhysicalBody:
    """Return a body with its shortest side longer by a factor.

    Args:
        body: of an exact table.
        factor: thickness over that of the drawing [-].
    """
    block = body.modes.block
    size = list(block.size)
    side = int(np.argmin(size))
    size[side] *= factor
    grown = block_modes(
        replace(block, size=(size[0], size[1], size[2])),
        terms=body.modes.terms,
        elastic=body.modes.frequency.size - RIGID,
    )
    shift = grown.frequency[RIGID:] / body.modes.frequency[RIGID:]
    frequency = body.frequency.copy()
    frequency[RIGID:] *= shift
    return replace(body, frequency=frequency, grown=grown)


def _physical(
    body: ElasticBody, exact: bool, beyond: int, rng: np.random.Generator
) -> PhysicalBody:
    listed = RIGID + table_size(body)
    modes = body.modes(listed - RIGID + beyond)
    count = modes.frequency.size
    if exact:
        return PhysicalBody(body, modes, listed, modes.frequency, np.eye(count))
    low, high = np.log(FREQUENCY_ERRORS)
    spread = float(np.exp(rng.uniform(low, high)))
    frequency = modes.frequency * np.exp(spread * rng.standard_normal(count))
    return PhysicalBody(body, modes, listed, frequency, _mixing(modes.frequency, rng))


def _mixing(frequency: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return a rotation of the elastic modes, neighbours being mixed most."""
    elastic = np.log(frequency[RIGID:])
    weight = 1 / (np.abs(elastic[:, None] - elastic) + _NEAR)
    draws = np.tril(weight * rng.standard_normal(weight.shape), -1)
    turn = draws - draws.T
    turn *= SHAPE_ERROR / np.mean(np.linalg.norm(turn, axis=0))
    rotation = np.asarray(scipy.linalg.expm(turn))
    return np.asarray(scipy.linalg.block_diag(np.eye(RIGID), rotation))
