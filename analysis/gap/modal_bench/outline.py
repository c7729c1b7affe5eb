# SPDX-License-Identifier: MIT
"""Records at several levels as a campaign, for views that do not depend on the base."""

import numpy as np

from jointbench.analysis.gap.modal_bench.level_records import LevelRecord, RecordSet
from jointbench.analysis.gap.modal_bench.port_response import Shaken
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.lumped.lumped_model import (
    Body,
    Link,
    LumpedModel,
    ResponseChannel,
)


def outline(given: RecordSet, data: Shaken) -> Campaign:
    """Return forces, responses, levels, points and ports of transformed records.

    Masses and stiffnesses of the model are 1: no view uses them.

    Args:
        given: the set.
        data: its transformed records.
    """
    samples = data.measured.shape[2]
    force = np.zeros((len(data.records), samples))
    for row, record in zip(force, data.records, strict=True):
        own = record.force[_driving(record)]
        row[: own.size] = own
    return Campaign(
        name=given.name,
        sample_rate=given.sample_rate,
        force=force,
        response=data.measured,
        hit=np.array(
            [given.points.index(given.inputs[_driving(r)]) for r in data.records]
        ),
        level=np.array([r.rms for r in data.records]),
        preload=np.ones(len(data.records)),
        order=np.arange(len(data.records), dtype=float),
        preload_reference=1.0,
        model=LumpedModel(
            bodies=tuple(Body(point, 1.0, 0.0) for point in given.points),
            links=tuple(
                Link(port.name, port.between, 1.0, 1.0, None, None, joint=True)
                for port in given.ports
            ),
            channels=tuple(ResponseChannel(name, name) for name in given.sensors),
            output=given.output,
        ),
        lead=min(r.lead for r in data.records),
        continuous=True,
        repeatability=given.repeatability,
    )


def _driving(record: LevelRecord) -> int:
    """Return the index of the strongest force of a record."""
    return int(np.argmax(np.mean(record.force**2, axis=1)))
