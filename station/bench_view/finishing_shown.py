# SPDX-License-Identifier: MIT
"""How far the file of a recording that has ended is finished, in its view."""

from dataclasses import dataclass

from jointbench.station.bench_view.live_view import LiveView
from jointbench.station.session_events.event_codec import Stamped
from jointbench.station.session_events.view_events import FileFinishing

_STEP = 0.01
"""Share after which it is shown again [-]."""
_NO_ENTRY = -1
"""Number of an event that is not in the log, which is closed by then."""


@dataclass(slots=True)
class FinishingShown:
    """Shows what share of a session file is written; called with it [-].

    Attributes:
        view: of the session.
    """

    view: LiveView
    _shown: float = -1.0

    def __call__(self, share: float) -> None:
        """Show a share, unless the last one shown is nearly the same."""
        if share < 1.0 and share - self._shown < _STEP:
            return
        self._shown = share
        event = FileFinishing(share)
        self.view.follow((Stamped(id=_NO_ENTRY, time=0.0, stored=0, event=event),))
