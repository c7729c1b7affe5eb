# SPDX-License-Identifier: MIT
"""Weights of the samples of a campaign: noise, force noise, scatter of hits.

The scatter is no noise of samples: each hit has one factor on its force and one on the
stiffness of its joint, so it blurs only a few known directions of each record. Neither
is the noise of the force: what it adds rings on like the response to the hit, in the
few modes of the specimen, and hides there far more than its power suggests.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.simulators.hidden.campaign_design import CampaignDesign
from jointbench.simulators.hidden.campaign_response import sketch_responses
from jointbench.simulators.hidden.campaign_sampling import FORCE_NOISE, SAMPLE_RATE
from jointbench.simulators.measuring.hammer import Pulse


@dataclass(frozen=True, slots=True, eq=False)
class SampleWeights:
    """Whitening of changes of the responses.

    Attributes:
        inverse: 1/sigma of every sample, shape (n_records, 2, n).
        blurred: orthonormal directions of each record, weighted, that scatter and
            force noise blur, shape (n_records, 2 n, n_directions).
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
    *,
    samples: int | None = None,
) -> SampleWeights:
    """Weigh the samples of a design.

    Args:
        design: its noise and scatter.
        responses: of the base [m/s^2], shape (n_records, 2, n).
        joint_slope: their derivative to the logarithm of kj, same shape.
        joint_curve: their second derivative to it, same shape.
        samples: of a record that count, from its start; None for all.

    Returns:
        Weights; without scatter only the force noise blurs directions.

    Source:
        The covariance of a record in units of its noise is I + B B^T, B the blurred
        directions times the scatter; its inverse square root leaves 1/sqrt(1 + s^2)
        along each left singular vector of B (singular value s). To second order in
        a Gaussian x, x^2/2 scatters by 1/sqrt(2), uncorrelated with x.
    """
    inverse = np.full_like(responses, 1 / design.noise)
    if samples is not None:
        inverse[..., samples:] = 0.0
    count = len(design.conditions)
    forced = FORCE_NOISE * design.noise * _impulses(design)
    directions = (inverse[..., None] * forced).reshape(count, responses[0].size, -1)
    if design.hit_scatter > 0:
        bend = design.hit_scatter / np.sqrt(2) * joint_curve
        blur = design.hit_scatter * np.stack((responses, joint_slope, bend), axis=-1)
        settled = (inverse[..., None] * blur).reshape(count, -1, 3)
        directions = np.concatenate([directions, settled], axis=-1)
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


def _impulses(design: CampaignDesign) -> FloatArray:
    """Return the responses to one newton in each sample of the hits.

    Shape (n_records, 2, n, n_samples). The force counts during the hit: outside it is
    known to be zero. Both the impulse and the sample are short against every period.
    """
    step = 1.0 / SAMPLE_RATE
    samples = int(np.ceil(max(c.pulse.width for c in design.conditions) / step))
    found: dict[int, FloatArray] = {}
    for condition in design.conditions:
        if condition.hit_dof not in found:
            start = np.floor(condition.pulse.start / step) * step
            # The area of a half sine is 2 / pi of its peak times its width.
            short = Pulse(start, step, peak=np.pi / 2, exponent=1.0)
            plain = replace(
                condition,
                pulse=short,
                force_factor=1.0,
                joint_factor=1.0,
                channel_gain=(1.0, 1.0),
                force_delay=0.0,
            )
            (one,) = sketch_responses(replace(design, conditions=(plain,)))
            found[condition.hit_dof] = _delayed(one, samples)
    return np.stack([found[c.hit_dof] for c in design.conditions])


def _delayed(response: FloatArray, count: int) -> FloatArray:
    """Return a response delayed by 0 to count - 1 samples, along a last axis."""
    late = np.zeros((*response.shape, count))
    for k in range(count):
        late[:, k:, k] = response[:, : response.shape[1] - k]
    return late
