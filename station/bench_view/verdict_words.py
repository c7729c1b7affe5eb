# SPDX-License-Identifier: MIT
"""Verdicts in the words of the operator."""

from jointbench.acquisition.records.recordings import Verdict
from jointbench.station.session_events.hit_events import HitJudged


def verdict_word(hit: HitJudged, *, trial: bool) -> str:
    """Return what became of a hit."""
    if trial and hit.verdict == Verdict.OPERATOR:
        return "trial"
    return hit.verdict.replace("_", " ")
