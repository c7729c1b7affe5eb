# SPDX-License-Identifier: MIT
"""Preload of the simulated joint from the bolt torque."""

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
    """Return the torque on each bolt [N m] for a total preload [N]."""
    return preload * NUT_FACTOR * BOLT_DIAMETER / BOLTS
