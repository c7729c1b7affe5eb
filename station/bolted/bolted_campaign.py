# SPDX-License-Identifier: MIT
"""Sessions of a bolted structure with its model file, ready for a diagnosis."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Recording
from jointbench.analysis.gap.intake.filter_hits import filter_hits
from jointbench.analysis.gap.intake.read_hit_campaign import read_raw_hits
from jointbench.analysis.gap.structure_response.hit_campaign import (
    HitCampaign,
    HitRecords,
)
from jointbench.station.bolted.free_bodies import (
    BoltedModel,
    bolted_model,
    gap_table,
)
from jointbench.station.bolted.nominal_values import nominal_bench
from jointbench.station.bolted.recorded_hits import recorded_hits
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.gap_table import StructureGapTable
from jointbench.station.joints.structure_model import StructureModel


@dataclass(frozen=True, slots=True, eq=False)
class BoltedCampaign:
    """Hits on a bolted structure, and the file that describes it.

    Attributes:
        table: content of the model file.
        model: its bodies in modal form.
        campaign: records, model and nominal parameters.
    """

    table: StructureModel
    model: BoltedModel
    campaign: HitCampaign


def bolted_campaign(
    title: str, recordings: Sequence[Recording], path: Path
) -> BoltedCampaign:
    """Prepare the hits of sessions for a diagnosis with a structure model.

    Args:
        title: of the campaign.
        recordings: with judged hits.
        path: model file with [joints] and [gap].

    Raises:
        UsageError: the model lacks a table that is needed.
        BadData: model, matrices or hits cannot be used as they are.
    """
    table = read_toml(path, StructureModel)
    gap = gap_table(table)
    hits = recorded_hits(recordings, list(table.sensors), list(table.hits), gap.band)
    return _with_model(title, table, hits, path)


def bolted_hits(hits: Path, path: Path) -> BoltedCampaign:
    """Prepare the raw hits of a ``campaign/1`` file with a structure model.

    Args:
        hits: file of the campaign; its modal tables are not used.
        path: model file with [joints] and [gap].

    Raises:
        UsageError: the model lacks a table that is needed.
        BadData: model, matrices or hits cannot be used as they are.
    """
    table = read_toml(path, StructureModel)
    gap = gap_table(table)
    raw, rows = read_raw_hits(hits, list(table.hits))
    missing = [row.name for row in rows[1:] if row.name not in table.sensors]
    if missing:
        raise BadData(
            f"{hits} has a channel {missing[0]!r}, the model has "
            f"{', '.join(table.sensors)}; add it to [sensors]"
        )
    sensors = {row.name: table.sensors[row.name] for row in rows[1:]}
    ordered = table.model_copy(update={"sensors": sensors})
    return _with_model(hits.stem, ordered, filter_hits(raw, gap.band), path)


def _with_model(
    title: str, table: StructureModel, hits: HitRecords, path: Path
) -> BoltedCampaign:
    gap = gap_table(table)
    model = bolted_model(table, path.parent)
    nominal = nominal_bench(gap, model.areas, _reference(gap, hits))
    return BoltedCampaign(table, model, HitCampaign(title, model.bodies, nominal, hits))


def _reference(gap: StructureGapTable, hits: HitRecords) -> float:
    """Return the preload [N] or torque [N m] that the values of the bolts belong to."""
    values = np.unique(hits.torque)
    if hits.clamped_by == "torque":
        return float(np.median(values))
    if gap.preload_reference is not None:
        return gap.preload_reference
    if values.size > 1:
        shown = ", ".join(f"{value:g}" for value in values)
        raise BadData(
            f"the hits have the preloads {shown} N; add preload_reference, to which "
            "the values of [gap.bolt] belong, to the model's [gap] table"
        )
    return float(values[0])
