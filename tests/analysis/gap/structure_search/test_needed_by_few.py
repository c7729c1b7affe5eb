# SPDX-License-Identifier: MIT
"""A third of the records decides first whether a base needs an effect."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.records_of_search import torques_in_turn
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_search import (
    UNTESTED,
    needless,
)
from jointbench.analysis.gap.structure_search.whole_records import JudgedFit


def test_a_base_that_a_third_of_the_records_refuses_is_fitted_to_no_more(
    uncertain: StructureBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A channel that reads a half more is no error of a table in any of them."""
    gain = next(c for c in uncertain.candidates if c.effect.name == "gain_error")
    x = np.append(np.zeros(uncertain.base_sd.size), 0.5)
    term = Term(gain, x[-1:])
    hits = uncertain.campaign.hits
    response = uncertain.response(x[:-1], (term,), None)
    made = replace(
        uncertain,
        campaign=replace(uncertain.campaign, hits=replace(hits, response=response)),
        kept={},
    )
    fit = minimise(make_problem(made, (gain,)), x, iterations=0)
    best = JudgedFit(made, fit, accept_structure(made, fit, fit))
    sizes: list[int] = []
    plain = StructureBench.slopes

    def counted(
        own: StructureBench,
        base: FloatArray,
        terms: Sequence[Term],
        resolution: Resolution,
    ) -> FloatArray:
        sizes.append(len(own.landing))
        return plain(own, base, terms, resolution)

    monkeypatch.setattr(StructureBench, "slopes", counted)
    assert needless(best, UNTESTED) is None
    assert set(sizes) == {len(torques_in_turn(hits))}
    assert max(sizes) < len(hits.names)
