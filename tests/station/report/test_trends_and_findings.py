"""What a report says first, and modes over several torques."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointbench.acquisition.records.provenance import Step
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.analysis.lumped.identified import JointParameter
from jointbench.station.report.figures.torque_trends import (
    torque_states,
    track_modes,
    trends_section,
)
from jointbench.station.report.findings.interval_words import (
    between,
    value_and_interval,
)
from jointbench.station.screen.page import figures_in
from jointbench.station.screen.page_parts import DataTable


@pytest.mark.parametrize(
    ("value", "sd", "unit", "said"),
    [
        (0.0736, 0.0024, "-", ("0.0736", "95 %: 0.0689 to 0.0783")),
        (5.9984e7, 4.4e4, "N/m", ("59.984 MN/m", "95 %: 59.898 to 60.070 MN/m")),
        (1.485, 0.0031, "", ("1.4850", "95 %: 1.4789 to 1.4911")),
        (2.0e7, None, "N/m", ("20 MN/m", "")),
        (float("nan"), 1.0, "Hz", ("-", "")),
        (0.0, 0.5, "N", ("0.00 N", "95 %: -0.98 to 0.98 N")),
    ],
)
def test_a_value_has_as_many_digits_as_its_interval_resolves(value, sd, unit, said):
    """Two figures of the half width, and an SI prefix."""
    assert value_and_interval(value, sd, unit) == said


def test_an_interval_need_not_be_even():
    """Both ends in the unit of the value."""
    assert between(3.43e12, 3.37e12, 3.48e12, "N/m")[1] == "95 %: 3.370 to 3.480 TN/m"


def model(frequency, shapes=None):
    """Return what a trend reads of a model: two outputs, 0.1 % of uncertainty."""
    f = np.asarray(frequency, float)
    given = np.eye(2)[np.arange(f.size) % 2] if shapes is None else np.asarray(shapes)
    return SimpleNamespace(
        natural_frequency=f,
        frequency_sd=1e-3 * f,
        damping_ratio=np.full(f.size, 0.01),
        damping_ratio_sd=np.full(f.size, 1e-4),
        shapes=given.astype(complex),
    )


def state(preload, found, torque=None, stiffness=None, preload_sd=None):
    """Return modes at one preload, with a torque in the provenance."""
    detail = () if torque is None else (("torque", torque),)
    recording = Recording(
        "r",
        np.zeros((1, 10)),
        1000.0,
        (Channel("force", Quantity.FORCE),),
        provenance=(Step("recorded", detail),),
        preload_sd=preload_sd,
    )
    chain = SimpleNamespace(
        result=SimpleNamespace(model=found), recordings=(recording,)
    )
    joint = None
    if stiffness is not None:
        ends = (0.9 * stiffness, 1.1 * stiffness)
        one = JointParameter(
            "joint.stiffness", stiffness, 0.05 * stiffness, "N/m", True, "", ends
        )
        joint = SimpleNamespace(parameters=(one,))
    return SimpleNamespace(preload=preload, modal=chain, joint=joint)


def test_modes_are_followed_by_shape_where_they_cross():
    """Two modes change places; each keeps its shape, so each keeps its line."""
    swapped = np.eye(2)[::-1]
    found = track_modes([model([100, 105]), model([103, 106], swapped)])
    assert [track.tolist() for track in found] == [[0, 1], [1, 0]]


def test_a_mode_that_a_torque_lacks_is_left_open_and_found_again():
    """Not found at the second of three."""
    models = [model([100, 200]), model([102]), model([104, 206])]
    assert [t.tolist() for t in track_modes(models)] == [[0, 0, 0], [1, -1, 1]]


def test_states_are_in_the_order_of_torque_where_all_state_it():
    """Torque on the bolts comes before preload."""
    several = [state(2e4, model([110]), 20.0), state(1e4, model([100]), 10.0)]
    found = torque_states(several)
    assert found.title == "torque on each bolt [N m]"
    assert found.at.tolist() == [10.0, 20.0]
    bare = [state(2e4, model([110])), state(1e4, model([100]))]
    assert torque_states(bare).title == "preload [N]"
    assert torque_states(bare[:1]) is None


def test_a_session_of_several_torques_has_frequency_damping_and_stiffness_over_it():
    """A figure of each mode with both, one of each link, and all numbers in tables."""
    several = [
        state(1e4, model([100, 200]), 10.0, 5e7),
        state(2e4, model([110, 205]), 20.0, 6e7),
    ]
    section = trends_section(several)
    assert section.title == "Modes and joint over torque on each bolt"
    plots = {plot.identifier: plot.figure for plot in figures_in(section.items)}
    assert plots.keys() == {"trend-mode-1", "trend-mode-2", "trend-link-0"}
    frequency, damping = plots["trend-mode-1"]["data"]
    assert frequency["y"] == [100.0, 110.0]
    assert frequency["error_y"]["array"] == pytest.approx([0.196, 0.2156], rel=1e-3)
    assert damping["y"] == [1.0, 1.0]
    (link,) = plots["trend-link-0"]["data"]
    assert link["y"] == [5e7, 6e7]
    assert link["error_y"]["array"] == pytest.approx([5e6, 6e6])
    modes, links = (one for one in section.items if isinstance(one, DataTable))
    assert len(modes.rows) == 4
    assert links.rows[0][:2] == ("joint.stiffness", "10")


def test_a_measured_preload_is_shown_with_its_uncertainty():
    """Level intervals in the figures, one standard deviation in the tables."""
    several = [
        state(1e4, model([100]), 10.0, 5e7, preload_sd=200.0),
        state(2e4, model([110]), 20.0, 6e7, preload_sd=300.0),
    ]
    section = trends_section(several)
    assert section.title == "Modes and joint over preload"
    plots = {plot.identifier: plot.figure for plot in figures_in(section.items)}
    for trace in (plots["trend-mode-1"]["data"][1], plots["trend-link-0"]["data"][0]):
        assert trace["error_x"]["array"] == pytest.approx([392.0, 588.0], rel=1e-3)
    modes, links = (one for one in section.items if isinstance(one, DataTable))
    assert modes.rows[0][1] == links.rows[0][1] == "10000 ± 200"
