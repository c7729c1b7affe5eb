"""A mode just above the band of a measured body."""

import numpy as np
import pytest

from jointbench.analysis.structures.measured.frf_coupling import FrfBlock
from jointbench.analysis.structures.measured.measured_frfs import fit_frfs

BAND = (40.0, 500.0)
SHAPES = np.array([[0.6, -0.5], [0.4, 0.7]])
RIGID = np.array([[0.5, 0.1], [0.1, 0.4]])


def block(last: float) -> FrfBlock:
    """Return FRFs of two points: rigid motions, a mode at 300 Hz and one at `last`."""
    frequency = np.arange(30.0, 500.0, 0.5)
    s = 2j * np.pi * frequency
    clean = RIGID[:, :, None] / s**2
    for shape, hertz in zip(SHAPES, (300.0, last), strict=True):
        omega = 2 * np.pi * hertz
        pole = 1.0 / (s**2 + 2 * 0.005 * omega * s + omega**2)
        clean = clean + np.outer(shape, shape)[:, :, None] * pole
    sd = 1e-3 * np.median(np.abs(clean))
    noise = np.random.default_rng(2).standard_normal((2, *clean.shape)) / np.sqrt(2)
    seen = clean + sd * (noise[0] + 1j * noise[1])
    return FrfBlock("body", frequency, seen, np.full(clean.shape, sd**2))


def test_a_mode_above_the_band_is_found_from_below() -> None:
    """At 2 % above the end, within three standard deviations."""
    found = fit_frfs(block(510.0), BAND)
    assert found.frequency == pytest.approx([300.0, 510.0], rel=1e-3)
    assert abs(found.frequency[1] - 510.0) < 3.0 * found.frequency_sd[1]
    shape = found.table().shapes[1]
    assert np.abs(shape) == pytest.approx(np.abs(SHAPES[1]), rel=0.02)


def test_a_mode_far_above_stays_in_the_series() -> None:
    """Three times the band: powers of s^2 describe it."""
    assert fit_frfs(block(1500.0), BAND).frequency == pytest.approx([300.0], rel=1e-3)
