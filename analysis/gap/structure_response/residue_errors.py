# SPDX-License-Identifier: MIT
"""Errors of responses where the modal table of the bodies is uncertain.

Errors of shapes and frequencies are errors of the stiffness of the free bodies, in
their modes. To first order they change the frequency of each closed mode, its damping
and its residue between a point and a channel. Frequencies are base coordinates (see
`tuned_modes`); the rest are errors here, the same in all hits of a point: what differs
between such hits, and a response that is no sum of the modes, is not due to the table.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.analysis.gap.structure_response.closed_modes import (
    RealModes,
    real_modes,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.hit_frames import HitFrame
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_response.table_errors import mixing_of


@dataclass(frozen=True, slots=True, eq=False)
class ResidueErrors:
    """Errors of closed modes between points and channels.

    Attributes:
        lines: accelerations per force of unit errors, shape (n_errors, n_lines).
        frame: transforms of the window.
        records: those of the frame, shape (n_records,).
        sd: of these errors, shape (n_points, n_channels, n_errors).
    """

    lines: ComplexArray
    frame: HitFrame
    records: IntArray
    sd: FloatArray

    def rows(self, own: IntArray) -> FloatArray:
        """Return responses of unit error, shape (n_own, n_errors, n_samples).

        They are computed where they are used: those of all records are as large as the
        records times the errors, and each fit at rest has its own.

        Args:
            own: records.
        """
        forces = self.frame.force[self.records[own]]
        return np.stack([self.frame.records(self.lines * one) for one in forces])

    def chosen(self, records: IntArray) -> "ResidueErrors":
        """Return the errors of some records."""
        return replace(self, records=self.records[records])


def residue_errors(
    campaign: HitCampaign, state: JointState, frame: HitFrame
) -> ResidueErrors:
    """Return the errors of responses that errors of the modal table make.

    In phase, each mode has the error of its residue; in quadrature only where it mixes
    with a mode near to it. What the joints give it of damping goes with the squares of
    the shapes. Modes above the band have the error of their static part.

    Args:
        campaign: hits, modes and nominal parameters.
        state: of the model.
        frame: transforms of the window.
    """
    bodies = state.bodies_of(campaign.bodies)
    modes = real_modes(bodies, state)
    channels = state.sensors_of(bodies) @ modes.shapes
    points = np.stack([p.direction @ p.rows for p in state.points_of(bodies)])
    points = points @ modes.shapes
    near = modes.omega < 2.0 * np.pi * campaign.hits.highest
    shape_sd = campaign.nominal.table_sd[1]
    mixing = mixing_of(campaign, bodies, modes)
    residue = points[:, None] * channels
    error = np.sqrt(
        _mixed(channels, points, mixing)
        + (shape_sd * _typical(channels[:, near]) * np.abs(points)[:, None]) ** 2
        + (shape_sd * _typical(points[:, near])[:, None] * np.abs(channels)) ** 2
    )
    across = np.sqrt(_mixed(channels, points, mixing * _turns(modes)))
    damped = _damping_errors(modes, mixing, shape_sd) * np.abs(residue)
    static = np.sqrt(np.sum((error / modes.omega**2)[..., ~near] ** 2, axis=-1))
    sd = np.concatenate(
        [error[..., near], across[..., near], damped[..., near], static[..., None]], -1
    )
    records = np.arange(len(frame.force))
    return ResidueErrors(_lines(modes, near, frame.s), frame, records, sd)


def _turns(modes: RealModes) -> FloatArray:
    """Return by which share mixing turns the phase of a mode, shape (n, n).

    A stiffness between two modes divides by the difference of their dynamic stiffnesses
    where one of them resonates, which is real unless their damping differs or they are
    as near to each other as they are wide.
    """
    omega, rate = modes.omega, modes.ratios * modes.omega
    across = 2.0 * omega[:, None] * np.abs(rate[:, None] - rate)
    apart = np.abs(omega[:, None] ** 2 - omega**2)
    return np.asarray(across / np.maximum(np.hypot(across, apart), 1e-300))


def _damping_errors(
    modes: RealModes, mixing: FloatArray, shape_sd: float
) -> FloatArray:
    """Return the sd of damping ratios, shape (n,).

    Joints damp with the squares of the shapes, and modes that mix share their damping.
    """
    own = 2.0 * shape_sd * modes.ratios
    shared = mixing * np.abs(modes.damping) / modes.omega[:, None]
    turned = mixing**2 * np.abs(modes.ratios[:, None] - modes.ratios)
    return np.asarray(np.sqrt(own**2 + np.sum(shared**2 + turned**2, axis=1)))


def typical_peaks(campaign: HitCampaign, peak: FloatArray) -> FloatArray:
    """Return the peaks of records, those of channels across the motion raised.

    Where a channel hardly moves, the errors of its response are those of a mode that
    moves it as modes do on average.

    Args:
        campaign: hits and modes.
        peak: of each record and channel [m/s^2], shape (n_records, n_channels).
    """
    bodies = campaign.bodies
    elastic = bodies.omega > STRUCTURE.rigid_share * 2.0 * np.pi * campaign.hits.band
    motion = np.sqrt(np.mean(bodies.sensors[:, elastic] ** 2, axis=1))
    moving = np.maximum(motion, STRUCTURE.least_direction)
    typical = np.sqrt(np.mean((peak / moving) ** 2, axis=1))[:, None] * moving
    return np.asarray(np.maximum(peak, typical))


def separable(campaign: HitCampaign, sigma: FloatArray) -> FloatArray:
    """Return sd as products of one of the record and one of the channel, by point.

    Args:
        campaign: hits.
        sigma: of each record and channel, shape (n_records, n_channels).
    """
    found = np.log(sigma)
    for own in campaign.hits.of_points:
        one = found[own]
        of_channel = one.mean(axis=0) - one.mean()
        found[own] = one.mean(axis=1)[:, None] + of_channel
    return np.asarray(np.exp(found))


def _mixed(channels: FloatArray, points: FloatArray, mixing: FloatArray) -> FloatArray:
    """Return the variance of residues by mixed modes, (n_points, n_channels, n)."""
    found = np.empty((len(points), len(channels), channels.shape[1]))
    square = mixing**2
    for p, point in enumerate(points):
        for c, channel in enumerate(channels):
            pairs = np.outer(point, channel)
            found[p, c] = np.sum(square * (pairs + pairs.T) ** 2, axis=1)
    return found


def _typical(motion: FloatArray) -> FloatArray:
    """Return the motion of a typical mode at each place, shape (n_places, 1)."""
    return np.asarray(np.sqrt(np.mean(motion**2, axis=1)))[:, None]


def _lines(modes: RealModes, near: BoolArray, s: ComplexArray) -> ComplexArray:
    """Return accelerations per force of unit errors, shape (n_errors, n_lines)."""
    omega, damping = modes.omega[near, None], modes.ratios[near, None]
    one = s**2 / (s**2 + 2.0 * damping * omega * s + omega**2)
    return np.concatenate(
        [one, one * s / omega, one**2 * 2.0 * omega / s, (s**2)[None]]
    )
