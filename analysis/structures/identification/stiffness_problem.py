# SPDX-License-Identifier: MIT
"""The identification problem: unknowns, their bounds, and residuals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.identification.sensor_masses import (
    SensorMasses,
    with_mass_factors,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
    evidence_residual,
)
from jointbench.analysis.structures.reduction.body_moduli import is_factor, is_modulus
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

# Largest factor by which a search may leave the box of the reduction.
_BEYOND = 3.0
# Bounds of damping as fractions of stiffness over frequency.
_DAMPING_RANGE = (1e-7, 10.0)
# Bounds of a factor on a modulus.
_MODULUS_RANGE = (0.5, 2.0)
# Bounds of a factor on the springs of supports.
_SUPPORT_RANGE = (0.03, 30.0)
# Bounds of a factor on the mass of a sensor, and the step of its derivative.
_MASS_RANGE = (0.2, 5.0)
_MASS_STEP = 1e-3
# A solution is out if its chi2 exceeds the best one's by three standard deviations.
_SEPARATES = 9.0
# Singular values below this mean a standard deviation of 1e6 in ln: not determined.
_FLAT = 1e-6


@dataclass(frozen=True, slots=True)
class Prior:
    """What is known of a parameter before the measurement.

    Attributes:
        value: expected [N/m], or factor on a modulus [-].
        relative_sd: standard deviation of its logarithm [-].
    """

    value: float
    relative_sd: float

    def __post_init__(self) -> None:
        """Check signs."""
        if not (self.value > 0 and self.relative_sd > 0):
            raise BadData(
                f"a prior of {self.value:g} with a relative sd of "
                f"{self.relative_sd:g}; both must be above zero"
            )


@dataclass(frozen=True, slots=True, eq=False)
class StiffnessProblem:
    """Unknowns and measurements of an identification.

    The unknowns are logarithms of stiffness and damping. Each state has its own
    unknowns, except those that states share.

    Attributes:
        model: the reduced structure.
        evidence: measurements, one per state.
        columns: index among the unknowns of every stiffness, then every damping, of
            each state, shape (n_states, 2 n_parameters); -1 where it is known.
        known: its logarithm where it is known, shape (n_states, 2 n_parameters).
        names: of the unknowns.
        damping: whether an unknown is a damping, shape (n_unknowns,).
        low: bounds of the unknowns.
        high: bounds of the unknowns.
        prior: logarithms expected before the measurement, shape (n_unknowns,).
        prior_sd: their standard deviations, infinite without a prior.
        masses: of sensors, whose factors are the last unknowns; None is none.
    """

    model: ReducedModel
    evidence: tuple[StructureEvidence, ...]
    columns: IntArray
    known: FloatArray
    names: tuple[str, ...]
    damping: FloatArray
    low: FloatArray
    high: FloatArray
    prior: FloatArray
    prior_sd: FloatArray
    masses: SensorMasses | None = None

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.names)


@dataclass(frozen=True, slots=True, eq=False)
class Optimum:
    """An end of a search.

    Attributes:
        unknowns: logarithms, shape (n_unknowns,).
        chi2: sum of squared differences over variances [-].
        slopes: derivatives of the differences, shape (n_rows, n_unknowns).
    """

    unknowns: FloatArray
    chi2: float
    slopes: FloatArray

    def covariance(self) -> FloatArray:
        """Return the covariance of the logarithms: large where undetermined."""
        _, size, direction = np.linalg.svd(self.slopes, full_matrices=False)
        floor = np.full(self.unknowns.size, _FLAT)
        floor[: size.size] = np.maximum(size, _FLAT)
        if direction.shape[0] < self.unknowns.size:
            _, _, direction = np.linalg.svd(self.slopes, full_matrices=True)
        return np.asarray((direction.T / floor**2) @ direction)

    def noise(self) -> float:
        """Return chi2 over its degrees of freedom, at least 1.

        This is the factor of the variances over the given ones.
        """
        freedom = self.slopes.shape[0] - self.unknowns.size
        return max(1.0, self.chi2 / freedom) if freedom > 0 else 1.0

    def limit(self) -> float:
        """Return the chi2 below which a rival of this best solution is admissible."""
        return self.chi2 + _SEPARATES * self.noise()


def pose_problem(
    model: ReducedModel,
    evidence: Sequence[StructureEvidence],
    *,
    known: JointValues | None = None,
    sought: Sequence[str] | None = None,
    shared: Sequence[str] = (),
    priors: Mapping[str, Prior] | None = None,
    masses: SensorMasses | None = None,
) -> StiffnessProblem:
    """Set up the unknowns.

    Args:
        model: the reduced structure.
        evidence: one for each state.
        known: values of the other parameters.
        sought: names ``"<joint>.<direction>"``, whose stiffness and, if measured,
            damping are unknown; default all.
        shared: names of those common to all states; factors on moduli always are.
        priors: of stiffnesses and of factors on moduli, by name.
        masses: of sensors that are unknown, common to all states.

    Returns:
        The problem.

    Raises:
        BadData: a name does not exist, or a direction is neither sought nor known.
    """
    names = model.names
    priors = priors or {}
    for name in (*(sought or ()), *shared, *priors):
        if name not in names:
            raise BadData(f"no joint direction {name!r}; there are {list(names)}")
    count = len(names)
    wanted = np.array(
        [sought is None or name in sought or is_factor(name) for name in names]
    )
    if known is None and not wanted.all():
        left = [name for name, own in zip(names, wanted, strict=True) if not own]
        raise BadData(f"{left} are neither sought nor known; give their stiffness")
    columns = np.full((len(evidence), 2 * count), -1, np.int64)
    labels: list[str] = []
    place: dict[str, int] = {}
    for row, one in enumerate(evidence):
        for at in range(2 * count):
            is_damping = at >= count
            name = names[at % count]
            if not wanted[at % count] or (
                is_damping and (is_factor(name) or not one.damped)
            ):
                continue
            label = _label(name, is_damping)
            if len(evidence) > 1 and name not in shared and not is_factor(name):
                label = f"{one.label}:{label}"
            columns[row, at] = place.setdefault(label, len(place))
    labels = [*place, *(masses.names if masses else ())]
    damping = np.array([label.endswith("_damping") for label in labels], float)
    low, high = _bounds(model, damping)
    for at, label in enumerate(labels):
        if is_factor(label):
            own = _MODULUS_RANGE if is_modulus(label) else _SUPPORT_RANGE
            low[at], high[at] = np.log(own)
    expected, expected_sd = _prior_logs(labels, priors)
    if masses is not None:
        low[len(place) :], high[len(place) :] = np.log(_MASS_RANGE)
        expected_sd[len(place) :] = masses.deviations
    return StiffnessProblem(
        model,
        tuple(evidence),
        columns,
        np.tile(_known_logs(known, count), (len(evidence), 1)),
        tuple(labels),
        damping,
        low,
        high,
        expected,
        expected_sd,
        masses,
    )


def _label(name: str, is_damping: bool) -> str:
    if is_factor(name):
        return name
    return f"{name}_{'damping' if is_damping else 'stiffness'}"


def _prior_logs(
    labels: Sequence[str], priors: Mapping[str, Prior]
) -> tuple[FloatArray, FloatArray]:
    """Return expected logarithms and standard deviations; infinite without a prior."""
    expected, spread = np.zeros(len(labels)), np.full(len(labels), np.inf)
    for name, prior in priors.items():
        own = _label(name, False)
        for at, label in enumerate(labels):
            if label == own or label.endswith(f":{own}"):
                expected[at], spread[at] = np.log(prior.value), prior.relative_sd
    return expected, spread


def _known_logs(known: JointValues | None, count: int) -> FloatArray:
    if known is None:
        # Undamped: a finite logarithm of zero.
        return np.concatenate([np.zeros(count), np.full(count, -np.inf)])
    with np.errstate(divide="ignore"):
        both = np.concatenate([known.stiffness, known.damping])
        return np.asarray(np.log(both))


def _bounds(model: ReducedModel, damping: FloatArray) -> tuple[FloatArray, FloatArray]:
    low, high = np.log(model.box[0] / _BEYOND), np.log(model.box[1] * _BEYOND)
    omega = np.sqrt(model.shift)
    lower = np.where(damping > 0, low + np.log(_DAMPING_RANGE[0] / omega), low)
    upper = np.where(damping > 0, high + np.log(_DAMPING_RANGE[1] / omega), high)
    return lower, upper


def values_of(problem: StiffnessProblem, unknowns: FloatArray, row: int) -> JointValues:
    """Return the joint values of one state."""
    columns = problem.columns[row]
    logs = np.where(columns >= 0, unknowns[columns], problem.known[row])
    both = np.exp(logs)
    count = both.size // 2
    return JointValues(both[:count], both[count:])


def residuals(
    problem: StiffnessProblem, unknowns: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return differences over standard deviations, and their derivatives."""
    rows, slopes = [], []
    for at in range(len(problem.evidence)):
        values = values_of(problem, unknowns, at)
        left, slope = evidence_residual(*state_at(problem, unknowns, at), values)
        whole = np.zeros((left.size, problem.size))
        sought = problem.columns[at] >= 0
        np.add.at(whole.T, problem.columns[at][sought], slope[:, sought].T)
        for column in _mass_columns(problem):
            whole[:, column] = _mass_slope(problem, unknowns, at, column)
        rows.append(left)
        slopes.append(whole)
    given = np.isfinite(problem.prior_sd)
    scale = 1.0 / problem.prior_sd[given]
    rows.append((unknowns - problem.prior)[given] * scale)
    slopes.append(np.eye(problem.size)[given] * scale[:, None])
    return np.concatenate(rows), np.concatenate(slopes)


def state_at(
    problem: StiffnessProblem, unknowns: FloatArray, row: int
) -> tuple[ReducedModel, StructureEvidence]:
    """Return model and measurement of one state, at the masses of the unknowns."""
    model, evidence = problem.model, problem.evidence[row]
    if problem.masses is None:
        return model, evidence
    factors = np.exp(unknowns[list(_mass_columns(problem))])
    model, turn = with_mass_factors(model, problem.masses, factors)
    return model, replace(
        evidence, outputs=evidence.outputs @ turn, inputs=evidence.inputs @ turn
    )


def _mass_columns(problem: StiffnessProblem) -> range:
    count = 0 if problem.masses is None else len(problem.masses.names)
    return range(problem.size - count, problem.size)


def _mass_slope(
    problem: StiffnessProblem, unknowns: FloatArray, row: int, column: int
) -> FloatArray:
    """Return the derivative by the logarithm of a mass, which acts nearly linearly."""
    values, ends = values_of(problem, unknowns, row), []
    for sign in (1.0, -1.0):
        moved = unknowns.copy()
        moved[column] += sign * _MASS_STEP
        ends.append(evidence_residual(*state_at(problem, moved, row), values)[0])
    return np.asarray((ends[0] - ends[1]) / (2.0 * _MASS_STEP))


def states_apart(
    problem: StiffnessProblem,
) -> tuple[tuple[StiffnessProblem, IntArray], ...]:
    """Split a problem whose states share no unknown into separate problems.

    Args:
        problem: of all states.

    Returns:
        Problems and the indices of their unknowns among all; the undivided one where
        states share unknowns.
    """
    owners = [np.unique(row[row >= 0]) for row in problem.columns]
    shared = problem.masses is not None
    if len(owners) < 2 or shared or sum(own.size for own in owners) > problem.size:
        return ((problem, np.arange(problem.size)),)
    parts = []
    for at, own in enumerate(owners):
        place = np.full(problem.size + 1, -1, np.int64)
        place[own] = np.arange(own.size)
        part = StiffnessProblem(
            problem.model,
            (problem.evidence[at],),
            place[problem.columns[at]][None],
            problem.known[at][None],
            tuple(problem.names[k] for k in own),
            problem.damping[own],
            problem.low[own],
            problem.high[own],
            problem.prior[own],
            problem.prior_sd[own],
        )
        parts.append((part, own))
    return tuple(parts)
