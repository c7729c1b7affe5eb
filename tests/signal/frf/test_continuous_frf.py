"""FRFs under continuous excitation against a mass on a spring in closed form."""

import numpy as np
import pytest
from scipy.signal import csd, lfilter

from jointbench.acquisition.basics.errors import BadData, ChannelMissing
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.frf.continuous_frf import estimate_continuous_frf

RATE, COUNT = 512.0, 16_384
FORCE = Channel("force", Quantity.FORCE, point="3")
MOVED = Channel("x", Quantity.DISPLACEMENT, point="4")
OMEGA, RATIO, STEP = 2 * np.pi * 60.0, 0.02, 1 / RATE


def recursion() -> tuple[list[float], list[float]]:
    """Return a second-order recursion whose FRF is known at every frequency."""
    pole = np.exp(STEP * OMEGA * complex(-RATIO, np.sqrt(1 - RATIO**2)))
    return [0.0, 1e-3], [1.0, -2 * pole.real, abs(pole) ** 2]


def run(seed: int = 1, noise: float = 0.0, count: int = COUNT) -> Recording:
    """Return a run that begins in the middle of the motion."""
    rng = np.random.default_rng(seed)
    force = rng.standard_normal(count + 2000)
    moved = lfilter(*recursion(), force)
    moved = moved + noise * moved.std() * rng.standard_normal(moved.size)
    return Recording("run", np.array([force, moved])[:, 2000:], RATE, (FORCE, MOVED))


def exact(frequency: np.ndarray) -> np.ndarray:
    """Return the FRF of the recursion."""
    over, under = recursion()
    back = np.exp(-2j * np.pi * frequency * STEP)
    powers = back ** np.arange(3)[:, None]
    return np.asarray((over @ powers[:2]) / (under @ powers))


@pytest.mark.parametrize("block", [1.0, 4.0])
def test_a_resonance_is_right_where_a_window_would_flatten_it(block: float) -> None:
    """Two or ten lines to the half-power bandwidth, the record begins in motion."""
    record = run()
    frf = estimate_continuous_frf((record,), block=block)
    true = exact(frf.frequency)
    peak = int(np.argmax(np.abs(true)))
    assert np.max(np.abs(frf.response[0, 0] / true - 1)) < 1e-4
    assert frf.coherence is not None
    assert frf.averages == round(32 / block)
    assert (frf.outputs, frf.inputs) == (("x@4",), ("3",))
    force, moved = record.samples
    count = round(block * RATE)
    lines, cross = csd(force, moved, RATE, nperseg=count)
    power = csd(force, force, RATE, nperseg=count)[1]
    own = int(np.argmin(np.abs(lines - frf.frequency[peak])))
    assert abs(cross[own] / power[own] / true[peak] - 1) > 5e-3


def test_the_variance_is_that_of_the_errors() -> None:
    """Noise of 10 %: errors are 1 of the stated deviation, within the scatter."""
    frf = estimate_continuous_frf((run(2, noise=0.1),))
    assert frf.variance is not None
    error = np.abs(frf.response[0, 0] - exact(frf.frequency)) ** 2
    assert np.mean(error / frf.variance[0, 0]) == pytest.approx(1.0, abs=0.15)


def test_runs_are_averaged_together_and_what_is_no_motion_is_left_out() -> None:
    """Two runs with a microphone beside: sixteen blocks of half the length."""
    sound = Channel("sound", Quantity.PRESSURE)
    runs = [
        Recording(
            f"run {n}",
            np.vstack((own.samples, own.samples[:1])),
            RATE,
            (*own.channels, sound),
        )
        for n, own in enumerate((run(3), run(4)))
    ]
    frf = estimate_continuous_frf(runs, block=4.0)
    assert frf.averages == 16
    assert frf.response.shape[0] == 1


def test_what_cannot_be_estimated_is_refused() -> None:
    """A run of two seconds, a force of zero, no force at all."""
    with pytest.raises(BadData, match="too short"):
        estimate_continuous_frf((run(count=1024),))
    still = Recording("still", 0.0 * run().samples, RATE, (FORCE, MOVED))
    with pytest.raises(BadData, match="force of run 'still' is zero"):
        estimate_continuous_frf((still,))
    with pytest.raises(ChannelMissing):
        estimate_continuous_frf((Recording("free", run().samples[1:], RATE, (MOVED,)),))
