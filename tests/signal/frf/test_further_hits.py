"""Forecasts of what further hits buy, against the scatter of repeated averages."""

import numpy as np
import pytest

from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.frf.further_hits import further_hits

FREQUENCY = np.arange(20.0, 500.0, 1.0)
MODES = ((120.0, 0.02, 1.0), (310.0, 0.012, -0.6))
NOISE = 2e-3


def average(hits: int, rng: np.random.Generator) -> Frf:
    """Return the average of hits on two modes, its noise known."""
    s = 2j * np.pi * FREQUENCY
    response = np.zeros((2, 1, FREQUENCY.size), complex)
    for number, (frequency, damping, size) in enumerate(MODES):
        omega = 2 * np.pi * frequency
        mode = size * s**2 / (s**2 + 2 * damping * omega * s + omega**2)
        response[:, 0] += np.array([[1.0], [0.5 - number]]) * mode
    shape, sd = response.shape, NOISE * np.abs(response).max() / np.sqrt(hits)
    noise = rng.normal(0, sd / np.sqrt(2), (2, *shape))
    return Frf(
        frequency=FREQUENCY,
        response=response + noise[0] + 1j * noise[1],
        kind=FrfKind.ACCELERANCE,
        coherence=np.ones(shape),
        variance=np.full(shape, sd**2),
        added_decay_rate=0.0,
        outputs=("a", "b"),
        inputs=("1",),
        averages=hits,
    )


def test_the_forecast_is_the_scatter_of_repeated_averages() -> None:
    """Two hundred averages of three hits, then of five: within 20 %."""
    rng = np.random.default_rng(5)
    found = [further_hits(average(3, rng)) for _ in range(200)]
    later = [further_hits(average(5, rng)) for _ in range(200)]
    assert {len(each) for each in found} == {2}
    for mode, (frequency, damping, _) in enumerate(MODES):
        peaks = [each[mode] for each in found]
        after = [each[mode] for each in later]
        assert np.mean([p.frequency for p in peaks]) == pytest.approx(frequency, 2e-3)
        assert np.mean([p.damping for p in peaks]) == pytest.approx(damping, rel=0.05)
        scatter = np.std([p.frequency for p in peaks])
        assert peaks[0].frequency_sd == pytest.approx(scatter, rel=0.2)
        scatter = np.std([p.damping for p in peaks]) / damping
        assert peaks[0].damping_sd == pytest.approx(scatter, rel=0.2)
        scatter = np.std([p.frequency for p in after])
        assert peaks[0].frequency_sd_after == pytest.approx(scatter, rel=0.2)


def test_without_a_variance_or_a_peak_there_is_no_forecast() -> None:
    """One hit has no variance, and noise no resonance."""
    rng = np.random.default_rng(1)
    one = average(1, rng)
    assert further_hits(one) == ()
    values = rng.normal(size=one.response.shape) + 1j * rng.normal(
        size=one.response.shape
    )
    flat = average(3, rng)
    noise = Frf(
        frequency=FREQUENCY,
        response=values,
        kind=FrfKind.ACCELERANCE,
        variance=flat.variance,
        averages=3,
        outputs=("a", "b"),
        inputs=("1",),
    )
    assert further_hits(noise) == ()
