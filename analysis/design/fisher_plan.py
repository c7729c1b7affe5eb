# SPDX-License-Identifier: MIT
"""Information of a test plan: which hits and which sensors determine parameters.

A pair of a sensor and a hit point informs on the common parameters through the slopes
of its FRF. Gains of sensors and of hits are nuisances with priors: they are eliminated.
All parameters are logarithms.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.design.information import (
    expected_covariance,
    information_of,
    prior_information,
    without_nuisances,
)


class Criterion(StrEnum):
    """What a plan makes small.

    D: the geometric mean of the principal standard deviations of the wanted parameters;
    E: the largest of them.
    """

    D = "D"
    E = "E"


@dataclass(frozen=True, slots=True, eq=False)
class PairInformation:
    """Information of one hit for every sensor and hit point that can be had.

    Attributes:
        common: of the common parameters, shape (n_sensors, n_hits, p, p).
        cross: between these and the gain of the pair, shape (n_sensors, n_hits, p).
        own: of the gain, shape (n_sensors, n_hits).
    """

    common: FloatArray
    cross: FloatArray
    own: FloatArray

    def __post_init__(self) -> None:
        """Check the shapes and make the arrays read-only."""
        sensors, hits = self.own.shape
        p = self.common.shape[-1]
        wanted = ((sensors, hits, p, p), (sensors, hits, p))
        if (self.common.shape, self.cross.shape) != wanted:
            raise BadData(
                f"information of shapes {self.common.shape} and {self.cross.shape}; "
                f"{sensors} sensors and {hits} hits need {wanted}"
            )
        freeze(self, "common", "cross", "own")


@dataclass(frozen=True, slots=True, eq=False)
class PlanPrior:
    """What is known before the first hit.

    Attributes:
        deviation: sd of the common parameters in ln, infinite without a prior, shape
            (p,).
        gain_sd: of a sensor's sensitivity in ln [-]; 0 is exact.
        force_sd: of the force at a hit point in ln (aim, direction) [-]; 0 is exact.
    """

    deviation: FloatArray
    gain_sd: float = 0.0
    force_sd: float = 0.0

    def __post_init__(self) -> None:
        """Make the array read-only."""
        freeze(self, "deviation")


@dataclass(frozen=True, slots=True)
class HitPlan:
    """Sensors and hit points, by number, and the hits at each point.

    Attributes:
        sensors: numbers.
        hits: numbers.
        repeats: hits at each point.
    """

    sensors: tuple[int, ...]
    hits: tuple[int, ...]
    repeats: float = 1.0


def pairs_of(slopes: ComplexArray, response: ComplexArray) -> PairInformation:
    """Return the information of pairs; a gain is a parameter like any other.

    Args:
        slopes: derivatives of the FRFs by the common parameters over the standard
            deviation of their real part, shape (n_sensors, n_hits, n_lines, p).
        response: the FRFs over the same, shape (n_sensors, n_hits, n_lines): their
            derivative by the logarithm of a gain.
    """
    whole = information_of(np.concatenate([slopes, response[..., None]], axis=-1))
    return PairInformation(
        whole[..., :-1, :-1], whole[..., :-1, -1], whole[..., -1, -1]
    )


def plan_covariance(
    pairs: PairInformation, prior: PlanPrior, plan: HitPlan
) -> FloatArray:
    """Return the expected covariance of the common parameters, shape (p, p).

    Args:
        pairs: information of single hits.
        prior: what is known before.
        plan: sensors and hits.

    Returns:
        Of the logarithms; large where the plan and the prior leave one open.
    """
    at = np.ix_(plan.sensors, plan.hits)
    whole = prior_information(prior.deviation)
    whole = whole + plan.repeats * pairs.common[at].sum(axis=(0, 1))
    own, cross = plan.repeats * pairs.own[at], plan.repeats * pairs.cross[at]
    blocks: list[FloatArray] = []
    links: list[FloatArray] = []
    if prior.gain_sd > 0:
        links.append(cross.sum(axis=1).T)
        blocks.append(np.diag(1.0 / prior.gain_sd**2 + own.sum(axis=1)))
    if prior.force_sd > 0:
        links.append(cross.sum(axis=0).T)
        blocks.append(np.diag(1.0 / prior.force_sd**2 + own.sum(axis=0)))
    if blocks:
        nuisance = blocks[0]
        if len(blocks) == 2:
            nuisance = np.block([[blocks[0], own], [own.T, blocks[1]]])
        whole = without_nuisances(whole, np.hstack(links), nuisance)
    return expected_covariance(whole)


def plan_width(covariance: FloatArray, wanted: IntArray, criterion: Criterion) -> float:
    """Return the width that a criterion makes small [-].

    Args:
        covariance: of the common parameters.
        wanted: numbers of the wanted ones.
        criterion: D or E.
    """
    value = np.linalg.eigvalsh(covariance[np.ix_(wanted, wanted)])
    value = np.maximum(value, 1e-300)
    if criterion is Criterion.E:
        return float(np.sqrt(value[-1]))
    return float(np.exp(0.5 * np.mean(np.log(value))))


def hits_needed(
    pairs: PairInformation,
    prior: PlanPrior,
    plan: HitPlan,
    wanted: Sequence[int],
    deviation: float,
    most: int = 1000,
) -> int | None:
    """Return how many hits at each point bring all wanted parameters to a deviation.

    Args:
        pairs: information of single hits.
        prior: what is known before.
        plan: sensors and hit points.
        wanted: numbers of the parameters.
        deviation: standard deviation in ln [-].
        most: hits at a point.

    Returns:
        The smallest number; None where `most` hits do not suffice, because gains or
        moduli limit it.
    """

    def reached(count: int) -> bool:
        full = HitPlan(plan.sensors, plan.hits, count)
        found = plan_covariance(pairs, prior, full)
        return bool(np.sqrt(np.diag(found)[list(wanted)].max()) <= deviation)

    if not reached(most):
        return None
    low, high = 0, most
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if reached(middle) else (middle, high)
    return high
