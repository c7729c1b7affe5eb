# SPDX-License-Identifier: MIT
"""What a session amounts to while it runs: hits, gaps, proposals, checks."""

from dataclasses import dataclass, field

from jointbench.acquisition.ni.stream import StreamGap
from jointbench.acquisition.records.recordings import Hit
from jointbench.station.measure.bench_checks import Check
from jointbench.station.measure.trial_settings import Proposal


@dataclass(slots=True)
class Record:
    """What the session amounts to so far.

    Attributes:
        hits: all of them, with their latest verdict.
        gaps: what was missing.
        proposals: of the trial hits.
        checks: driving points and reciprocity.
        incomplete: names of the conditions that were given up.
        finished: numbers of the conditions that are over.
        interrupted: whether the operator ended it.
    """

    hits: list[Hit] = field(default_factory=list)
    gaps: list[StreamGap] = field(default_factory=list)
    proposals: tuple[Proposal, ...] = ()
    checks: list[Check] = field(default_factory=list)
    incomplete: list[str] = field(default_factory=list)
    finished: set[int] = field(default_factory=set)
    interrupted: bool = False

    @property
    def done(self) -> int:
        """Number of conditions that are over."""
        return len(self.finished)
