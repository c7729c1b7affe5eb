# SPDX-License-Identifier: MIT
"""How much a search has cost, so that it ends where nothing explains the records.

Counted in samples predicted, not in seconds: the same records give the same answer on
a fast machine and on a slow one.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from threading import Lock

import numpy as np

from jointbench.analysis.gap.response.response_settings import RESPONSE

STEP_EFFORT = RESPONSE.step_effort


class SearchExhausted(Exception):
    """A search has spent what it may."""


@dataclass(slots=True)
class Effort:
    """Samples predicted in a search.

    Attributes:
        spent: so far.
        limit: beyond which it ends.
    """

    spent: float = 0.0
    limit: float = np.inf


_ADDING = Lock()
_CURRENT: ContextVar[Effort | None] = ContextVar("effort", default=None)


@contextmanager
def counted() -> Iterator[Effort]:
    """Count what is predicted within, from nothing."""
    effort = Effort()
    token = _CURRENT.set(effort)
    try:
        yield effort
    finally:
        _CURRENT.reset(token)


@contextmanager
def limited(effort: Effort, limit: float) -> Iterator[None]:
    """End what is done within by `SearchExhausted` once so much has been spent."""
    effort.limit = limit
    try:
        yield
    finally:
        effort.limit = np.inf


def spend(samples: int, oversampling: int) -> None:
    """Count a prediction.

    Args:
        samples: of all channels.
        oversampling: steps of a nonlinear march per sample; 0 without one.

    Raises:
        SearchExhausted: the search has spent what it may.
    """
    effort = _CURRENT.get()
    if effort is None:
        return
    with _ADDING:
        effort.spent += samples * (1.0 + STEP_EFFORT * oversampling)
    if effort.spent > effort.limit:
        raise SearchExhausted
