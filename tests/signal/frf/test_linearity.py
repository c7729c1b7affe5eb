# SPDX-License-Identifier: MIT
"""The FRF against the level of the hits."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Quantity
from jointbench.signal.frf.linearity import check_linearity
from jointbench.signal.hits.hit_spectra import HitSpectra

LINE = np.arange(0.0, 1000.0, 2.0)


def spectra(
    structure: Callable[..., Any],
    *,
    shift: float,
    levels: tuple[float, ...] = (1.0, 2.0, 1.4, 2.8, 1.0, 2.0),
    seed: int = 0,
    noise: float = 0.02,
) -> HitSpectra:
    """Hit a mode at 300 Hz that shifts by a share for each doubling of the level."""
    rng = np.random.default_rng(seed)
    rows = []
    for level in levels:
        moved = 300.0 * (1.0 + shift * np.log2(level))
        clean = level * structure((moved,), (0.02,)).response(LINE, 2)[0, 0]
        parts = rng.normal(size=(2, LINE.size))
        rows.append(clean + noise * (parts[0] + 1j * parts[1]))
    return HitSpectra(
        frequency=LINE,
        force=np.array(levels)[:, None] * np.ones(LINE.size, complex),
        response=np.array(rows)[:, None],
        labels=(("a1@1",),) * len(levels),
        points=("1",) * len(levels),
        quantity=Quantity.ACCELERATION,
        block=998,
        block_reason="as made",
    )


def test_a_linear_structure_raises_no_alarm(structure: Callable[..., Any]) -> None:
    """Forty measurements: alarms at 1 % in 4 at most (5 or more have chance 5e-5)."""
    alarms = [
        check_linearity(spectra(structure, shift=0.0, seed=s)).nonlinear
        for s in range(40)
    ]
    assert sum(alarms) <= 4


def test_a_frequency_that_falls_with_level_is_found_and_measured(
    structure: Callable[..., Any],
) -> None:
    """1e-3 a doubling: the share is that of the change of the exact FRF, 10 %."""
    found = check_linearity(spectra(structure, shift=-1e-3))
    one, two = (
        structure((300.0 * (1.0 + s),), (0.02,)).response(LINE, 2)[0, 0]
        for s in (0.0, -1e-3)
    )
    inside = np.isin(LINE, found.frequency)
    exact = np.linalg.norm((two - one)[inside]) / np.linalg.norm(one[inside])
    assert found.nonlinear
    assert found.significance < 1e-6
    assert found.change_per_doubling == pytest.approx(exact, rel=0.1)
    assert "not linear" in found.words
    near = np.abs(found.frequency - 300.0) < 10.0
    beyond = (found.frequency > 400.0) & (found.frequency < 700.0)
    assert found.change[near].mean() > 3.0 * found.change[beyond].mean()


def test_the_sentence_gives_levels_and_chance(structure: Callable[..., Any]) -> None:
    """For the report."""
    words = check_linearity(spectra(structure, shift=0.0)).words
    assert "from 1 to 2.8 N s (6 hits)" in words
    assert "% of cases" in words


@pytest.mark.parametrize("levels", [(1.0, 2.0), (1.0, 1.01, 1.02, 1.0)])
def test_too_few_hits_or_one_level_are_refused(
    structure: Callable[..., Any], levels: tuple[float, ...]
) -> None:
    """Two hits, or all on one level."""
    with pytest.raises(BadData, match="soft and hard"):
        check_linearity(spectra(structure, shift=0.0, levels=levels))
