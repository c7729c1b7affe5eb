# SPDX-License-Identifier: MIT
"""Closed modes of a fit whose frequencies an uncertain table leaves open."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.fit_records import split
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_search.retuned_modes import (
    cost_here,
    retuned,
    retuned_as_near,
)
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)


def candidate_of(bench: StructureBench, label: str) -> Candidate:
    """Return the effect of the catalogue that is called so."""
    return next(c for c in bench.candidates if c.label == label)


def explained(
    bench: StructureBench, x: FloatArray, candidates: Sequence[Candidate]
) -> StructureBench:
    """Return the bench with the responses that it predicts at x."""
    n = bench.base_sd.size
    response = bench.response(x[:n], split(x, n, candidates), None)
    hits = replace(bench.campaign.hits, response=response)
    return replace(bench, campaign=replace(bench.campaign, hits=hits), kept={})


def start_at(
    bench: StructureBench, amplitude: float, rng: np.random.Generator
) -> FloatArray:
    """Return the base with tuned modes at one sd each, then an effect."""
    tuned = bench.layout.tuned_at
    base = np.zeros(bench.base_sd.size)
    base[tuned] = bench.base_sd[tuned] * rng.normal(size=tuned.stop - tuned.start)
    return np.append(base, amplitude)


def test_other_closed_modes_are_not_taken_where_they_lose_the_fit(
    uncertain: StructureBench,
) -> None:
    """A body twice as stiff closes to other modes, of which other pairs couple."""
    modulus = (candidate_of(uncertain, "modulus@body:bottom"),)
    rng, lost, limit = np.random.default_rng(525), 0, STRUCTURE_SEARCH.retuned_ratio
    for _ in range(8):
        x = start_at(uncertain, 1.2, rng)
        bench = explained(uncertain, x, modulus)
        before = cost_here(bench, x, modulus)
        other, moved = retuned(bench, x, modulus)
        near, start = retuned_as_near(bench, x, modulus)
        assert cost_here(near, start, modulus) <= limit * before
        if cost_here(other, moved, modulus) > limit * before:
            assert near is bench
            lost += 1
    assert 0 < lost < 8


def test_other_closed_modes_are_taken_where_they_keep_the_fit(
    uncertain: StructureBench,
) -> None:
    """A softer foot hardly changes them."""
    support = (candidate_of(uncertain, "support@foot:0"),)
    x = start_at(uncertain, 0.1, np.random.default_rng(526))
    bench = explained(uncertain, x, support)
    near, start = retuned_as_near(bench, x, support)
    assert near is not bench
    assert cost_here(near, start, support) == pytest.approx(
        cost_here(bench, x, support), rel=0.1
    )
