# SPDX-License-Identifier: MIT
"""Peaks above the band are reported, with a band that includes them."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from jointbench.signal.frf.beyond_band import Beyond, look_beyond
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.hits.hit_spectra import hit_spectra
from jointbench.signal.hits.windows import choose_window
from jointbench.signal.modal.modes import ModalSettings, identify_modes

Make = Callable[..., Any]


@pytest.fixture
def beyond(structure: Make, hammered: Make) -> Callable[..., Beyond]:
    """Return what is beyond a band, modes at 300 and 2000 Hz, pulse of 1 ms."""

    def make(band: tuple[float, float] | None, noise: float = 1e-5) -> Beyond:
        truth = structure((300.0, 2000.0), (0.01, 0.005))
        record = find_hits(
            hammered(truth, width=1e-3, peaks=(90.0, 100.0, 80.0), noise=noise)
        )
        frf = estimate_frf(record)
        fitted = band or identify_modes(frf, ModalSettings(highest_order=30)).band
        force = hit_spectra([record], choose_window(record)).force
        return look_beyond(frf, fitted, np.mean(np.abs(force) ** 2, axis=0))

    return make


def test_a_peak_above_the_default_band_is_reported_with_its_band(
    beyond: Callable[..., Beyond],
) -> None:
    """Accelerance of the mode at 2000 Hz is far above that at 300 Hz."""
    found = beyond(None)
    assert found.end < 1500.0
    assert found.force_drop == pytest.approx(-20.0, abs=2.0)
    assert found.peaks[-1].frequency == pytest.approx(2000.0, abs=2.0)
    assert found.peaks[-1].height > 1.0
    assert f"--band {found.begin:.3g}:2200" in found.words()
    fallen = f"where the recorded force spectrum has fallen by {-found.force_drop:.0f}"
    assert f"{fallen} dB; above it peaks stand out" in found.words()


def test_the_reported_band_finds_the_mode(structure: Make, hammered: Make) -> None:
    """Asked for up to 2100 Hz, the mode at 2000 Hz is there."""
    truth = structure((300.0, 2000.0), (0.01, 0.005))
    record = find_hits(hammered(truth, width=1e-3, peaks=(90.0, 100.0), noise=1e-5))
    settings = ModalSettings(band=(10.0, 2100.0), highest_order=30)
    found = identify_modes(estimate_frf(record), settings).model.natural_frequency
    assert np.min(np.abs(found - 2000.0)) < 2.0


def test_noise_above_the_band_is_no_peak(beyond: Callable[..., Beyond]) -> None:
    """Above 2200 Hz there is no mode."""
    found = beyond((10.0, 2200.0), noise=1e-4)
    assert found.peaks == ()
    assert "no peak stands out up to 3200 Hz" in found.words()


def test_a_band_up_to_the_filters_leaves_nothing_to_tell(
    beyond: Callable[..., Beyond],
) -> None:
    """8192 Hz / 2.56 = 3200 Hz."""
    assert beyond((10.0, 3300.0)).words() == ""
