# SPDX-License-Identifier: MIT
"""Force-deflection loops of a law, and its equivalent stiffness and damping.

The law is evaluated by the compiled integration itself, along a motion that it cannot
change, so that a loop shows the law that was fitted and not a second version of it.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.response.effect_hooks import Law
from jointbench.analysis.gap.response.port_forces import (
    PortLaw,
    PortModes,
    filled_lanes,
    port_forces,
)
from jointbench.analysis.gap.response.response_settings import RESPONSE


@dataclass(frozen=True, slots=True, eq=False)
class Loops:
    """A law under harmonic motion of several amplitudes.

    Attributes:
        motion: over one cycle, from the largest [m], shape (n_amplitudes, n_points).
        force: of the law [N], same shape.
        stiffness: equivalent [N/m], shape (n_amplitudes,).
        damping: equivalent [N s/m], same shape.
    """

    motion: FloatArray
    force: FloatArray
    stiffness: FloatArray
    damping: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "motion", "force", "stiffness", "damping")


def force_along(
    law: Law, motion: FloatArray, speed: FloatArray | None = None
) -> FloatArray:
    """Return the force of a law along given motions from rest [N], shape of `motion`.

    Args:
        law: any.
        motion: [m], shape (n_steps,) or (n_steps, n_columns).
        speed: [m/s], same shape; None where the law does not need it.
    """
    given = [motion] if speed is None else [motion, speed]
    rows = np.stack([x.reshape(x.shape[0], -1) for x in given])[:, None]
    records = rows.shape[-1]
    padded = np.zeros((*rows.shape[:-1], filled_lanes(records)))
    padded[..., :records] = rows
    # A mode that no force drives: the motion stays as given.
    rigid = PortModes(
        np.full((1, records), -1.0 + 0.0j),
        np.zeros((1, 1, records), dtype=np.complex128),
        np.zeros((1, 1, records), dtype=np.complex128),
    )
    force, _ = port_forces(
        padded,
        rigid,
        1.0,
        [PortLaw(0, law)],
        extrapolated=False,
        band_limited=False,
    )
    return np.asarray(force[0, :, :records].reshape(motion.shape))


def harmonic_loops(law: Law, amplitude: FloatArray, omega: float) -> Loops:
    """Return a law under harmonic motion, with its first harmonic.

    Args:
        law: any.
        amplitude: of the motion [m], shape (n_amplitudes,).
        omega: angular frequency [rad/s].

    Returns:
        The second cycle: the first one leads from rest into the loop.

    Source:
        Krylov and Bogoliubov 1947, Introduction to Non-Linear Mechanics: equivalent
        linearisation by the first harmonic.
    """
    points = RESPONSE.loop_points
    turn = 2.0 * np.pi * np.arange(-points, points + 1) / points
    start = np.linspace(0.0, 1.0, points // 2, endpoint=False)
    shape = np.concatenate([start, np.cos(turn)])
    rate = np.concatenate([np.full(start.size, 2 / np.pi), -np.sin(turn)])
    force = force_along(
        law, shape[:, None] * amplitude, rate[:, None] * (omega * amplitude)
    )[-points - 1 :]
    angle, cycle = turn[-points - 1 : -1], force[:-1].T
    real = 2.0 * (cycle @ np.cos(angle)) / points
    imaginary = 2.0 * (cycle @ np.sin(angle)) / points
    return Loops(
        motion=np.outer(amplitude, shape[-points - 1 :]),
        force=force.T,
        stiffness=real / amplitude,
        damping=-imaginary / (omega * amplitude),
    )
