# SPDX-License-Identifier: MIT
"""Computing effort of a search, which limits a search without an explanation.

The effort is counted in predicted samples, not in seconds, so that the result does not
depend on the speed of the machine.
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
    """The effort limit of a search is reached."""


@dataclass(slots=True)
class Effort:
    """Samples predicted in a search.

    Attributes:
        spent: samples so far.
        limit: largest number of samples.
    """

    spent: float = 0.0
    limit: float = np.inf


_ADDING = Lock()
_CURRENT: ContextVar[Effort | None] = ContextVar("effort", default=None)


@contextmanager
def counted() -> Iterator[Effort]:
    """Count the samples predicted within the context, from zero."""
    effort = Effort()
    token = _CURRENT.set(effort)
    try:
        yield effort
    finally:
        _CURRENT.reset(token)


@contextmanager
def limited(effort: Effort, limit: float) -> Iterator[None]:
    """Raise `SearchExhausted` within the context once the limit is reached."""
    effort.limit = limit
    try:
        yield
    finally:
        effort.limit = np.inf


def spend(samples: int, oversampling: int) -> None:
    """Count a prediction.

    Args:
        samples: of all channels.
        oversampling: steps of the time integration per sample; 0 without one.

    Raises:
        SearchExhausted: the effort limit is reached.
    """
    effort = _CURRENT.get()
    if effort is None:
        return
    with _ADDING:
        effort.spent += samples * (1.0 + STEP_EFFORT * oversampling)
    if effort.spent > effort.limit:
        raise SearchExhausted
