# SPDX-License-Identifier: MIT
"""Which records of a campaign a search fits before it fits all of them."""

import numpy as np

from jointbench.acquisition.basics.arrays import IntArray
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.hit_campaign import HitRecords


def one_of_each(hits: HitRecords) -> IntArray:
    """Return the first record of each combination of point, torque and level."""
    seen: dict[tuple[float, ...], int] = {}
    for k in range(len(hits.names)):
        key = (float(hits.point[k]), float(hits.torque[k]), float(hits.level[k]))
        seen.setdefault(key, k)
    return np.array(sorted(seen.values()), dtype=np.int64)


def torques_in_turn(hits: HitRecords) -> IntArray:
    """Return one record of each combination of point and level, torques in turn.

    Every torque meets every level and every point, in a third of the records where
    there are three torques.
    """
    torques, levels = np.unique(hits.torque), np.unique(hits.level)
    best: dict[tuple[int, int], tuple[int, int]] = {}
    for k in one_of_each(hits):
        point = int(hits.point[k])
        level = int(np.searchsorted(levels, hits.level[k]))
        torque = int(np.searchsorted(torques, hits.torque[k]))
        late = (torque - point - level) % torques.size
        own = late, int(k)
        best[point, level] = min(best.get((point, level), own), own)
    return np.array(sorted(k for _, k in best.values()), dtype=np.int64)


def records_of_base(bench: StructureBench) -> IntArray:
    """Return the records with which a base approaches all of them.

    Each hit of a point has the same error of an uncertain modal table, so torques take
    turns; beside an exact one, the base is judged by what every condition shows.

    Args:
        bench: all records.
    """
    hits = bench.campaign.hits
    return torques_in_turn(hits) if bench.uncertain else one_of_each(hits)


def hardest(hits: HitRecords, count: int) -> IntArray:
    """Return records of the highest levels of each point, torques in turn.

    Args:
        hits: of a campaign.
        count: levels of each point.
    """
    turn = torques_in_turn(hits)
    chosen: list[int] = []
    for point in np.unique(hits.point):
        own = turn[hits.point[turn] == point]
        levels = hits.level[own]
        chosen += [int(k) for k in own[np.argsort(-levels)[:count]]]
    return np.array(sorted(chosen), dtype=np.int64)
