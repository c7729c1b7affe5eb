# SPDX-License-Identifier: MIT
"""Weights of the samples of a campaign: noise, force noise, scatter of hits.

The scatter is no noise of samples: each hit has one factor on its force and one on the
    stiffness of its joint, so it blurs only a few known directions of each record.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.simulators.hidden.campaign_design import CampaignDesign
from jointbench.simulators.hidden.campaign_sampling import FORCE_NOISE, SAMPLE_RATE


@dataclass(frozen=True, slots=True, eq=False)
class SampleWeights:
    """Whitening of changes of the responses.

    Attributes:
        inverse: 1/sigma of every sample, shape (n_records, 2, n).
        blurred: orthonormal directions of each record, weighted, that the scatter
            blurs, shape (n_records, 2 n, n_directions).
        kept: remaining share of a change in each [-], (n_records, n_directions).
    """

    inverse: FloatArray
    blurred: FloatArray
    kept: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "inverse", "blurred", "kept")


def sample_weights(
    design: CampaignDesign,
    responses: FloatArray,
    joint_slope: FloatArray,
    joint_curve: FloatArray,
) -> SampleWeights:
    """Weigh the samples of a design.

    Args:
        design: its noise and scatter.
        responses: of the base [m/s^2], shape (n_records, 2, n).
        joint_slope: their derivative to the logarithm of kj, same shape.
        joint_curve: their second derivative to it, same shape.

    Returns:
        Weights; without scatter no direction is blurred.

    Source:
        The covariance of a record in units of its noise is I + B B^T, B the blurred
        directions times the scatter; its inverse square root leaves 1/sqrt(1 + s^2)
        along each left singular vector of B (singular value s). To second order in
        a Gaussian x, x^2/2 scatters by 1/sqrt(2), uncorrelated with x.
    """
    gain = FORCE_NOISE**2 * _force_gain(design, responses)
    inverse = 1 / (design.noise * np.sqrt(1 + gain))
    count = len(design.conditions)
    directions = np.zeros((count, responses[0].size, 0))
    if design.hit_scatter > 0:
        bend = design.hit_scatter / np.sqrt(2) * joint_curve
        blur = design.hit_scatter * np.stack((responses, joint_slope, bend), axis=-1)
        directions = (inverse[..., None] * blur).reshape(count, -1, 3)
    further = _further(design, responses)
    if further.shape[-1]:
        more = (inverse[..., None] * further).reshape(count, responses[0].size, -1)
        directions = np.concatenate([directions, more], axis=-1)
    blurred, size, _ = np.linalg.svd(directions, full_matrices=False)
    return SampleWeights(inverse, np.asarray(blurred), 1 / np.sqrt(1 + size**2))


def _further(design: CampaignDesign, responses: FloatArray) -> FloatArray:
    """Return one sd of gains and delay, shape (n_records, 2, n, n_directions)."""
    ways, found = design.ways, []
    if ways.channel > 0.0:
        for channel in range(responses.shape[1]):
            alone = np.zeros_like(responses)
            alone[:, channel] = ways.channel * responses[:, channel]
            found.append(alone)
    if ways.delay > 0.0:
        found.append(ways.delay * SAMPLE_RATE * np.gradient(responses, axis=2))
    if not found:
        return np.zeros((*responses.shape, 0))
    return np.stack(found, axis=-1)


def weigh(weights: SampleWeights, change: FloatArray) -> FloatArray:
    """Whiten a change of the responses.

    Args:
        weights: of the samples.
        change: [m/s^2], shape (n_records, 2, n).

    Returns:
        The change in standard deviations [-], shape (n_records * 2 n,).
    """
    white = (weights.inverse * change).reshape(change.shape[0], -1, 1)
    along = weights.blurred.transpose(0, 2, 1) @ white
    lost = (1 - weights.kept)[..., None] * along
    return np.asarray(white - weights.blurred @ lost, dtype=float).ravel()


def windowed(weights: SampleWeights, window: FloatArray) -> SampleWeights:
    """Return weights times a window of the samples, shape (n,), scatter ignored."""
    inverse = weights.inverse * window
    count = inverse.shape[0]
    return SampleWeights(
        inverse, np.zeros((count, inverse[0].size, 0)), np.zeros((count, 0))
    )


def _force_gain(design: CampaignDesign, base: FloatArray) -> FloatArray:
    """Return the summed squares of the responses to unit samples of the force.

    Noise counts during the hit; outside the force is zero. A hit is short: its response
    over the sum of its samples approximates that to one sample.
    """
    gain = np.empty_like(base)
    for i, condition in enumerate(design.conditions):
        pulse = condition.pulse
        samples = SAMPLE_RATE * pulse.width
        # The mean of a half sine raised to 1.6 is 0.55 of its peak.
        gain[i] = samples * (base[i] / (0.55 * samples * pulse.peak)) ** 2
    return gain
