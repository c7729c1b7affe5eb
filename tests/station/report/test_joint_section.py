"""The report's section on links that the modes leave open."""

import numpy as np

from jointbench.analysis.lumped.identify_links import identify_links
from jointbench.analysis.lumped.lumped_model import Body, Link, LumpedModel
from jointbench.analysis.lumped.lumped_modes import solve_modes
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.station.report.joint_section import joint_section
from jointbench.station.screen.joint_text import interval_text
from jointbench.station.screen.page_parts import DataTable


def test_a_link_with_two_solutions_shows_the_range_of_both() -> None:
    """Two frequencies, no shapes: no standard deviation of one of the solutions."""
    bodies = (Body("base", 9.0), Body("top", 4.0))
    ends = (("ground", ("ground", "base")), ("joint", ("base", "top")))
    truth = LumpedModel(
        bodies,
        tuple(Link(n, e, k) for (n, e), k in zip(ends, (4e7, 1.6e7), strict=True)),
    )
    blank = LumpedModel(bodies, tuple(Link(n, e) for n, e in ends))
    frequency = solve_modes(truth).natural_frequency
    joint = identify_links(blank, MeasuredModes(frequency, 1e-3 * frequency))
    links = next(
        one
        for one in joint_section(None, joint, "joint").items
        if isinstance(one, DataTable)
    )
    for row, one in zip(links.rows, joint.parameters, strict=True):
        assert not one.identifiable
        low, high = one.interval
        assert low is not None
        assert high is not None
        assert np.log(high / low) > 0.1
        assert row[1] == interval_text(one.interval)
