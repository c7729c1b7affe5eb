# SPDX-License-Identifier: MIT
"""Balance of dry friction at several ports within one step of the time integration.

Dry friction is stiff: within a step its force changes the speed of its own port, and
that of every other port, by much more than the speed over which it changes sign. The
forces at the end of a step are therefore solved for together.
"""

import math

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.response.law_forces import (
    COULOMB,
    EXTRAPOLATED,
    LANES,
    LAW,
    OWN,
    PORT,
    SLOPE,
    SPEED,
    rub,
)
from jointbench.analysis.gap.response.response_settings import RESPONSE

_SWEEPS = RESPONSE.friction_sweeps
_TOLERANCE = RESPONSE.friction_tolerance


@compiled()
def balance_friction(
    w: FloatArray,
    f: FloatArray,
    kinds: IntArray,
    ports: IntArray,
    p: FloatArray,
    coupled: int,
    n_ports: int,
) -> None:
    """Solve for the forces of all laws of dry friction, in every lane.

    The change of all speeds per unit force is a symmetric positive matrix for any
    reciprocal structure, and each force grows with its speed, so that solving for one
    force after the other converges.

    Args:
        w: state of the lanes, with the speeds predicted with extrapolated forces.
        f: forces of the lanes, solved for each law alone; changed in place.
        kinds: of all laws.
        ports: of all laws.
        p: parameters of all laws.
        coupled: offset of the changes of speed in `w`.
        n_ports: number of ports.
    """
    for k in range(LANES):
        for _ in range(_SWEEPS):
            change = 0.0
            for a in range(kinds.size):
                if kinds[a] != COULOMB:
                    continue
                at, limit, width = ports[a] * PORT, p[a, 0], p[a, 1]
                v = w[at + SPEED + k]
                for b in range(kinds.size):
                    if b != a and kinds[b] == COULOMB:
                        across = (ports[a] * n_ports + ports[b]) * LANES
                        away = f[b * LAW + OWN + k] - f[b * LAW + EXTRAPOLATED + k]
                        v -= w[coupled + across + k] * away
                guess, before = f[a * LAW + EXTRAPOLATED + k], f[a * LAW + OWN + k]
                force = rub(limit, width, v, w[at + SLOPE + k], guess, before)
                f[a * LAW + OWN + k] = force
                change = max(change, math.fabs(force - before) / (abs(limit) + 1e-300))
            if change < _TOLERANCE:
                break
