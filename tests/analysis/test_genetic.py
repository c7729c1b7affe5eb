"""The papers' search, for comparison."""

import numpy as np
import pytest
from genetic import (
    evolve_differentially,
    genetic_algorithm,
    squared_frequency_errors,
)

from jointbench.acquisition.basics.errors import UsageError

LOW, HIGH = np.full(2, -3.0), np.full(2, 3.0)


def test_the_objective_is_the_papers_weighted_sum_of_squares() -> None:
    """Equation (6) of 2023: 0.25 (2 Hz)^2 + 0.75 (1 Hz)^2."""
    objective = squared_frequency_errors(
        lambda logs: logs, np.array([10.0, 20.0]), np.array([0.25, 0.75])
    )
    assert objective(np.array([12.0, 19.0])) == pytest.approx(1.75)


@pytest.mark.parametrize("search", [genetic_algorithm, evolve_differentially])
def test_a_population_closes_in_on_the_minimum(search: object) -> None:
    """The best never becomes worse, and best and mean approach each other."""
    centre = np.array([1.0, -0.5])
    assert callable(search)
    found = search(
        lambda logs: float(np.sum((logs - centre) ** 2)),
        LOW,
        HIGH,
        population=40,
        generations=20,
    )
    assert np.all(np.diff(found.best_of_generation) <= 0)
    assert found.mean_of_generation[-1] < 0.1 * found.mean_of_generation[0]
    np.testing.assert_allclose(found.best, centre, atol=0.1)


def test_a_population_of_two_is_refused() -> None:
    """Crossover needs parents to choose from."""
    with pytest.raises(UsageError, match="at least 4"):
        genetic_algorithm(lambda logs: 0.0, LOW, HIGH, population=2)
