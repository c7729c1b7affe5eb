# SPDX-License-Identifier: MIT
"""What a torque wrench makes of the preload of the simulated joint."""

BOLTS = 4
BOLT_DIAMETER = 0.016  # [m], M16
NUT_FACTOR = 0.2  # [-], dry steel


def bolt_preload(torque: float) -> float:
    """Return the preload of all bolts together [N] for the torque on each [N m].

    Source:
        Zhou et al. 2025: P = n T / (K d) with four M16 bolts.
    """
    return BOLTS * torque / (NUT_FACTOR * BOLT_DIAMETER)


def bolt_torque(preload: float) -> float:
    """Return the torque on each bolt [N m] that makes a preload [N] together."""
    return preload * NUT_FACTOR * BOLT_DIAMETER / BOLTS
