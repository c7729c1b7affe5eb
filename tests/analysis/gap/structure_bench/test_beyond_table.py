# SPDX-License-Identifier: MIT
"""What no error of a modal table explains: responses that bend with the level."""

from dataclasses import replace

import numpy as np
import pytest
from hit_campaigns import Hidden, write_campaign

from jointbench.analysis.gap.intake.read_hit_campaign import read_hit_campaign
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.beyond_table import beyond_table
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.station.schemas.nominal_bench_file import read_nominal

HARD = 500.0
"""Level above which hits of the campaign are hard [N]."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> StructureBench:
    """Return a bench whose table states errors, at its nominal values."""
    path, nominal = write_campaign(tmp_path_factory.mktemp("table"), Hidden())
    campaign = read_hit_campaign(path, *read_nominal(nominal))
    stated = replace(campaign.nominal, table_sd=(0.005, 0.02))
    made = make_structure_bench(replace(campaign, nominal=stated))
    base = np.zeros(made.base_sd.size)
    return made.at(base, (), made.landing, made.table_floor)


def left(bench: StructureBench, change: float, hard: float) -> tuple[float, str]:
    """Return chi2 beyond the table, and why the base is refused.

    Args:
        bench: as made.
        change: of the gain of the second channel [-].
        hard: further change in hard hits [-].
    """
    hits, base = bench.campaign.hits, np.zeros(bench.base_sd.size)
    response = bench.response(base, (), None)
    response[:, 1] *= 1.0 + change
    response[hits.level > HARD, 1] *= 1.0 + hard
    seen = replace(bench.campaign, hits=replace(hits, response=response))
    own = replace(bench, campaign=seen)
    fit = minimise(make_problem(own, ()), base, iterations=0)
    return beyond_table(own, fit)[1], accept_structure(own, fit, fit).reason


def test_errors_that_all_hits_share_are_those_of_a_table(bench: StructureBench) -> None:
    """Residues of a channel that are 5 % too large belong to no law."""
    chi2, reason = left(bench, 0.05, 0.0)
    assert chi2 < 0.1
    assert not reason


def test_what_differs_between_levels_is_no_error_of_a_table(
    bench: StructureBench,
) -> None:
    """Of 6 % in hard hits alone no table makes more than a part."""
    chi2, reason = left(bench, 0.0, 0.06)
    assert chi2 > bench.policy.floor_chi2
    assert "is due to no error of the modal table" in reason


def test_a_channel_that_turns_away_alone_stands_out(bench: StructureBench) -> None:
    """Of 7 % of another channel in the second, no table makes more than a part."""
    base = np.zeros(bench.base_sd.size)
    response = bench.response(base, (), None)
    response[:, 1] += 0.07 * response[:, 0]
    hits = replace(bench.campaign.hits, response=response)
    own = replace(bench, campaign=replace(bench.campaign, hits=hits))
    fit = minimise(make_problem(own, ()), base, iterations=0)
    judged = accept_structure(own, fit, fit)
    assert judged.excess < judged.allowed
    assert judged.reason.startswith(f"{bench.campaign.bodies.channels[1]} leaves")
