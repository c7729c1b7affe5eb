# SPDX-License-Identifier: MIT
"""Filtered hits on bolted bodies, and the hits that were left out."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.gap.residuals.fit_records import Blocks
from jointbench.analysis.gap.structure_response.common_filter import CommonFilter
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    JointedBodies,
    NominalBench,
)


@dataclass(frozen=True, slots=True, eq=False)
class RejectedHit:
    """A record that is left out, and why."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class HitRecords:
    """Filtered hits on a bolted structure.

    Force and responses have passed the same filter, so the model relates one to the
    other without knowing it.

    Attributes:
        names: of the records.
        sample_rate: of force and response [Hz].
        force: [N], shape (n_records, n_samples).
        response: accelerations [m/s^2], shape (n_records, n_channels, n_samples).
        noise: sd of the sensor noise [m/s^2], shape (n_records, n_channels).
        point: index of the hit point, shape (n_records,).
        torque: of the bolts [N m], shape (n_records,).
        level: aimed peak force [N], shape (n_records,).
        lead: samples before the force begins.
        band: highest frequency with force [Hz].
        raw_force: unfiltered force [N] from the first sample on, (n_records, n_raw).
        filter: that both have passed.
        rejected: hits left out.
        clamped_by: quantity and unit of `torque`: that of the bolts, or a preload [N].
        hum_left: what may be left of offset and mains hum in a record, in directions of
            unit sd over the noise of the channel, shape (n_directions, n_samples).
    """

    names: tuple[str, ...]
    sample_rate: float
    force: FloatArray
    response: FloatArray
    noise: FloatArray
    point: IntArray
    torque: FloatArray
    level: FloatArray
    lead: int
    band: float
    raw_force: FloatArray
    filter: CommonFilter
    rejected: tuple[RejectedHit, ...] = ()
    clamped_by: Literal["torque", "preload"] = "torque"
    hum_left: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def highest(self) -> float:
        """Frequency from which there is neither force nor response [Hz]."""
        return min(self.filter.stop, 0.5 * self.sample_rate)

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "force", "response", "noise", "point", "torque", "level")
        freeze(self, "raw_force", "hum_left")

    @property
    def of_points(self) -> tuple[IntArray, ...]:
        """Records of each point that was hit."""
        return tuple(np.flatnonzero(self.point == one) for one in np.unique(self.point))

    def chosen(self, records: IntArray) -> "HitRecords":
        """Return some of the records.

        Args:
            records: which, shape (n,).
        """
        names = ("force", "response", "noise", "point", "torque", "level", "raw_force")
        return replace(
            self,
            names=tuple(self.names[k] for k in records),
            **{name: getattr(self, name)[records] for name in names},
        )


@dataclass(frozen=True, slots=True, eq=False)
class HitCampaign:
    """Hits on a bolted structure, with its model and nominal parameters.

    Attributes:
        name: of the campaign.
        bodies: modes and rows.
        nominal: nominal parameters.
        hits: filtered records.
        remarks: what a reader should know of the file, a line each.
    """

    name: str
    bodies: JointedBodies
    nominal: NominalBench
    hits: HitRecords
    remarks: tuple[str, ...] = ()


def record_blocks(campaign: HitCampaign) -> Blocks:
    """Return the records of a campaign as groups of rows."""
    hits = campaign.hits
    shape = hits.response.shape
    unit = "N m" if hits.clamped_by == "torque" else "N"
    labels = tuple(
        {
            "level": f"{level:g} N",
            "hit point": campaign.bodies.points[point].name,
            hits.clamped_by: f"{torque:g} {unit}",
            "order": f"{k}",
        }
        for k, (level, point, torque) in enumerate(
            zip(hits.level, hits.point, hits.torque, strict=True)
        )
    )
    group = np.repeat(np.arange(shape[0]), shape[1] * shape[2])
    return Blocks(group, labels, int(hits.response.size), shape, white=False)
