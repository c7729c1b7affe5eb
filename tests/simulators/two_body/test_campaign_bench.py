"""A planned campaign on the simulated bench: its records and its refusals."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.two_body.bench_url import bench_from_url, specimen_from_url
from jointbench.simulators.two_body.campaign_bench import CampaignBench, campaign_runs

URL = "sim:two-body-campaign?seed=3&hide=gap&grid=small"


def test_the_url_and_the_bench_say_the_same():
    """A session's source opens the same campaign again."""
    bench = specimen_from_url(URL)
    assert bench == CampaignBench(seed=3, hide="gap", grid="small")
    assert specimen_from_url(bench.name) == bench


def test_a_campaign_depends_on_its_seed_alone():
    """Same seed, same samples; another seed, others."""
    first, again = (campaign_runs(specimen_from_url(URL).simulate()) for _ in range(2))
    for one, other in zip(first, again, strict=True):
        assert_array_equal(one.samples, other.samples)
    other = campaign_runs(specimen_from_url(URL.replace("3", "4")).simulate())
    assert not np.array_equal(first[0].samples, other[0].samples)


def test_what_is_hidden_changes_the_responses_and_not_the_hits():
    """The hammer knows nothing of the joint."""
    with_gap = CampaignBench(seed=3, hide="gap", grid="small").simulate()
    without = CampaignBench(seed=3, grid="small").simulate()
    assert_array_equal(with_gap.force, without.force)
    assert not np.array_equal(with_gap.acceleration, without.acceleration)
    assert [e.name for e in with_gap.effects] == ["gap"]


@pytest.mark.parametrize(
    "query",
    ["hide=gremlin", "grid=huge", "size=0", "noise=-1", "hit_scatter=2", "seed=-1"],
)
def test_values_out_of_range_are_refused_at_once(query):
    """The line names key or value."""
    key, _, value = query.partition("=")
    with pytest.raises(UsageError, match=f"{key}|{value}"):
        specimen_from_url(f"sim:two-body-campaign?{query}")


def test_a_campaign_is_no_single_stream():
    """A request for one stream is refused with the correct URL."""
    with pytest.raises(UsageError, match="sim:two-body"):
        bench_from_url(URL)
