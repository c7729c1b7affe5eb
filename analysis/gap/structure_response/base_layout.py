# SPDX-License-Identifier: MIT
"""Base coordinates of bolted bodies: their order, names and priors."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    DIRECTIONS,
    JointedBodies,
    NominalBench,
)
from jointbench.analysis.gap.structure_response.tuned_modes import TunedModes


class BaseName(StrEnum):
    """Names of coordinates that every structure has once."""

    TANGENTIAL_DAMPING = "bolt damping tangential"
    NORMAL_DAMPING = "bolt damping normal"
    FOOT = "foot stiffness"
    FOOT_DAMPING = "foot damping"


@dataclass(frozen=True, slots=True, eq=False)
class BaseLayout:
    """Order of the base coordinates: logs of values over their nominal ones.

    Couplings of closed modes, which are nominally none, are coordinates themselves.

    Attributes:
        names: of the coordinates.
        sd: of their priors [-], shape (n_base,).
        units: of the values.
        compliant: directions with a stiffness coordinate, in its order.
        contrasts: log factors of the bolts over the bolt coordinates,
            shape (n_bolts, n_bolts - 1).
        tuned: closed modes whose frequency has a coordinate; None if the modal table
            is exact.
    """

    names: tuple[str, ...]
    sd: FloatArray
    units: tuple[str, ...]
    compliant: tuple[int, ...]
    contrasts: FloatArray
    tuned: TunedModes | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "sd", "contrasts")

    def at(self, name: str) -> int:
        """Return the index of a coordinate."""
        return self.names.index(name)

    @property
    def couplings(self) -> slice:
        """Indices of the couplings of closed modes."""
        own = self.tuned_at
        alone = 0 if self.tuned is None else self.tuned.omega.size
        return slice(own.start + alone, own.stop)

    @property
    def tuned_at(self) -> slice:
        """Indices of the frequencies and couplings of closed modes."""
        if self.tuned is None:
            return slice(0, 0)
        first = self.at(self.tuned.names[0])
        return slice(first, first + len(self.tuned.names))

    def tuned_in(self, modes: TunedModes, sd: FloatArray) -> "BaseLayout":
        """Return the layout with other closed modes in the place of its own.

        Args:
            modes: the other ones.
            sd: of their coordinates, shape (n_tuned + n_pairs,).
        """
        own = self.tuned_at
        return replace(
            self,
            names=(*self.names[: own.start], *modes.names, *self.names[own.stop :]),
            sd=np.concatenate([self.sd[: own.start], sd, self.sd[own.stop :]]),
            units=(
                *self.units[: own.start],
                *("-" for _ in modes.names),
                *self.units[own.stop :],
            ),
            tuned=modes,
        )


def stiffness_name(direction: int) -> str:
    """Return the name of the stiffness coordinate of a direction."""
    return f"bolt stiffness {DIRECTIONS[direction]}"


def modulus_name(body: str) -> str:
    """Return the name of the modulus coordinate of a body."""
    return f"modulus {body}"


def loss_name(body: str) -> str:
    """Return the name of the damping coordinate of a body."""
    return f"damping ratio {body}"


def mass_name(body: str) -> str:
    """Return the name of the mass coordinate of a body."""
    return f"mass {body}"


def bolt_name(number: int) -> str:
    """Return the name of a coordinate of differences between bolts."""
    return f"bolt contrast {number}"


def base_layout(
    bodies: JointedBodies, nominal: NominalBench, tuned: TunedModes | None = None
) -> BaseLayout:
    """Return the base coordinates with their priors.

    The scatter from bolt to bolt enters as contrasts, orthogonal to the mean: a factor
    common to all bolts is a scale of their stiffness and damping. The
    mass of a body scales the squares of its shapes: the modal table knows them to the
    sd of the shapes, however well the body was weighed.

    Args:
        bodies: modes and rows.
        nominal: nominal parameters.
        tuned: closed modes whose frequency is a coordinate.
    """
    count = bodies.bolts.shape[0]
    compliant = tuple(d for d in range(3) if not bodies.rigid[d])
    common = float(np.hypot(nominal.stiffness_sd, nominal.bolt_sd / np.sqrt(count)))
    rows: list[tuple[str, float, str]] = []
    rows += [(modulus_name(b), nominal.modulus_sd, "-") for b in bodies.bodies]
    mass = float(np.hypot(nominal.mass_sd, nominal.table_sd[1]))
    rows += [(mass_name(b), mass, "-") for b in bodies.bodies]
    rows += [(loss_name(b), nominal.loss[1], "-") for b in bodies.bodies]
    rows += [(stiffness_name(d), common, "N/m") for d in compliant]
    rows.append((BaseName.TANGENTIAL_DAMPING, nominal.damping_sd, "N s/m"))
    rows.append((BaseName.NORMAL_DAMPING, nominal.damping_sd, "N s/m"))
    rows.append((BaseName.FOOT, nominal.foot_sd[0], "N/m"))
    rows.append((BaseName.FOOT_DAMPING, nominal.foot_sd[1], "N s/m"))
    if tuned is not None:
        sds = tuned.sd.tolist()
        rows += [(n, sd, "-") for n, sd in zip(tuned.names, sds, strict=True)]
    rows += [(bolt_name(k + 1), nominal.bolt_sd, "-") for k in range(count - 1)]
    names, sd, units = zip(*rows, strict=True)
    return BaseLayout(names, np.array(sd), units, compliant, _contrasts(count), tuned)


def _contrasts(count: int) -> FloatArray:
    """Return orthonormal contrasts (Helmert), shape (count, count - 1)."""
    columns = np.zeros((count, count - 1))
    for k in range(1, count):
        columns[:k, k - 1] = 1.0
        columns[k, k - 1] = -k
    return np.asarray(columns / np.linalg.norm(columns, axis=0))
