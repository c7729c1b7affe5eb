# SPDX-License-Identifier: MIT
"""The bell of the terminal: once for a good hit, twice for a rejected one."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from jointbench.acquisition.records.recordings import Verdict
from jointbench.station.session_events.hit_events import HitJudged
from jointbench.station.session_events.view_events import HitAveraged

_APART = 0.25  # [s]; closer rings are heard as one


@dataclass(slots=True)
class Bell:
    """Rings without waiting.

    Attributes:
        ring: rings once.
        now: clock [s].
    """

    ring: Callable[[], object]
    now: Callable[[], float] = time.monotonic
    _due: int = 0
    _last: float = float("-inf")

    def hit(self, hit: HitJudged, average: HitAveraged) -> None:
        """Plan the rings for a hit; a trial hit that is fit counts as good."""
        fit = Verdict.OPERATOR if average.trial else Verdict.OK
        self._due = 1 if hit.verdict == fit else 2

    def tick(self) -> None:
        """Ring if it is time to."""
        if self._due and self.now() - self._last >= _APART:
            self._due -= 1
            self._last = self.now()
            self.ring()
