"""Offset and mains hum: subtracted from the quiet start on, and what is left known."""

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.intake.mains_hum import mains_hum
from jointbench.analysis.gap.structure_bench.whitening import hum_whitening

RATE, QUIET, SAMPLES, NOISE = 25_600.0, 500, 8192, 0.02


def records(seed: int, mains: float) -> FloatArray:
    """Return noise of 40 rows with offset, hum and its third harmonic."""
    rng = np.random.default_rng(seed)
    t, start = np.arange(SAMPLES) / RATE, rng.uniform(0, 6.3, (40, 1))
    turn = 2 * np.pi * mains * t + start
    hum = 1.5 * np.sin(turn) + 0.45 * np.sin(3 * turn)
    noise = rng.standard_normal((40, SAMPLES))
    return np.asarray(0.3 + NOISE * (hum + noise))


@pytest.mark.parametrize("mains", [49.92, 50.1, 60.05])
def test_what_is_left_of_hum_is_as_large_as_stated(mains: float) -> None:
    """Whitened by it, the decimated noise is white over the whole record."""
    values = records(3, mains)
    hum = mains_hum(values[:, :QUIET], RATE)
    assert abs(hum.frequency - mains) < 0.2
    kept = np.arange(QUIET, SAMPLES, 4)
    gain = 0.5  # of the noise, by the mean of four samples
    left = hum.subtracted(values)[:, QUIET:].reshape(40, 1, -1, 4).mean(axis=3)
    white = hum_whitening(hum.left(kept + 1.5) / gain, np.ones((40, 1)))
    scaled = left / (NOISE * gain)
    late = slice(-400, None)
    assert np.mean(scaled[..., late] ** 2) > 1.05
    white(scaled)
    assert np.mean(scaled[..., late] ** 2) == pytest.approx(1.0, abs=0.04)


def test_without_hum_little_is_taken() -> None:
    """A channel whose noise is far below sigma keeps its record."""
    rng = np.random.default_rng(1)
    values = NOISE * rng.standard_normal((40, SAMPLES))
    hum = mains_hum(values[:, :QUIET], RATE)
    assert hum.amplitude < 0.3
    rows = np.sin(np.arange(500) / 7.0) * np.ones((40, 1, 1))
    left = hum.left(np.arange(500.0))
    white = rows.copy()
    hum_whitening(left, np.full((40, 1), 1e-3))(white)
    assert np.allclose(white, rows, atol=1e-6)


def test_a_trace_that_never_moves_shows_no_hum() -> None:
    """A lost cable or a full converter beside good records, and nothing else."""
    starts = records(3, 50.0)[:, :QUIET]
    stuck = np.full((3, QUIET), -(2.0**31))
    hum = mains_hum(np.concatenate([starts, stuck]), RATE)
    assert hum.amplitude == mains_hum(starts, RATE).amplitude
    assert np.isfinite(mains_hum(stuck, RATE).left(np.arange(9.0))).all()
