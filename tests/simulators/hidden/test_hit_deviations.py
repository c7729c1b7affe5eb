"""Deviations of simulated hits: sizes, tails, memory, a bad hit."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.hidden.campaign_design import draw_design
from jointbench.simulators.hidden.hit_deviations import ScatterWays, draw_deviations

MANY = 4000


def test_gains_and_delays_scatter_by_their_sizes() -> None:
    """4,000 hits: the sd within 5 %."""
    found = draw_deviations(1, MANY, ScatterWays(channel=0.01, delay=1e-6))
    assert found.gain.std(axis=0) == pytest.approx([0.01, 0.01], rel=0.05)
    assert found.delay.std() == pytest.approx(1e-6, rel=0.05)


def test_successive_hits_are_correlated_by_the_memory() -> None:
    """The correlation of lag one within 0.05."""
    gain = draw_deviations(2, MANY, ScatterWays(channel=0.01, memory=0.8)).gain[:, 0]
    assert np.corrcoef(gain[1:], gain[:-1])[0, 1] == pytest.approx(0.8, abs=0.05)


def test_tails_are_heavier_with_few_degrees_of_freedom() -> None:
    """Three degrees of freedom: hits beyond 6 sizes, which normal draws lack."""
    heavy = draw_deviations(3, MANY, ScatterWays(channel=0.01, tail=3.0)).gain - 1.0
    usual = draw_deviations(3, MANY, ScatterWays(channel=0.01)).gain - 1.0
    assert np.abs(heavy).max() > 0.06 > np.abs(usual).max()


def test_one_hit_is_bad_in_both_channels() -> None:
    """10 % off, and all others on the spot."""
    off = np.abs(draw_deviations(4, 16, ScatterWays(bad=0.1)).gain - 1.0)
    assert np.count_nonzero(off[:, 0]) == 1
    assert off.max(axis=0) == pytest.approx([0.1, 0.1])


def test_a_design_without_further_scatter_is_as_before() -> None:
    """Strength and joint are drawn first, so that seeds keep their campaigns."""
    plain = draw_design(5, hit_scatter=0.002)
    more = draw_design(5, hit_scatter=0.002, ways=ScatterWays(channel=0.01))
    pairs = zip(plain.conditions, more.conditions, strict=True)
    assert all(a.force_factor == b.force_factor for a, b in pairs)
    assert all(c.channel_gain == (1.0, 1.0) for c in plain.conditions)


@pytest.mark.parametrize("wrong", [{"channel": 0.5}, {"memory": 1.0}, {"tail": -1.0}])
def test_a_size_out_of_range_is_refused(wrong: dict[str, float]) -> None:
    """The message states the value and the limits."""
    with pytest.raises(UsageError, match="give 0 to"):
        ScatterWays(**wrong)
