# SPDX-License-Identifier: MIT
"""Curves of modes over amplitude from the hits that `gap` examines."""

from collections.abc import Callable, Sequence

import numpy as np

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.analysis.gap.diagnosis.amplitude_evidence import MeasuredCurves
from jointbench.analysis.gap.intake.session_campaign import QUANTITIES
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.signal.hits.find_hits import HitCriteria, accepted_hits
from jointbench.station.pipeline.chain import ChainSettings, run_chain

Progress = Callable[[str], None]


def curves_of_recordings(
    recordings: Sequence[Recording],
    reference: float | None,
    criteria: HitCriteria,
    progress: Progress,
) -> MeasuredCurves:
    """Return the modes over amplitude of recordings at one preload.

    Args:
        recordings: with their preloads.
        reference: preload that the model belongs to [N]; None where all are alike.
        criteria: of hits; none is weak.
        progress: receives one line.
    """
    preloads = [recording.preload for recording in recordings]
    wanted = preloads[0] if reference is None else reference
    kept = [r for r in recordings if r.preload is None or _alike(r.preload, wanted)]
    if not kept:
        return MeasuredCurves(reason=f"no hits at the reference preload, {wanted:g} N")
    progress("resolving the modes over amplitude")
    try:
        chain = run_chain(kept, ChainSettings(hits=criteria))
    except JointbenchError as error:
        return MeasuredCurves(reason=str(error))
    hits = sum(len(accepted_hits(recording)) for recording in chain.recordings)
    return MeasuredCurves(chain.amplitude, hits=hits)


def _alike(one: float, other: float | None) -> bool:
    return other is None or bool(np.isclose(one, other, rtol=1e-6))


def curves_of_campaign(
    campaign: Campaign, criteria: HitCriteria, progress: Progress
) -> MeasuredCurves:
    """Return the modes over amplitude of the hits of a campaign file."""
    if campaign.continuous:
        return MeasuredCurves(reason="the excitation never ends; hits are needed")
    model = campaign.model
    quantity = QUANTITIES[model.output]
    channels = tuple(
        Channel(channel.name, quantity, point=channel.body)
        for channel in model.channels
    )
    recordings = [
        Recording(
            f"hit {number + 1}",
            np.vstack([campaign.force[number][None], campaign.response[number]]),
            campaign.sample_rate,
            (
                Channel("force", Quantity.FORCE, point=model.bodies[body].name),
                *channels,
            ),
            preload=float(campaign.preload[number]),
        )
        for number, body in enumerate(campaign.hit)
    ]
    return curves_of_recordings(
        recordings, campaign.preload_reference, criteria, progress
    )
