"""Recordings of a bench as a campaign: levels, preloads, points, order."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.analysis.gap.intake.session_campaign import (
    nominal_levels,
    session_campaign,
)
from jointbench.analysis.gap.model.nominal import NominalParameters
from jointbench.analysis.gap.model.stated_scatter import StatedScatter
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.lumped.lumped_model import (
    Body,
    Link,
    LumpedModel,
    Output,
    ResponseChannel,
)

MODEL = LumpedModel(
    bodies=(Body("bed", 9.0, 0.01), Body("column", 4.0, 0.01), Body("head", 2.0, 0.01)),
    links=(
        Link("feet", ("ground", "bed"), 2e7, 300.0, 0.1, 0.3),
        Link("bolts", ("bed", "column"), 6e7, 200.0, 0.1, 0.3, joint=True),
        Link("slide", ("column", "head"), 5e7, 200.0, 0.1, 0.3, joint=True),
    ),
    channels=(ResponseChannel("a2", "head"), ResponseChannel("a0", "bed")),
)
NOMINAL = NominalParameters(MODEL, {}, preload_reference=4000.0)


def run(
    name: str, *, point: str = "1", preload: float | None = 4e3, peak: float = 100.0
) -> Recording:
    """Return a recording of one hit on a bench of three channels."""
    time = np.arange(2048) / 16384.0
    pulse = peak * np.exp(-0.5 * ((time - 197 / 16384.0) / 2e-4) ** 2)
    rows = np.stack([pulse, 0.1 * pulse, 0.2 * pulse, 0.3 * pulse])
    rows += 1e-3 * np.random.default_rng(3).standard_normal(rows.shape)
    channels = (
        Channel("force", Quantity.FORCE, point),
        *(Channel(f"a{k}", Quantity.ACCELERATION, str(k + 1)) for k in range(3)),
    )
    hit = Hit(90, 190, 2048, point, peak, Verdict.OK, 0.0, "")
    return Recording(name, rows, 16384.0, channels, hits=(hit,), preload=preload)


def test_points_levels_preloads_and_order_come_from_the_recordings() -> None:
    """A point belongs to the body of the channel at that point; channels by name."""
    runs = [
        run("first", point="3", peak=95.0),
        run("second", point="1", peak=105.0, preload=8000.0),
        run("third", point="head", peak=940.0),
    ]
    campaign, left_out = session_campaign("visit", runs, NOMINAL)
    assert left_out == ()
    assert_array_equal(campaign.hit, [2, 0, 2])
    assert_array_equal(campaign.preload, [4000.0, 8000.0, 4000.0])
    assert_array_equal(campaign.order, [0, 1, 2])
    assert_array_equal(campaign.level, [100.0, 100.0, 940.0])
    peaks = campaign.response.max(axis=2)
    np.testing.assert_allclose(peaks[0], [0.3 * 95, 0.1 * 95], rtol=1e-2)


def test_a_model_of_three_bodies_makes_a_bench_with_every_joint_as_a_site() -> None:
    """The engine takes any number of bodies and links."""
    campaign, _ = session_campaign("visit", [run("one"), run("two")], NOMINAL)
    bench = make_bench(campaign)
    sites = {str(c.site) for c in bench.candidates}
    assert {"link:bolts", "link:slide", "body:head", "channel:a2"} <= sites
    assert "link:feet" not in sites
    assert bench.response(np.zeros(9), ()).shape == campaign.response.shape


def test_peaks_are_grouped_into_the_levels_aimed_at() -> None:
    """Ten per cent of scatter does not split a level; a factor of two does."""
    peaks = np.array([31.0, 28.0, 96.0, 108.0, 315.0, 285.0, 640.0, 1000.0])
    levels = nominal_levels(peaks)
    assert_array_equal(levels, [29, 29, 100, 100, 300, 300, 800, 800])
    assert np.unique(nominal_levels(np.geomspace(10, 1000, 60))).size >= 4


@pytest.mark.parametrize(
    ("recording", "nominal", "words"),
    [
        (run("r", preload=None), NOMINAL, "--preload"),
        (run("r", point="9"), NOMINAL, r"points = \['9'\]"),
        (
            run("r"),
            replace(NOMINAL, model=replace(MODEL, output=Output.VELOCITY)),
            "velocity",
        ),
    ],
)
def test_a_missing_fact_is_reported_with_advice(
    recording: Recording, nominal: NominalParameters, words: str
) -> None:
    """A preload, a body for a point, the right quantity."""
    with pytest.raises(BadData, match=words) as caught:
        session_campaign("visit", [recording], nominal)
    assert "\n" not in str(caught.value)


def test_several_preloads_need_a_reference() -> None:
    """One preload is its own reference."""
    nominal = replace(NOMINAL, preload_reference=None)
    campaign, _ = session_campaign("visit", [run("a"), run("b")], nominal)
    assert campaign.preload_reference == 4000.0
    with pytest.raises(BadData, match="preload_reference"):
        session_campaign("visit", [run("a"), run("b", preload=8e3)], nominal)


def test_the_stated_scatter_reaches_the_directions_of_the_bench() -> None:
    """Each direction expects its size; one stiffness is stated for every joint."""
    stated = StatedScatter(joint_stiffness=0.002, channel_delay=1e-6)
    campaign, _ = session_campaign(
        "c", [run("r1"), run("r2")], replace(NOMINAL, scatter=stated)
    )
    directions = make_bench(campaign).noise.scatter.directions
    expected = {d.name: d.expected for d in directions if d.expected > 0.0}
    assert expected == {
        "stiffness of bolts": 0.002,
        "stiffness of slide": 0.002,
        "channel delay": 1e-6,
    }
