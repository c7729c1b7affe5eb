# SPDX-License-Identifier: MIT
"""The numbers at the head of a session's report, each with its 95 % interval."""

from collections.abc import Sequence
from itertools import zip_longest

from jointbench.acquisition.records.recordings import Verdict
from jointbench.analysis.lumped.identified import JointParameter
from jointbench.station.pipeline.recordings_by_preload import at_words
from jointbench.station.report.findings.interval_words import (
    between,
    value_and_interval,
)
from jointbench.station.report.findings.session_findings import rejected_words
from jointbench.station.report.findings.surface_findings import surface_tiles
from jointbench.station.report.session_analysis import PreloadAnalysis, SessionAnalysis
from jointbench.station.screen.joint_text import interval_text
from jointbench.station.screen.page_parts import Tile

MODES_IN_TILE = 3


def session_tiles(analysis: SessionAnalysis, link: str) -> tuple[Tile, ...]:
    """Return numbers with intervals, the most important first.

    Args:
        analysis: of the session.
        link: whose stiffness is the joint's; empty without a model.
    """
    tiles = _joint_tiles(analysis, link)
    first, further = _mode_tiles(analysis.preloads)
    tiles += first
    if analysis.recordings:
        tiles.append(_hits_tile(analysis))
    return (*tiles, *surface_tiles(analysis.surfaces), *further)


def _joint_tiles(analysis: SessionAnalysis, link: str) -> list[Tile]:
    tiles = []
    if analysis.joint is not None:
        tiles.append(_joint_tile(analysis.joint.parameter(f"{link}.stiffness")))
    if analysis.contact is not None:
        at = analysis.contact.at
        value, interval = between(
            at.state.normal_stiffness, at.interval.lower, at.interval.upper, "N/m"
        )
        note = f"{interval}; {at.state.model}"
        tiles.append(Tile("joint stiffness, contact law", value, note))
    return tiles


def _joint_tile(stiffness: JointParameter) -> Tile:
    title = "joint stiffness, from modes"
    if not stiffness.identifiable:
        return Tile(title, f"{interval_text(stiffness.interval)} N/m", "not determined")
    low, high = stiffness.interval
    if low is None or high is None:
        value, note = value_and_interval(stiffness.value, stiffness.sd, stiffness.unit)
        return Tile(title, value, note)
    value, note = between(stiffness.value, low, high, stiffness.unit)
    return Tile(title, value, note)


def _hits_tile(analysis: SessionAnalysis) -> Tile:
    verdicts = [
        hit.verdict for recording in analysis.recordings for hit in recording.hits
    ]
    good = sum(verdict is Verdict.OK for verdict in verdicts)
    why = rejected_words(verdicts)
    note = f"rejected: {why}" if why else "none rejected"
    return Tile("hits accepted", f"{good} of {len(verdicts)}", note)


def _mode_tiles(preloads: Sequence[PreloadAnalysis]) -> tuple[list[Tile], list[Tile]]:
    """Return the first modes, those of every preload in turn, and what is left."""
    several = len(preloads) > 1
    by_state = [_tiles_of(one, several) for one in preloads]
    turns = [
        tile
        for row in zip_longest(*(tiles for tiles, _ in by_state))
        for tile in row
        if tile is not None
    ]
    kept = turns[:MODES_IN_TILE]
    return kept, [*turns[MODES_IN_TILE:], *(t for _, more in by_state for t in more)]


def _tiles_of(one: PreloadAnalysis, several: bool) -> tuple[list[Tile], list[Tile]]:
    model = one.modal.result.model
    at = at_words(one.preload) if several else ""
    tiles = []
    for number, frequency in enumerate(model.natural_frequency[:MODES_IN_TILE]):
        value, interval = value_and_interval(
            float(frequency), float(model.frequency_sd[number]), "Hz", prefix=False
        )
        damping, spread = value_and_interval(
            float(100 * model.damping_ratio[number]),
            float(100 * model.damping_ratio_sd[number]),
            "%",
            prefix=False,
        )
        words = [interval, f"damping {damping}" + (f" ({spread})" if spread else "")]
        note = "; ".join(word for word in words if word)
        tiles.append(Tile(f"mode {number + 1}{at}", value, note))
    count = model.natural_frequency.size
    more = str(count - MODES_IN_TILE)
    further = [Tile(f"further modes{at}", more, "see the table")]
    return tiles, further if count > MODES_IN_TILE else []
