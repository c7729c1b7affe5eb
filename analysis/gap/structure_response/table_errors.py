# SPDX-License-Identifier: MIT
"""What an uncertain modal table of free bodies means for the closed structure.

The true modes of a body are mixtures of those of the table, its neighbours most: with
shapes mixed by e between modes of natural frequencies w_i and w_j, the stiffness of the
body in the modes of its table has an element e (w_i^2 - w_j^2) beside the diagonal, and
an error of a frequency one on it. Perturbation theory carries these elements over to
the modes of the closed structure (Fox and Kapoor, AIAA J. 6 (1968), eqs. 3 to 6).
"""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray
from jointbench.analysis.gap.structure_response.closed_modes import (
    RealModes,
    mass_damping_stiffness,
    real_modes,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies
from jointbench.analysis.gap.structure_response.modal_table_settings import MODAL_TABLE
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
    modes = real_modes(campaign.bodies, state)
    coupling = _coupling(campaign, campaign.bodies, modes)
    shifted = _shifted(campaign, modes, _frequency_sd(coupling, modes))
    near = np.flatnonzero(shifted & (modes.omega < _highest(campaign)))
    count = max(_close_pairs(coupling, modes, near), MODAL_TABLE.least_pairs)
    mass, _, _ = mass_damping_stiffness(campaign.bodies, state, 1.0)
    return _tuned(mass, coupling, modes, near, count)


def tuned_again(
    campaign: HitCampaign,
    state: JointState,
    like: TunedModes,
    *,
    every_pair: bool = False,
) -> tuple[TunedModes, FloatArray] | None:
    """Return as many of these modes, the lowest, at a state that is tuned already.

    Where a joint is so soft that errors of the table shift fewer, others follow.

    Args:
        campaign: hits, modes and nominal parameters.
        state: with tuned modes of another state.
        like: these.
        every_pair: whether all pairs that are close at the state have a coupling;
            otherwise as many as these have, those that mix most.

    Returns:
        The modes without what tunes the state, and the coordinates by which it is;
        None if nothing tunes it, or there are not as many.
    """
    count = like.omega.size
    bare, bodies = replace(state, tuned=None), state.bodies_of(campaign.bodies)
    modes = real_modes(bodies, bare)
    if state.tuned is None or modes.omega.size < count:
        return None
    coupling = _coupling(campaign, bodies, modes)
    unshifted = ~_shifted(campaign, modes, _frequency_sd(coupling, modes))
    found = np.sort(np.argsort(unshifted, kind="stable")[:count])
    mass, _, _ = mass_damping_stiffness(bodies, bare, 1.0)
    pairs = len(like.pairs)
    if every_pair:
        pairs = max(pairs, _close_pairs(coupling, modes, found))
    tuned = _tuned(mass, coupling, modes, found, pairs)
    across = state.tuned.rows @ modes.shapes[:, found]
    return tuned, tuned.coordinates_of(across.T @ state.tuned.stiffness @ across)


def _close_pairs(coupling: FloatArray, modes: RealModes, chosen: IntArray) -> int:
    """Return how many pairs of some modes are so close that they have a coupling."""
    mixing = np.triu(_mixing(coupling, modes)[np.ix_(chosen, chosen)])
    return int(np.sum(mixing > MODAL_TABLE.close_mixing))


def _highest(campaign: HitCampaign) -> float:
    """Return the angular frequency up to which closed modes are tuned [rad/s]."""
    return 2.0 * np.pi * campaign.hits.highest


def _shifted(campaign: HitCampaign, modes: RealModes, sd: FloatArray) -> BoolArray:
    """Return which modes errors of the table shift during a record, shape (n,)."""
    elastic = modes.omega > STRUCTURE.rigid_share * _highest(campaign)
    duration = campaign.hits.response.shape[2] / campaign.hits.sample_rate
    return np.asarray(elastic & (sd * modes.omega * duration > MODAL_TABLE.least_phase))


def _tuned(
    mass: FloatArray,
    coupling: FloatArray,
    modes: RealModes,
    chosen: IntArray,
    pairs: int,
) -> TunedModes:
    """Return some of the modes, those couplings that mix them most with a coordinate.

    Args:
        mass: of the free modes, shape (n_modes, n_modes).
        coupling: variance of the stiffness between closed modes, shape (n, n).
        modes: closed ones.
        chosen: some of them, shape (n_tuned,).
        pairs: number of couplings.
    """
    omega, both = modes.omega[chosen], np.ix_(chosen, chosen)
    first, second = np.triu_indices(chosen.size, 1)
    mixing = _mixing(coupling, modes)[both][first, second]
    most = np.sort(np.argsort(-mixing)[:pairs])
    first, second = first[most], second[most]
    between = np.sqrt(coupling[both][first, second])
    between /= 2.0 * omega[first] * omega[second]
    alone = _frequency_sd(coupling, modes)[chosen]
    sd = np.maximum(np.concatenate([alone, between]), MODAL_TABLE.least_tuning)
    rows = (mass @ modes.shapes[:, chosen]).T
    return TunedModes(rows, omega, np.stack([first, second], axis=1), sd)


def _frequency_sd(coupling: FloatArray, modes: RealModes) -> FloatArray:
    """Return the sd of the logarithms of closed frequencies, shape (n,)."""
    # Of second order: joints of rigid bodies have little of the first.
    apart = np.abs(modes.omega[:, None] ** 2 - modes.omega**2)
    beside = coupling / np.hypot(apart, np.sqrt(coupling) + 1.0)
    np.fill_diagonal(beside, 0.0)
    sd = np.hypot(np.sqrt(np.diag(coupling)), beside.sum(axis=1))
    return np.asarray(sd / (2.0 * np.maximum(modes.omega, 1.0) ** 2))


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
    return _mixing(_coupling(campaign, bodies, modes), modes)


def _mixing(coupling: FloatArray, modes: RealModes) -> FloatArray:
    """Return it from the variance of the stiffness between the modes."""
    root = np.sqrt(coupling)
    apart = np.abs(modes.omega[:, None] ** 2 - modes.omega**2)
    found = root / np.maximum(np.hypot(apart, root), STRUCTURE.least_direction)
    np.fill_diagonal(found, 0.0)
    return np.asarray(found)


def _coupling(
    campaign: HitCampaign, bodies: JointedBodies, modes: RealModes
) -> FloatArray:
    """Return the variance of the stiffness between closed modes [rad^4/s^4], (n, n)."""
    beside, diagonal = stiffness_errors(campaign, bodies)
    x = modes.shapes
    found = (x**2).T @ (beside + np.diag(diagonal)) @ x**2
    for a in range(x.shape[1]):
        both = x[:, [a]] * x
        found[a] += np.sum(both * (beside @ both), axis=0)
    return np.asarray(np.maximum(found, 0.0))


def stiffness_errors(
    campaign: HitCampaign, bodies: JointedBodies
) -> tuple[FloatArray, FloatArray]:
    """Return variances of the stiffness of the free bodies beside and on the diagonal.

    The shapes of rigid motions are exact.

    Args:
        campaign: with the uncertainty of the table.
        bodies: modes.

    Returns:
        Beside it [rad^4/s^4], shape (n_modes, n_modes), and on it, shape (n_modes,).
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
