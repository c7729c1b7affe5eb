# SPDX-License-Identifier: MIT
"""Pairs of output and input, and where reciprocity completes them."""

import numpy as np
import pytest
from hammered_structures import Bench, Measured, Strike, prescribed, strike

from jointbench.acquisition.basics.errors import ChannelMissing
from jointbench.signal.frf.frf import estimate_frf

FREQUENCY = np.array([60.0, 140.0, 260.0])


def measured(*strikes: Strike) -> tuple[Measured, np.ndarray]:
    """Return hits on three modes of 2 %, and exact residues between all points."""
    rng = np.random.default_rng(8)
    structure = prescribed(FREQUENCY, np.full(3, 0.02), 5, rng)
    pole, moved, drive = structure.poles()
    bench = Bench(hits=2, decibel=80.0, aim=0.0)
    s = 2j * np.pi * 60.0
    exact = sum(
        np.outer(m, d) / (s - p) + np.outer(m, d).conj() / (s - p.conjugate())
        for p, m, d in zip(pole, moved, drive, strict=True)
    )
    return strike(structure, strikes, bench, rng), exact * s**2


def test_points_hit_and_points_measured_make_one_column() -> None:
    """Points 1 and 2 hit, 3 and 4 measured, 0 both: column 0 of all five."""
    hit = [Strike(point, (0,), ("a1",)) for point in (0, 1, 2)]
    moved = [Strike(0, (point,), ("a1",)) for point in (3, 4)]
    found, exact = measured(*hit, *moved)
    frf = estimate_frf(found.recordings)
    assert frf.outputs == ("a1@0", "a1@3", "a1@4", "a1@1", "a1@2")
    assert frf.inputs == ("0",)
    line = int(np.argmin(np.abs(frf.frequency - 60.0)))
    s = 2j * np.pi * frf.frequency[line]
    assert abs(s) == pytest.approx(2.0 * np.pi * 60.0, rel=2e-3)
    level = np.abs(frf.response[:, 0, line])
    assert level == pytest.approx(np.abs(exact[[0, 3, 4, 1, 2], 0]), rel=0.05)


def test_what_was_measured_directly_is_never_replaced() -> None:
    """Point 1 hit and measured: the row of point 1 is the direct one."""
    direct = Strike(0, (1,), ("a1",))
    hit = [Strike(point, (0,), ("a1",)) for point in (0, 1, 2)]
    found, _ = measured(direct, *hit)
    frf = estimate_frf(found.recordings)
    alone = estimate_frf(found.recordings[:2])
    row = frf.outputs.index("a1@1")
    assert np.array_equal(frf.response[row], alone.response[0])


def test_pairs_measured_in_no_way_are_refused() -> None:
    """Points 1 and 2 hit with the sensor at 0, 3 and 4 measured from 1 alone."""
    hit = [Strike(point, (0,), ("a1",)) for point in (0, 2)]
    moved = [Strike(1, (point,), ("a1",)) for point in (3, 4)]
    found, _ = measured(*hit, *moved)
    with pytest.raises(ChannelMissing, match="nor the other way round"):
        estimate_frf(found.recordings)
