# SPDX-License-Identifier: MIT
"""The papers' way of searching, for comparison: an objective and a genetic algorithm.

Beside it differential evolution; both work on any function of ln stiffness, so that
they can be run on full solves as the papers did, or on a reduced model.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import Bounds, differential_evolution

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError

Objective = Callable[[FloatArray], float]

_TOURNAMENT = 2
_ELITE = 2
_CROSSOVER = 0.8
# Mutation shrinks from this share of the box to nothing over the generations.
_MUTATION = 0.15


def squared_frequency_errors(
    predict: Callable[[FloatArray], FloatArray],
    measured: FloatArray,
    weights: FloatArray | None = None,
) -> Objective:
    """Return the papers' objective y = sum w (f_c - f_test)^2.

    Args:
        predict: frequencies [Hz] from ln stiffness.
        measured: frequencies [Hz], shape (n_modes,).
        weights: between 0 and 1, shape (n_modes,); all alike when left out.

    Returns:
        The objective [Hz^2], a function of ln stiffness.

    Source:
        Appl. Sci. 2023, 13, 11680, eq. (6).
    """
    share = np.full(measured.size, 1.0 / measured.size) if weights is None else weights

    def objective(logs: FloatArray) -> float:
        return float(share @ (predict(logs)[: measured.size] - measured) ** 2)

    return objective


@dataclass(frozen=True, slots=True, eq=False)
class Evolution:
    """How a population became better.

    Attributes:
        best: unknowns of the best member, shape (n,).
        fitness: its objective.
        best_of_generation: objective, shape (n_generations,).
        mean_of_generation: objective, shape (n_generations,).
        evaluations: how often the objective was asked.
    """

    best: FloatArray
    fitness: float
    best_of_generation: FloatArray
    mean_of_generation: FloatArray
    evaluations: int

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "best", "best_of_generation", "mean_of_generation")


def genetic_algorithm(
    objective: Objective,
    low: FloatArray,
    high: FloatArray,
    *,
    population: int = 50,
    generations: int = 10,
    seed: int = 0,
) -> Evolution:
    """Minimise by tournament, blended crossover, mutation and elitism.

    Args:
        objective: what is to become small.
        low: bounds, shape (n,).
        high: bounds, shape (n,).
        population: members.
        generations: the first included; evaluations are population * generations.
        seed: of all chance.

    Returns:
        The best member and the course, as Fig. 5a of the 2023 paper shows it.

    Raises:
        UsageError: fewer than four members or one generation.

    Source:
        Eshelman and Schaffer 1993, Foundations of Genetic Algorithms 2, 187-202
        (blended crossover).
    """
    if population < 4 or generations < 1:
        raise UsageError(
            f"{population} members over {generations} generations; at least 4 and 1"
        )
    random = np.random.default_rng(seed)
    members = low + (high - low) * random.random((population, low.size))
    fitness = np.array([objective(one) for one in members])
    course = [(float(fitness.min()), float(fitness.mean()))]
    for generation in range(1, generations):
        scale = _MUTATION * (high - low) * (1.0 - generation / generations)
        children = np.array(
            [
                _child(members, fitness, scale, random)
                for _ in range(population - _ELITE)
            ]
        )
        elite = np.argsort(fitness)[:_ELITE]
        members = np.concatenate([members[elite], np.clip(children, low, high)])
        fitness = np.array([objective(one) for one in members])
        course.append((float(fitness.min()), float(fitness.mean())))
    best, mean = np.array(course).T
    at = int(np.argmin(fitness))
    return Evolution(
        members[at], float(fitness[at]), best, mean, population * generations
    )


def _child(
    members: FloatArray,
    fitness: FloatArray,
    scale: FloatArray,
    random: np.random.Generator,
) -> FloatArray:
    parents = [
        members[min(random.integers(fitness.size, size=_TOURNAMENT), key=fitness.item)]
        for _ in range(2)
    ]
    child = parents[0]
    if random.random() < _CROSSOVER:
        child = parents[0] + random.uniform(-0.25, 1.25, child.size) * (
            parents[1] - parents[0]
        )
    return np.asarray(child + scale * random.standard_normal(child.size))


def evolve_differentially(
    objective: Objective,
    low: FloatArray,
    high: FloatArray,
    *,
    population: int = 50,
    generations: int = 10,
    seed: int = 0,
) -> Evolution:
    """Minimise by differential evolution; see `genetic_algorithm`.

    Source:
        Storn and Price 1997, J. Glob. Optim. 11, 341-359.
    """
    seen: list[float] = []

    def watched(logs: FloatArray) -> float:
        seen.append(objective(logs))
        return seen[-1]

    share = max(1, population // low.size)
    result = differential_evolution(
        watched,
        Bounds(low, high),
        popsize=share,
        maxiter=generations - 1,
        rng=seed,
        polish=False,
        tol=0.0,
    )
    members = share * low.size
    course = np.array(seen[: len(seen) // members * members]).reshape(-1, members)
    return Evolution(
        np.asarray(result.x),
        float(result.fun),
        np.minimum.accumulate(course.min(axis=1)),
        course.mean(axis=1),
        len(seen),
    )
