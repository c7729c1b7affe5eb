# SPDX-License-Identifier: MIT
"""Nonlinear forces at the ports of any linear model that is given by its modes.

A port is a scalar relative motion at which a force law may act: the opening of a joint,
the slip of a bolt in one direction, the motion of a foot. The linear model is given by
its poles, with a row of inputs and a row of shapes at the ports, and by its motion at
the ports without the laws; where these come from (lumped bodies, meshed parts, measured
modes) is of no importance here.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.response.effect_hooks import Law
from jointbench.analysis.gap.response.force_integration import (
    VERSIONS,
    LaneModes,
    integrate_forces,
)
from jointbench.analysis.gap.response.law_forces import LANES, MOVING
from jointbench.analysis.gap.response.packed_laws import pack_laws


@dataclass(frozen=True, slots=True)
class PortLaw:
    """A force law at a port.

    Attributes:
        port: index of the port.
        law: its force resists a positive motion of the port.
    """

    port: int
    law: Law


@dataclass(frozen=True, slots=True, eq=False)
class PortModes:
    """Modes of a linear model between its ports.

    After an impulse of 1 N s of a law at port q the motion of port p is minus the real
    part of the sum over the modes of shapes[:, p] inputs[:, q] exp(poles t).

    Attributes:
        poles: [rad/s], one of each conjugate pair, shape (n_modes, n_records).
        inputs: [1/(N s)], doubled for a pair, shape (n_modes, n_ports, n_records).
        shapes: [m], same shape.
    """

    poles: ComplexArray
    inputs: ComplexArray
    shapes: ComplexArray

    def __post_init__(self) -> None:
        """Check the shapes and make the arrays read-only."""
        modes, records = self.poles.shape
        require_shape("inputs", self.inputs, (modes, None, records))
        require_shape("shapes", self.shapes, self.inputs.shape)
        freeze(self, "poles", "inputs", "shapes")

    def scaled(self) -> LaneModes:
        """Return the modes with inputs and shapes of 1 at their largest port.

        With one port these are exactly 1, and the gains are the residues.
        """
        shape, shapes = _scaled(self.shapes)
        drive, inputs = _scaled(self.inputs)
        return LaneModes(self.poles, shape * drive, inputs, shapes)


def _scaled(rows: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the largest entry over the ports, and the rows over it."""
    if rows.shape[1] == 1:  # the usual case, without a search over ports
        return rows[:, 0].copy(), np.ones_like(rows)
    at = np.argmax(np.abs(rows), axis=1)[:, None]
    largest = np.take_along_axis(rows, at, axis=1)
    over = np.divide(rows, largest, out=np.zeros_like(rows), where=largest != 0)
    np.put_along_axis(over, at, 1.0, axis=1)
    return largest[:, 0].copy(), over


def need_velocity(laws: Sequence[PortLaw]) -> bool:
    """Return whether a law depends on the speed of its port."""
    return any(one.law.kind in MOVING for one in laws)


def port_forces(
    motions: FloatArray,
    modes: PortModes,
    dt: float,
    laws: Sequence[PortLaw],
    *,
    extrapolated: bool,
    band_limited: bool = True,
) -> tuple[FloatArray, FloatArray | None]:
    """Integrate the forces of all laws at all ports along their coupled motion.

    The error of the time integration is proportional to the square of its step, so a
    solution with half as many steps gives an extrapolation to zero step.

    Args:
        motions: of the ports from rest without the laws: displacement [m] and, if a law
            needs it, speed [m/s], shape (1 or 2, n_ports, n_steps, n_columns): a column
            for each record, and zero columns up to a multiple of `LANES` (see
            `filled_lanes`).
        modes: between the ports.
        dt: step [s].
        laws: at least one for each port.
        extrapolated: True for a solution of half as many steps as well.
        band_limited: True for samples of the band-limited force, which differ from the
            force itself where it jumps or bends within a step.

    Returns:
        Force of each port [N], shape (n_ports, n_steps, n_columns), and that at every
        second step; None where there is none.

    Raises:
        UsageError: a law is at a port that the modes do not have, or needs a speed.
    """
    count = modes.inputs.shape[1]
    if motions.shape[1] != count or any(not 0 <= x.port < count for x in laws):
        raise UsageError(
            f"motions of {motions.shape[1]} ports and laws at ports "
            f"{sorted({x.port for x in laws})} of modes with {count} ports; "
            "give one motion per port, and laws at these ports"
        )
    moving = need_velocity(laws)
    if moving and len(motions) < 2:
        raise UsageError("a law depends on the speed; give the speeds of the ports")
    packed = pack_laws(
        [x.law for x in laws], [x.port for x in laws], band_limited=band_limited
    )
    scaled = modes.scaled()
    version = VERSIONS[count > 1]

    def integrated(every: int) -> FloatArray:
        rows = np.ascontiguousarray(motions[:, :, ::every])
        return np.asarray(
            integrate_forces(
                rows[0], rows[-1], scaled, dt * every, packed, moving, version
            )
        )

    return integrated(1), integrated(2) if extrapolated else None


def filled_lanes(records: int) -> int:
    """Return the number of columns for a number of records."""
    return -(-records // LANES) * LANES
