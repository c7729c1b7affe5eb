"""Sums over hits, one at a time: the same FRF, and the memory of one hit."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import uniform_filter1d

from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.frf.estimators import estimate_pair
from jointbench.signal.frf.excited_band import excited_band
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.frf.linearity import check_linearity, linearity_of_sums
from jointbench.signal.frf.pair_sums import PairSums, force_update
from jointbench.signal.frf.spectral_sums import sum_hits
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.hits.hit_spectra import (
    HitSpectra,
    hit_forces,
    hit_spectra,
    plan_spectra,
)
from jointbench.signal.hits.windows import choose_window
from jointbench.signal.kalman.smoothing import observe_noise, smooth_recording

RATE, SAMPLES = 4096.0, 8192
CHANNELS = (
    Channel("force", Quantity.FORCE, point="1"),
    Channel("a1", Quantity.ACCELERATION, point="1"),
    Channel("a2", Quantity.ACCELERATION, point="2"),
)


def recording(number: int, noise: float = 1e-3) -> Recording:
    """Return one hit on two modes."""
    rng = np.random.default_rng(number)
    time = np.arange(SAMPLES - 100) / RATE
    modes = np.exp(np.outer([-8 + 400j, -12 + 2500j], time)).imag
    samples = noise * rng.standard_normal((3, SAMPLES))
    level = 1.0 + 0.5 * rng.random()
    samples[0, 100:108] += 100.0 * level * np.hanning(10)[1:-1]
    samples[1:, 100:] += level * np.array([[1.0, 0.5], [0.7, -0.9]]) @ modes
    return Recording(f"r{number}", samples, RATE, CHANNELS)


def test_sums_hit_by_hit_are_those_of_all_hits_at_once():
    """H1, powers and a residual ten orders below the response agree."""
    rng = np.random.default_rng(1)
    shape = (6, 50)
    force = rng.standard_normal(shape) + 1j * rng.standard_normal(shape)
    small = 1e-5 * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))
    response = (2.0 - 1.0j) * force + small
    sums = PairSums.empty(np.zeros(50))
    for one, other in zip(force, response, strict=True):
        sums.add(force_update(one, sums.force_power), other)
    wanted = estimate_pair(force, response)
    np.testing.assert_allclose(sums.h1, wanted.response, rtol=1e-13)
    left = np.sum(np.abs(response - wanted.response * force) ** 2, axis=0)
    np.testing.assert_allclose(sums.scatter, left, rtol=1e-9)
    assert sums.hits == 6


def test_a_line_without_force_keeps_its_response_as_scatter():
    """Nothing is divided by zero; H1 stays zero there."""
    sums = PairSums.empty(np.zeros(2))
    hit = force_update(np.array([0.0j, 1.0]), sums.force_power)
    sums.add(hit, np.array([2.0 + 0j, 3.0]))
    assert sums.h1.tolist() == [0.0, 3.0]
    assert sums.scatter.tolist() == [4.0, 0.0]


def regression_at_once(spectra: HitSpectra, band: tuple[float, float]) -> float:
    """Return F of the slopes of all pairs on one level, by weighted least squares."""
    inside = (spectra.frequency >= band[0]) & (spectra.frequency <= band[1])
    force = spectra.force[:, inside]
    level = np.log2(np.sqrt(np.mean(np.abs(force) ** 2, axis=1)))
    weight = np.abs(force) ** 2
    total = weight.sum(axis=0)
    away = level[:, None] - (weight * level[:, None]).sum(axis=0) / total
    lever = (weight * away**2).sum(axis=0)
    ratios = []
    for row in range(spectra.response.shape[1]):
        frf = spectra.response[:, row][:, inside] / force
        mean = (weight * frf).sum(axis=0) / total
        slope = (weight * away * frf).sum(axis=0) / lever
        left = (weight * np.abs(frf - mean - away * slope) ** 2).sum(axis=0)
        noise = uniform_filter1d(left / (len(level) - 2) / lever, 41, mode="nearest")
        ratios.append(np.abs(slope) ** 2 / noise)
    return float(np.mean(ratios))


def test_the_regression_on_level_is_that_of_all_hits_at_once():
    """Hit by hit from a recording as from all spectra, in the excited band."""
    judged = [find_hits(recording(i)) for i in range(5)]
    window = choose_window(judged[0])
    spectra = hit_spectra(judged, window)
    wanted = regression_at_once(spectra, excited_band(spectra))
    one = check_linearity(spectra)
    other = check_linearity(hit_forces(plan_spectra(judged), window))
    sums = linearity_of_sums(sum_hits(judged, window, levels=True))
    for found in (one, other, sums):
        assert found.f_value == pytest.approx(wanted, rel=1e-8)
        assert found.significance == pytest.approx(one.significance, rel=1e-6)
        assert found.hits == 5
    np.testing.assert_allclose(sums.change, one.change, rtol=1e-9)


def test_the_gain_of_the_kalman_stage_cancels_in_the_frf():
    """Filtered or not, the FRF differs by less than its noise; the step is the same."""
    judged = [find_hits(recording(i)) for i in range(4)]
    smooth = [replace(smooth_recording(r), hits=r.hits) for r in judged]
    plain = [replace(r, provenance=(observe_noise(r),)) for r in judged]
    one, other = estimate_frf(smooth), estimate_frf(plain)
    band = (one.frequency > 20.0) & (one.frequency < 800.0)
    apart = np.abs(one.response - other.response)[..., band]
    assert np.median(apart / np.sqrt(other.variance[..., band])) < 1.0
    assert smooth[0].provenance[-1] == plain[0].provenance[-1]
    # The stage attenuates the force at high frequencies, which overstates the noise.
    low = one.frequency < 300.0
    found, wanted = (f.innovation_noise[..., low] for f in (other, one))
    np.testing.assert_allclose(found, wanted, rtol=0.05)
    assert np.all(other.innovation_noise <= 1.001 * one.innovation_noise)


def test_the_sums_of_a_measurement_name_its_pairs():
    """Two outputs, one input, and the power of the force."""
    judged = [find_hits(recording(i)) for i in range(3)]
    sums = sum_hits(judged, choose_window(judged[0]))
    assert (sums.outputs, sums.inputs) == (("a1@1", "a2@2"), ("1",))
    assert [row.hits for row in sums.pairs] == [3, 3]
    assert sums.power.shape == sums.frequency.shape


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="ru_maxrss in KiB")
def test_memory_does_not_grow_with_the_hits():
    """Sixteen times as many hits: spectra of all of them would take 130 MB more."""
    code = """
import resource, sys
from dataclasses import replace
sys.path.insert(0, {folder!r})
import test_spectral_sums as t
one = t.find_hits(t.recording(0))
def peak(hits):
    t.estimate_frf([replace(one, name=str(i)) for i in range(hits)])
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
few = peak(40)
print((peak(640) - few) / 1024)
"""
    folder = __file__.rpartition("/")[0]
    done = subprocess.run(
        [sys.executable, "-c", code.format(folder=folder)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert float(done.stdout) < 20.0
