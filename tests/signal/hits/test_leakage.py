# SPDX-License-Identifier: MIT
"""The part of a response cut off by a block, predicted from its end."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import NoHitFound
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.hits.leakage import estimate_leakage
from jointbench.signal.hits.windows import HammerWindow


@pytest.mark.parametrize("damping", [0.001, 0.002, 0.004])
def test_the_share_at_a_resonance_is_that_of_the_decay_beyond_the_block(
    hammered: Callable[..., Recording], structure: Callable[..., Any], damping: float
) -> None:
    """exp(-a T) / (1 - exp(-a T)) of one mode that rings on for T after the hit."""
    record = find_hits(hammered(structure((300.0,), (damping,))))
    hit = record.hits[0]
    left = np.exp(-2 * np.pi * 300.0 * damping * (hit.stop - hit.trigger) / 8192.0)
    found = estimate_leakage([record])
    assert found.worst_frequency == pytest.approx(300.0, abs=20.0)
    line = int(np.argmin(np.abs(found.frequency - 300.0)))
    assert found.share[line] == pytest.approx(left / (1.0 - left), rel=0.15)


def test_a_response_that_has_decayed_leaks_nothing(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Down to exp(-19), and to noise beneath it."""
    record = find_hits(hammered(structure((300.0,), (0.01,)), noise=0.001))
    assert estimate_leakage([record]).worst < 1e-3


def test_an_exponential_window_lessens_it(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """By its own decay over the block, exp(-3)."""
    record = find_hits(hammered(structure((300.0,), (0.001,)), first=20))
    plain = estimate_leakage([record]).worst
    windowed = estimate_leakage([record], HammerWindow(decay_rate=3.0)).worst
    assert windowed < 2.0 * np.exp(-3.0) * plain


def test_no_accepted_hit_is_refused() -> None:
    """Nothing to look at."""
    with pytest.raises(NoHitFound):
        estimate_leakage([])
