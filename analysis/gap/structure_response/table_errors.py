# SPDX-License-Identifier: MIT
"""What an uncertain modal table of free bodies means for the closed structure.

The true modes of a body are mixtures of those of the table, its neighbours most: with
shapes mixed by e between modes of natural frequencies w_i and w_j, the stiffness of the
body in the modes of its table has an element e (w_i^2 - w_j^2) beside the diagonal, and
an error of a frequency one on it. Perturbation theory carries these elements over to
the modes of the closed structure (Fox and Kapoor, AIAA J. 6 (1968), eqs. 3 to 6).
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.structure_response.closed_modes import (
    RealModes,
    mass_damping_stiffness,
    real_modes,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_response.tuned_modes import TunedModes


def tuned_modes(campaign: HitCampaign, state: JointState) -> TunedModes | None:
    """Return the closed modes whose frequencies an uncertain table leaves open.

    Args:
        campaign: hits, modes and nominal parameters.
        state: nominal one.

    Returns:
        Those up to some way above the band; None if the table is exact.
    """
    if not any(campaign.nominal.table_sd):
        return None
    bodies = campaign.bodies
    modes = real_modes(bodies, state)
    highest = 2.0 * np.pi * campaign.hits.band * STRUCTURE.tuned_band
    near = modes.omega > STRUCTURE.rigid_share * highest
    near &= modes.omega < highest
    mass, _, _ = mass_damping_stiffness(bodies, state, 1.0)
    coupling = _coupling(campaign, bodies, modes)
    # Of second order: joints of rigid bodies have little of the first.
    apart = np.abs(modes.omega[:, None] ** 2 - modes.omega**2)
    beside = coupling / np.hypot(apart, np.sqrt(coupling) + 1.0)
    np.fill_diagonal(beside, 0.0)
    sd = np.hypot(np.sqrt(np.diag(coupling)), beside.sum(axis=1))
    sd /= 2.0 * np.where(near, modes.omega, 1.0) ** 2
    duration = campaign.hits.response.shape[2] / campaign.hits.sample_rate
    near &= sd * modes.omega * duration > STRUCTURE.least_phase
    rows = (mass @ modes.shapes[:, near]).T
    return TunedModes(rows, modes.omega[near], sd[near])


def mixing_of(
    campaign: HitCampaign, bodies: JointedBodies, modes: RealModes
) -> FloatArray:
    """Return the sd by which each closed mode is mixed into another one, (n, n).

    Modes so near to each other that errors of the table turn them are mixed by one at
    most.

    Args:
        campaign: with the uncertainty of the table.
        bodies: modes and rows.
        modes: closed ones.
    """
    coupling = np.sqrt(_coupling(campaign, bodies, modes))
    apart = np.abs(modes.omega[:, None] ** 2 - modes.omega**2)
    found = coupling / np.maximum(np.hypot(apart, coupling), STRUCTURE.least_direction)
    np.fill_diagonal(found, 0.0)
    return np.asarray(found)


def _coupling(
    campaign: HitCampaign, bodies: JointedBodies, modes: RealModes
) -> FloatArray:
    """Return the variance of the stiffness between closed modes [rad^4/s^4], (n, n)."""
    beside, diagonal = _stiffness_errors(campaign, bodies)
    x = modes.shapes
    found = (x**2).T @ (beside + np.diag(diagonal)) @ x**2
    for a in range(x.shape[1]):
        both = x[:, [a]] * x
        found[a] += np.sum(both * (beside @ both), axis=0)
    return np.asarray(np.maximum(found, 0.0))


def _stiffness_errors(
    campaign: HitCampaign, bodies: JointedBodies
) -> tuple[FloatArray, FloatArray]:
    """Return variances of the stiffness of the free bodies beside and on the diagonal.

    The shapes of rigid motions are exact.
    """
    frequency_sd, shape_sd = campaign.nominal.table_sd
    omega = bodies.omega
    elastic = omega > STRUCTURE.rigid_share * 2.0 * np.pi * campaign.hits.band
    safe = np.where(elastic, omega, 1.0)
    weight = np.minimum(safe[:, None], safe) / np.maximum(safe[:, None], safe)
    weight *= (bodies.body[:, None] == bodies.body) & elastic[:, None] & elastic
    np.fill_diagonal(weight, 0.0)
    size = np.mean(np.linalg.norm(weight[elastic], axis=1)) if elastic.any() else 1.0
    share = shape_sd * weight / max(float(size), STRUCTURE.least_direction)
    beside = (share * (omega[:, None] ** 2 - omega**2)) ** 2
    return beside, (2.0 * frequency_sd * omega**2) ** 2
