"""Scatter of hits along directions: sizes, trends, outstanding hits, correlation."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.hit_scatter import HitsSeen, estimate_scatter
from jointbench.analysis.gap.residuals.noise_models import whitening_of_all
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.residuals.scatter_likelihood import compress
from jointbench.analysis.gap.residuals.scatter_record import (
    HitScatter,
    ScatterDirection,
)
from jointbench.analysis.gap.residuals.scatter_sizes import SizeProblem, likeliest_sizes

HITS, ROWS = 16, 600
DIRECTIONS = (
    ScatterDirection("force gain", "-", (0,)),
    ScatterDirection("stiffness of joint", "-", (1,)),
    ScatterDirection("channel gain", "-", (2, 3)),
)
REPEATS = tuple(np.array([i, i + 8]) for i in range(8))
ORDER = np.arange(HITS, dtype=float)
SIZES = np.array([0.01, 0.002, 0.005, 0.005])


def ways(rng: np.random.Generator) -> FloatArray:
    """Return columns of two decaying channels, hundreds of times the noise."""
    time = np.arange(ROWS // 2)
    found = np.zeros((HITS, 4, ROWS))
    for hit in range(HITS):
        phase = rng.uniform(0, 6, (2, 1))
        tones = np.sin(time * np.array([[0.1], [0.23]]) + phase) * np.exp(-time / 90)
        both = rng.uniform(30, 300) * tones
        found[hit, 0] = both.ravel()
        found[hit, 1] = 30 * np.roll(both, 3, axis=1).ravel() * np.tile(time / 90, 2)
        found[hit, 2, : ROWS // 2] = both[0]
        found[hit, 3, ROWS // 2 :] = both[1]
    return found


def estimated(
    values: FloatArray,
    seed: int = 3,
    *,
    beside: float = 0.0,
    directions: tuple[ScatterDirection, ...] = DIRECTIONS,
) -> HitScatter:
    """Return the scatter of hits that deviate by values, (n_hits, 4).

    Args:
        values: of each hit along each column.
        seed: of the noise.
        beside: a residual that no direction describes, over the noise.
        directions: with the sizes that are stated.
    """
    rng = np.random.default_rng([seed, 1])
    columns = ways(rng)
    residual = np.einsum("ik,ikr->ir", values, columns)
    residual = residual + rng.standard_normal(residual.shape)
    residual[:, ::2] += beside
    seen = HitsSeen(np.stack([ORDER, np.tile(np.arange(4.0), 4)]), REPEATS)
    return estimate_scatter(compress(residual, columns), directions, seen, HITS * ROWS)


def drawn(seed: int) -> FloatArray:
    """Return normal deviations of each hit."""
    return np.random.default_rng(seed).standard_normal((HITS, 4)) * SIZES


def test_sizes_of_all_directions_are_found() -> None:
    """Within 45 %, two sd of a size from 16 values; a mean gain is no scatter."""
    found = estimated(drawn(1) + np.array([0.0, 0.0, 0.03, 0.0]))
    assert found.size == pytest.approx([0.01, 0.002, 0.005], rel=0.45)
    assert found.rho == 0.0
    assert found.outstanding == ()


def test_hits_that_do_not_scatter_have_no_size() -> None:
    """Noise alone leaves every size at zero, and so does a mean of all hits."""
    constant = np.tile([0.02, 0.001, 0.0, 0.01], (HITS, 1))
    assert not estimated(constant).size.any()


def test_a_trend_is_no_scatter() -> None:
    """A joint that loosens by 4 % leaves its scatter of 0.2 % as it is."""
    values = drawn(2)
    values[:, 1] -= 0.04 * ORDER / HITS
    assert estimated(values).size[1] == pytest.approx(0.002, rel=0.45)


def test_one_bad_hit_is_named_and_does_not_count() -> None:
    """A hit 30 % too strong stands out; the others scatter by 1 % as before."""
    values = drawn(4)
    values[5, 0] += 0.3
    found = estimated(values)
    assert found.outstanding == ((5, 0),)
    assert found.size[0] == pytest.approx(0.01, rel=0.5)
    assert found.values[5, 0] == pytest.approx(values[5, 0], abs=0.02)


def test_what_repeats_share_is_no_scatter_of_the_joint() -> None:
    """Conditions differ by 5 %, their repeats by 0.1 %: the limit is near 0.1 %."""
    rng = np.random.default_rng(6)
    values = np.zeros((HITS, 4))
    values[:, 1] = np.tile(0.05 * rng.standard_normal(8), 2)
    values[:, 1] += 1e-3 * rng.standard_normal(HITS)
    assert estimated(values).size[1] < 0.01


def conditions_apart(along: list[int], sd: float, seed: int) -> FloatArray:
    """Return deviations by condition along some columns; repeats differ by 0.1 %."""
    rng = np.random.default_rng(seed)
    values = np.zeros((HITS, 4))
    values[:, along] = np.tile(sd * rng.standard_normal((8, len(along))), (2, 1))
    return values + 1e-3 * rng.standard_normal(values.shape)


def test_no_direction_takes_over_what_repeats_deny_another() -> None:
    """Conditions differ along all directions: every size stays near the repeats'."""
    assert estimated(conditions_apart([0, 1, 2, 3], 0.03, 11)).size.max() < 0.01


def test_sizes_are_those_of_repeats_where_the_model_does_not_fit_either() -> None:
    """A law with a model error moves conditions along the directions, too."""
    found = estimated(conditions_apart([1], 0.05, 6), beside=0.8)
    assert found.size[1] == pytest.approx(1e-3, rel=0.5)


def test_a_stated_size_counts_where_the_hits_say_little() -> None:
    """Hits without scatter leave a size of 0; a stated 4e-5 is not contradicted."""
    constant = np.tile([0.02, 0.001, 0.0, 0.01], (HITS, 1))
    stated = replace(DIRECTIONS[0], expected=4e-5)
    found = estimated(constant, directions=(stated, *DIRECTIONS[1:]))
    assert found.size[0] == pytest.approx(4e-5, rel=0.5)
    assert not found.size[1:].any()


def test_hits_overrule_a_stated_size() -> None:
    """16 hits that scatter by 1 %, with 10 % or 0.1 % stated."""
    for expected in (0.1, 0.001):
        stated = replace(DIRECTIONS[0], expected=expected)
        found = estimated(drawn(1), directions=(stated, *DIRECTIONS[1:]))
        assert found.size[0] == pytest.approx(0.01, rel=0.5)


def test_correlation_between_hits_is_found() -> None:
    """A gain that wanders with a memory of 0.93 is not taken for independent."""
    rng = np.random.default_rng(8)
    walk = np.cumsum(rng.standard_normal((HITS, 4)), axis=0) * 0.3
    assert estimated(walk * SIZES).rho > 0.0


@pytest.mark.parametrize("seed", [4, 6, 8])
def test_a_joint_that_loosens_a_little_is_no_correlated_scatter(seed: int) -> None:
    """It loses 2e-5 a hit, steadily, beside channels that scatter by 0.1 %."""
    values = np.zeros((HITS, 4))
    values[:, 1] = -3e-4 * ORDER / HITS
    values[:, 2:] = 1e-3 * np.random.default_rng(seed).standard_normal((HITS, 2))
    found = estimated(values)
    assert found.rho == 0.0
    assert found.size[1] == 0.0


def test_whitening_of_correlated_hits_leaves_unit_noise() -> None:
    """The covariance of all hits together becomes the identity."""
    rng = np.random.default_rng(5)
    columns = rng.standard_normal((3, 2, 8))
    force = [rng.standard_normal((1, 8)) for _ in range(3)]
    sd, rho = np.array([[0.5, 1.0], [2.0, 0.3], [1.0, 1.0]]), 0.7
    basis, mixing = whitening_of_all(force, columns, sd, rho)
    whole = np.zeros((3, basis.shape[1], 3, 8))
    whole[range(3), :, range(3)] = basis
    flat = whole.reshape(-1, 24)
    left = np.eye(24) - flat.T @ mixing @ flat
    spread = columns * sd[:, :, None]
    between = rho ** np.abs(np.subtract.outer(np.arange(3), np.arange(3)))
    covariance = np.einsum("ikr,jks,ij->irjs", spread, spread, between)
    covariance = covariance.reshape(24, 24) + np.eye(24)
    for i, own in enumerate(force):
        at = slice(8 * i, 8 * i + 8)
        covariance[at, at] += own.T @ own
    assert left @ covariance @ left.T == pytest.approx(np.eye(24), abs=1e-9)


def walks(seed: int, memory: float) -> FloatArray:
    """Return gains of successive hits with a memory, (n_hits, 4)."""
    rng = np.random.default_rng([seed, 2])
    steps = rng.standard_normal((HITS, 4))
    found = steps.copy()
    for hit in range(1, HITS):
        found[hit] = memory * found[hit - 1] + np.sqrt(1 - memory**2) * steps[hit]
    return found * SIZES


def loss_by_memory(values: FloatArray, seed: int = 3) -> dict[float, float]:
    """Return -2 log likelihood of each memory at its likeliest sizes, 0 for none."""
    rng = np.random.default_rng([seed, 1])
    columns = ways(rng)
    residual = np.einsum("ik,ikr->ir", values, columns)
    residual = residual + rng.standard_normal(residual.shape)
    means = np.zeros((HITS, 4, 4))
    means[:, range(4), range(4)] = 1.0
    free, nothing = np.full(3, np.inf), np.zeros(3)
    records, which = compress(residual, columns), np.array([0, 1, 2, 2])
    losses = {}
    for rho in (0.0, *RESIDUALS.correlations):
        problem = SizeProblem(records, which, means, free, nothing, rho)
        sizes = likeliest_sizes(problem, np.array([0.01, 0.002, 0.005]))
        losses[rho] = problem.deviance(sizes)
    return losses


def test_the_longest_memory_that_the_hits_allow_is_taken() -> None:
    """Once one is 2 units likelier than none: the largest within 4 of the best."""
    longer = 0
    for seed in range(4):
        values = walks(seed, 0.6)
        losses = loss_by_memory(values)
        best = min(losses, key=lambda rho: losses[rho])
        allowed = [rho for rho in losses if losses[rho] < losses[best] + 4.0]
        significant = losses[0.0] - losses[best] > 2.0
        assert estimated(values).rho == (max(allowed) if significant else 0.0)
        longer += significant and max(allowed) > best
    assert longer > 0


def test_independent_hits_rarely_have_a_memory() -> None:
    """The bar of 2 units is passed by chance in about one of ten campaigns."""
    found = [estimated(drawn(seed)).rho for seed in range(40, 46)]
    assert np.count_nonzero(found) <= 1


def test_a_memory_wins_over_the_trends_that_imitate_it() -> None:
    """Gains that wander for long look like trends, each of which costs likelihood.

    The sizes that remain beside such trends are too small for a long memory; all
    memories are tried from the sizes without them.
    """
    found = [estimated(walks(seed, 0.93)) for seed in (0, 1, 2)]
    assert all(f.rho > 0.0 for f in found)
    assert all(f.outstanding == () for f in found)
