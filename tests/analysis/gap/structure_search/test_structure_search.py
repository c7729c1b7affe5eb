"""The search on bolted bodies names nothing that its base does without."""

import numpy as np
import pytest
from hit_campaigns import Hidden, write_campaign

from jointbench.analysis.gap.intake.read_hit_campaign import read_hit_campaign
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_search.structure_fits import accept_structure
from jointbench.analysis.gap.structure_search.structure_search import (
    UNTESTED,
    StructureOutcome,
    needless,
    search_structure,
)
from jointbench.analysis.gap.structure_search.whole_records import JudgedFit
from jointbench.station.schemas.nominal_bench_file import read_nominal


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> StructureOutcome:
    """Return the outcome of a search where nothing is missing."""
    path, nominal = write_campaign(tmp_path_factory.mktemp("complete"), Hidden())
    bench = make_structure_bench(read_hit_campaign(path, *read_nominal(nominal)))
    return search_structure(bench, lambda line: None)


def with_mass(found: StructureOutcome, mass: float) -> JudgedFit:
    """Return the base of an outcome with a mass at the first place, not fitted."""
    heavy = next(c for c in found.bench.candidates if c.effect.name == "added_mass")
    problem = make_problem(found.bench, (heavy,))
    fit = minimise(problem, np.append(found.outcome.base.x, mass), iterations=0)
    return JudgedFit(found.bench, fit, accept_structure(found.bench, fit, fit))


def test_an_effect_that_is_nearly_off_is_not_named(found: StructureOutcome) -> None:
    """The base does as well without a mass of a billionth, so nothing is missing."""
    after = needless(with_mass(found, 1e-9), UNTESTED)
    assert after is not None
    assert after.outcome.acceptance.passed
    assert after.outcome.best.candidates == ()


def test_an_effect_that_is_far_from_off_goes_on_to_its_judge(
    found: StructureOutcome,
) -> None:
    """A mass of a tenth of the structure is many sd from zero."""
    assert needless(with_mass(found, 0.1), UNTESTED) is None
