"""The hammer: pulses, scatter and what goes wrong."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.recordings import Verdict
from jointbench.simulators.measuring.hammer import Hammer, Pulse, pulse_force, swing


def test_a_pulse_with_exponent_one_is_a_half_sine():
    """Value at a third of the width is the sine of sixty degrees."""
    pulse = Pulse(start=1.0, width=0.9e-3, peak=200.0, exponent=1.0)
    force = pulse_force([pulse], np.array([0.999, 1.0003, 1.00045, 1.002]))
    expected = [0, 200 * np.sqrt(3) / 2, 200, 0]
    assert_allclose(force, expected, rtol=1e-9, atol=1e-9)


def test_skew_keeps_the_peak_and_moves_it():
    """A positive skew rises slower than it falls."""
    time = np.linspace(0, 1e-3, 10_001)
    force = pulse_force([Pulse(0.0, 1e-3, 50.0, skew=0.2)], time)
    assert_allclose(force.max(), 50.0, rtol=1e-6)
    assert time[np.argmax(force)] > 0.55e-3


def test_pulses_that_overlap_add_up():
    """Force is linear in its contacts."""
    time = np.linspace(0, 2e-3, 201)
    one, two = Pulse(0.0, 1e-3, 10.0), Pulse(0.5e-3, 1e-3, 20.0)
    both = pulse_force([one, two], time)
    assert_allclose(both, pulse_force([one], time) + pulse_force([two], time))


def test_the_first_hits_do_not_depend_on_how_many_follow():
    """A longer session begins with the shorter one."""
    hammer = Hammer()
    assert swing(hammer, hits=4, seed=5) == swing(hammer, hits=9, seed=5)[:4]


def test_faults_come_at_the_stated_rates():
    """Of 2,000 hits a fifth bounce and a tenth overload, within 4 sigma."""
    hammer = Hammer(double_rate=0.2, overload_rate=0.1)
    verdicts = [hit.verdict for hit in swing(hammer, hits=2000, seed=1)]
    assert abs(verdicts.count(Verdict.DOUBLE) - 400) < 4 * np.sqrt(2000 * 0.2 * 0.8)
    assert abs(verdicts.count(Verdict.OVERLOAD) - 200) < 4 * np.sqrt(2000 * 0.1 * 0.9)


def test_an_overload_exceeds_the_range_and_a_bounce_has_two_pulses():
    """The verdict describes the pulses."""
    hammer = Hammer(double_rate=0.5, overload_rate=0.5, overload_level=1000)
    for hit in swing(hammer, hits=50, seed=2):
        if hit.verdict is Verdict.OVERLOAD:
            assert hit.peak_force > 1000
        else:
            assert len(hit.pulses) == 2


def test_rates_that_exceed_one_together_are_refused():
    """A hit has one fate."""
    with pytest.raises(UsageError, match="together exceed 1"):
        Hammer(double_rate=0.7, overload_rate=0.7)


def test_a_level_of_zero_is_refused():
    """A hammer that does not strike is no hammer."""
    with pytest.raises(UsageError, match="level is 0"):
        Hammer(level=0)
