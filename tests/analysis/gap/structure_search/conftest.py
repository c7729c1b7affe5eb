"""Searches of bolted bodies where nothing is missing."""

from dataclasses import replace

import numpy as np
import pytest
from hit_campaigns import Hidden, write_campaign

from jointbench.analysis.gap.intake.read_hit_campaign import read_hit_campaign
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.records_of_search import one_of_each
from jointbench.analysis.gap.structure_search.structure_outcome import StructureOutcome
from jointbench.analysis.gap.structure_search.structure_search import search_structure
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)
from jointbench.station.schemas.nominal_bench_file import read_nominal


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> StructureOutcome:
    """Return the outcome of a search where nothing is missing."""
    path, nominal = write_campaign(tmp_path_factory.mktemp("complete"), Hidden())
    bench = make_structure_bench(read_hit_campaign(path, *read_nominal(nominal)))
    return search_structure(bench, lambda line: None)


@pytest.fixture(scope="module")
def uncertain(found: StructureOutcome) -> StructureBench:
    """Return hits of each condition with an uncertain modal table."""
    campaign = found.base_bench.campaign
    nominal = replace(campaign.nominal, table_sd=(0.005, 0.02))
    bench = make_structure_bench(replace(campaign, nominal=nominal))
    few = replace(bench, reach=STRUCTURE_SEARCH.final_reach)
    few = few.chosen(one_of_each(campaign.hits))
    return few.at(np.zeros(few.base_sd.size), (), few.landing, few.table_floor)
