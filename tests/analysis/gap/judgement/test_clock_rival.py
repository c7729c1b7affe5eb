# SPDX-License-Identifier: MIT
"""A delay of all channels looks like a drifting clock, one of a channel does not."""

import gap_bench as made
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from jointbench.analysis.gap.catalogue.probes import CLOCK_DRIFT
from jointbench.analysis.gap.judgement.clock_rival import clock_rival
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.search.descent import minimise

LATE = 5e-7
"""Delay [s]; the hits begin 8 ms after their records, so that 60 ppm would do it."""


def fitted(site: str) -> tuple[LumpedBench, Fit, Fit]:
    """Return the bench of a delay, the fit of the delay, and that of the base."""
    bench = make_bench(made.made_campaign([("delay", site, [LATE])]))
    assert isinstance(bench, LumpedBench)
    term = made.term_of(bench, "delay", site, [LATE])
    start = np.concatenate([made.BASE, term.coordinates])
    delayed = minimise(make_problem(bench, (term.candidate,)), start)
    return bench, delayed, minimise(make_problem(bench, ()), made.BASE)


@pytest.mark.parametrize(
    ("site", "reason"), [("channel:all", "a clock"), ("channel:a0", "")]
)
def test_a_clock_explains_a_delay_of_all_channels_alone(site: str, reason: str) -> None:
    """Hits that begin at the same sample cannot show which of the two it is."""
    found = clock_rival(*fitted(site))
    assert found.startswith(reason)
    assert bool(found) == bool(reason)


def test_the_shape_of_a_drifting_clock_is_that_of_samples_taken_later() -> None:
    """Against splines, for a delay of up to 0.01 samples at 0.2 of the sample rate."""
    index = np.arange(200.0)
    pulse = np.exp(-0.5 * ((index - 90.0) / 12.0) ** 2) * np.sin(0.4 * np.pi * index)
    rate, size = 16384.0, 0.01
    shape = CLOCK_DRIFT.shape
    assert shape is not None
    found = shape(pulse, pulse, np.array([size / rate]), rate) - pulse
    late = index - size * index / index[-1]
    wanted = CubicSpline(index, pulse)(late) - pulse
    np.testing.assert_allclose(found, wanted, atol=0.03 * np.abs(wanted).max())
