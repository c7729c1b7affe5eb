# SPDX-License-Identifier: MIT
"""Mass, damping and stiffness of two bodies on bolts and feet, in modal coordinates."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.simulators.flexible.flexible_specimen import BoltedSpecimen, Vector
from jointbench.simulators.flexible.joint_values import BoltValues
from jointbench.simulators.flexible.physical_bodies import PhysicalBody

NORMAL = 2  # direction of the bolts
_ALMOST = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class FixedPart:
    """Something fixed to a body at a place.

    Attributes:
        rows: displacement of the place by each coordinate, shape (n, n_coordinates).
        mass: moving rigidly with each row [kg].
        stiffness: of a spring from each row to the ground [N/m].
    """

    rows: FloatArray
    mass: float = 0.0
    stiffness: float = 0.0

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "rows")


@dataclass(frozen=True, slots=True, eq=False)
class Oscillator:
    """A mass on a spring and a damper at a place, one coordinate more.

    Attributes:
        row: displacement of the place by each coordinate, shape (n_coordinates,).
        mass: [kg].
        frequency: on a fixed base [Hz].
        damping_ratio: on a fixed base [-].
    """

    row: FloatArray
    mass: float
    frequency: float
    damping_ratio: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "row")


@dataclass(frozen=True, slots=True, eq=False)
class Coordinates:
    """Rows of a specimen in the modes of its bodies, bottom body first.

    Attributes:
        bodies: as they are.
        bolts: top less bottom at each bolt, shape (n_bolts, 3, n_coordinates).
        feet: motion of each foot, shape (n_feet, 3, n_coordinates).
    """

    bodies: tuple[PhysicalBody, PhysicalBody]
    bolts: FloatArray
    feet: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "bolts", "feet")

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(body.frequency.size for body in self.bodies)

    def rows(self, body: int, place: Vector) -> FloatArray:
        """Return the displacement of a place, shape (3, n_coordinates)."""
        own = self.bodies[body].rows(place)
        rest = np.zeros((3, self.bodies[1 - body].frequency.size))
        return np.hstack((own, rest) if body == 0 else (rest, own))


def specimen_coordinates(
    specimen: BoltedSpecimen, bodies: tuple[PhysicalBody, PhysicalBody]
) -> Coordinates:
    """Return the rows of the bolts and feet of a specimen."""
    bolts = [
        np.hstack((-bodies[0].rows(bolt), bodies[1].rows(bolt)))
        for bolt in specimen.bolts
    ]
    rest = np.zeros((3, bodies[1].frequency.size))
    feet = [np.hstack((bodies[0].rows(foot), rest)) for foot in specimen.feet]
    return Coordinates(bodies, np.stack(bolts), np.stack(feet))


@dataclass(frozen=True, slots=True, eq=False)
class JointAtTorque:
    """Linear joint, feet and attachments at one torque.

    Attributes:
        values: stiffness and damping per bolt and direction, feet, modulus, damping.
        feet_factors: stiffness of each foot over the common one, shape (n_feet,).
        rocking: compliance added to the normal springs [m/N], shape (n_bolts, n_bolts).
        attachments: masses and springs to the ground.
        oscillators: hidden ones.
    """

    values: BoltValues
    feet_factors: FloatArray
    rocking: FloatArray | None = None
    attachments: tuple[FixedPart, ...] = ()
    oscillators: tuple[Oscillator, ...] = ()

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "feet_factors", "rocking")


@dataclass(frozen=True, slots=True, eq=False)
class ClosedStructure:
    """M a + C v + K q = force, in coordinates that rigid joints leave free.

    Attributes:
        mass: shape (n, n).
        damping: shape (n, n).
        stiffness: shape (n, n).
        lift: all coordinates from the free ones, shape (n_all, n).
    """

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    lift: FloatArray = field(repr=False)

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "mass", "damping", "stiffness", "lift")

    @property
    def natural_frequencies(self) -> FloatArray:
        """Undamped natural frequencies [Hz], ascending."""
        values = scipy.linalg.eigh(self.stiffness, self.mass, eigvals_only=True)
        return np.asarray(np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi))


def close_structure(place: Coordinates, state: JointAtTorque) -> ClosedStructure:
    """Assemble the bodies with their joint, feet and attachments.

    Args:
        place: rows of the specimen.
        state: of the joint at one torque.
    """
    values, count = state.values, place.size
    size = count + len(state.oscillators)
    mass = np.eye(size)
    stiffness, damping = np.zeros((size, size)), np.zeros((size, size))
    omega = 2 * np.pi * np.concatenate([b.frequency for b in place.bodies])
    owner = np.repeat([0, 1], [b.frequency.size for b in place.bodies])
    omega = omega * np.sqrt(values.modulus[owner])
    stiffness[:count, :count] = np.diag(omega**2)
    damping[:count, :count] = np.diag(2 * values.damping_ratio[owner] * omega)
    for rows, k, c in _couplings(place, state):
        stiffness[:count, :count] += rows.T @ k @ rows
        damping[:count, :count] += rows.T @ c @ rows
    for each in state.attachments:
        product = each.rows.T @ each.rows
        mass[:count, :count] += each.mass * product
        stiffness[:count, :count] += each.stiffness * product
    for index, own in enumerate(state.oscillators, start=count):
        row = np.zeros(size)
        row[:count], row[index] = own.row, -1.0
        mass[index, index] = own.mass
        turn = 2 * np.pi * own.frequency
        stiffness += own.mass * turn**2 * np.outer(row, row)
        damping += 2 * own.damping_ratio * own.mass * turn * np.outer(row, row)
    lift = _free_coordinates(place, values, size)
    mass, damping, stiffness = (lift.T @ x @ lift for x in (mass, damping, stiffness))
    return ClosedStructure(mass, damping, stiffness, lift)


def _couplings(
    place: Coordinates, state: JointAtTorque
) -> Sequence[tuple[FloatArray, FloatArray, FloatArray]]:
    """Return rows, stiffness and damping of the bolts by direction, and of feet."""
    values = state.values
    parts = []
    for direction in range(3):
        stiffness = values.stiffness[:, direction]
        if np.isinf(stiffness).all():
            continue
        k, c = np.diag(stiffness), np.diag(values.damping[:, direction])
        if direction == NORMAL and state.rocking is not None:
            softened = np.linalg.inv(np.diag(1 / stiffness) + state.rocking)
            k = np.asarray(softened, dtype=float)
            # The added compliance loses as much energy per cycle as the bolts do.
            c = float(np.mean(values.damping[:, NORMAL] / stiffness)) * k
        parts.append((place.bolts[:, direction], k, c))
    factors = np.repeat(state.feet_factors, 3)
    rows = place.feet.reshape(factors.size, -1)
    k = values.feet_stiffness * np.diag(factors)
    parts.append((rows, k, values.feet_damping * np.diag(np.minimum(factors, 1.0))))
    return parts


def _free_coordinates(place: Coordinates, values: BoltValues, size: int) -> FloatArray:
    """Return an orthonormal basis of the motions that rigid directions allow."""
    rigid = np.isinf(values.stiffness).all(axis=0)
    if not rigid.any():
        return np.eye(size)
    rows = place.bolts[:, rigid].reshape(-1, place.bolts.shape[-1])
    whole = np.zeros((rows.shape[0], size))
    whole[:, : rows.shape[1]] = rows
    return np.asarray(scipy.linalg.null_space(whole, rcond=_ALMOST))
