# SPDX-License-Identifier: MIT
"""Many starts, one least-squares descent each, and what is distinct among the ends."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import qmc

from jointbench.acquisition.arrays import FloatArray, IntArray
from jointbench.acquisition.errors import BadData
from jointbench.analysis.structures.evidence import Evidence, misfit
from jointbench.analysis.structures.predict import JointValues
from jointbench.analysis.structures.reduced import ReducedModel

# A search may leave the box of the reduction by this factor at the most.
_BEYOND = 3.0
# Damping is sought within these fractions of stiffness over frequency.
_DAMPING_RANGE = (1e-7, 10.0)
_DAMPING_START = 1e-2
# Two ends are one solution if every parameter agrees to this in ln.
_SAME = 0.02
# Singular values below this mean a standard deviation of 1e6 in ln: not determined.
_FLAT = 1e-6
_MOST_STEPS = 100
# So many of the best ends are followed along what is open.
_FOLLOWED = 3
# Open parameters are held at these multiples of their best value.
_HELD_AWAY = (0.03, 0.1, 0.3, 3.0, 10.0, 30.0)


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """What is sought from what.

    The unknowns are logarithms of stiffness and damping. Each state has its own,
    except those that states share.

    Attributes:
        model: the reduced structure.
        evidence: measurements, one a state.
        columns: place among the unknowns of every stiffness, then every damping, of
            each state, shape (n_states, 2 n_parameters); -1 where it is known.
        known: its logarithm where it is known, shape (n_states, 2 n_parameters).
        names: of the unknowns.
        damping: whether an unknown is a damping, shape (n_unknowns,).
        low: bounds of the unknowns.
        high: bounds of the unknowns.
    """

    model: ReducedModel
    evidence: tuple[Evidence, ...]
    columns: IntArray
    known: FloatArray
    names: tuple[str, ...]
    damping: FloatArray
    low: FloatArray
    high: FloatArray

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
        """Return the covariance of the logarithms: large where nothing decides."""
        _, size, direction = np.linalg.svd(self.slopes, full_matrices=False)
        floor = np.full(self.unknowns.size, _FLAT)
        floor[: size.size] = np.maximum(size, _FLAT)
        if direction.shape[0] < self.unknowns.size:
            _, _, direction = np.linalg.svd(self.slopes, full_matrices=True)
        return np.asarray((direction.T / floor**2) @ direction)


def pose_problem(
    model: ReducedModel,
    evidence: Sequence[Evidence],
    *,
    known: JointValues | None = None,
    sought: Sequence[str] | None = None,
    shared: Sequence[str] = (),
) -> Problem:
    """Lay out the unknowns.

    Args:
        model: the reduced structure.
        evidence: one for each state.
        known: values of what is not sought.
        sought: names ``"<joint>.<direction>"``, of which stiffness and, if the
            evidence knows of it, damping are sought; default all.
        shared: names of those that all states have in common.

    Returns:
        The problem.

    Raises:
        BadData: a name does not exist.
    """
    names = model.names
    for name in (*(sought or ()), *shared):
        if name not in names:
            raise BadData(f"no joint direction {name!r}; there are {list(names)}")
    count = len(names)
    wanted = np.array([sought is None or name in sought for name in names])
    columns = np.full((len(evidence), 2 * count), -1, np.int64)
    labels: list[str] = []
    place: dict[str, int] = {}
    for row, one in enumerate(evidence):
        for at in range(2 * count):
            is_damping = at >= count
            if not wanted[at % count] or (is_damping and not one.damped):
                continue
            label = f"{names[at % count]}_{'damping' if is_damping else 'stiffness'}"
            if len(evidence) > 1 and names[at % count] not in shared:
                label = f"{one.label}:{label}"
            columns[row, at] = place.setdefault(label, len(place))
    labels = list(place)
    damping = np.array([label.endswith("_damping") for label in labels], float)
    low, high = _bounds(model, damping)
    return Problem(
        model,
        tuple(evidence),
        columns,
        np.tile(_known_logs(known, count), (len(evidence), 1)),
        tuple(labels),
        damping,
        low,
        high,
    )


def _known_logs(known: JointValues | None, count: int) -> FloatArray:
    if known is None:
        # Undamped, as far as a logarithm can say it.
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


def values_of(problem: Problem, unknowns: FloatArray, row: int) -> JointValues:
    """Return the joint values of one state."""
    columns = problem.columns[row]
    logs = np.where(columns >= 0, unknowns[columns], problem.known[row])
    both = np.exp(logs)
    count = both.size // 2
    return JointValues(both[:count], both[count:])


def residuals(problem: Problem, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return differences over standard deviations, and their derivatives."""
    rows, slopes = [], []
    for at, evidence in enumerate(problem.evidence):
        values = values_of(problem, unknowns, at)
        left, slope = misfit(problem.model, evidence, values)
        whole = np.zeros((left.size, problem.size))
        sought = problem.columns[at] >= 0
        np.add.at(whole.T, problem.columns[at][sought], slope[:, sought].T)
        rows.append(left)
        slopes.append(whole)
    return np.concatenate(rows), np.concatenate(slopes)


def descend(problem: Problem, start: FloatArray, fixed: Sequence[int] = ()) -> Optimum:
    """Go down from one start, some unknowns held.

    Args:
        problem: what is sought.
        start: logarithms, shape (n_unknowns,).
        fixed: numbers of the unknowns that stay.

    Returns:
        Where it ends.
    """
    parts = states_apart(problem)
    if len(parts) == 1:
        return _descend(problem, start, fixed)
    ends = []
    for part, own in parts:
        held = np.flatnonzero(np.isin(own, np.asarray(fixed, np.int64)))
        ends.append(_descend(part, start[own], held.tolist()))
    return _joined(problem, ends)


def states_apart(problem: Problem) -> tuple[tuple[Problem, IntArray], ...]:
    """Part a problem whose states share no unknown: each is a problem of its own.

    Args:
        problem: what is sought.

    Returns:
        Problems and the places of their unknowns among all; the whole one where states
        share anything.
    """
    owners = [np.unique(row[row >= 0]) for row in problem.columns]
    if len(owners) < 2 or sum(own.size for own in owners) > problem.size:
        return ((problem, np.arange(problem.size)),)
    parts = []
    for at, own in enumerate(owners):
        place = np.full(problem.size + 1, -1, np.int64)
        place[own] = np.arange(own.size)
        part = Problem(
            problem.model,
            (problem.evidence[at],),
            place[problem.columns[at]][None],
            problem.known[at][None],
            tuple(problem.names[k] for k in own),
            problem.damping[own],
            problem.low[own],
            problem.high[own],
        )
        parts.append((part, own))
    return tuple(parts)


def _joined(problem: Problem, ends: Sequence[Optimum]) -> Optimum:
    """Put the ends of all states together."""
    unknowns = np.empty(problem.size)
    rows = sum(end.slopes.shape[0] for end in ends)
    slopes, begin = np.zeros((rows, problem.size)), 0
    for (_, own), end in zip(states_apart(problem), ends, strict=True):
        unknowns[own] = end.unknowns
        after = begin + end.slopes.shape[0]
        slopes[begin:after, own] = end.slopes
        begin = after
    return Optimum(unknowns, sum(end.chi2 for end in ends), slopes)


def _descend(problem: Problem, start: FloatArray, fixed: Sequence[int]) -> Optimum:
    free = np.setdiff1d(np.arange(problem.size), np.asarray(fixed, np.int64))
    base = np.clip(start, problem.low, problem.high)
    last: dict[bytes, tuple[FloatArray, FloatArray]] = {}

    def evaluate(part: FloatArray) -> tuple[FloatArray, FloatArray]:
        key = part.tobytes()
        if key not in last:
            last.clear()
            whole = base.copy()
            whole[free] = part
            last[key] = residuals(problem, whole)
        return last[key]

    def rows(part: FloatArray) -> FloatArray:
        return evaluate(part)[0]

    def slopes_of(part: FloatArray) -> FloatArray:
        return np.asarray(evaluate(part)[1][:, free])

    end = base.copy()
    if free.size:
        result = least_squares(
            rows,
            base[free],
            jac=slopes_of,
            bounds=(problem.low[free], problem.high[free]),
            x_scale="jac",
            xtol=1e-10,
            ftol=1e-12,
            gtol=1e-10,
            max_nfev=_MOST_STEPS,
        )
        end[free] = result.x
    left, slopes = residuals(problem, end)
    return Optimum(end, float(left @ left), slopes)


def find_optima(problem: Problem, *, starts: int, seed: int) -> tuple[Optimum, ...]:
    """Search from many starts and keep what is distinct, the best first.

    Args:
        problem: what is sought.
        starts: points of a Latin hypercube over the logarithms of the box.
        seed: of the points.

    Returns:
        Distinct ends. Where states share nothing each is searched on its own, and a
        rival is another end of one state beside the best of all others.
    """
    searched = [
        _search(part, starts, seed + at)
        for at, (part, _) in enumerate(states_apart(problem))
    ]
    if len(searched) == 1:
        return searched[0]
    best = [ends[0] for ends in searched]
    rivals = [
        _joined(problem, [*best[:at], rival, *best[at + 1 :]])
        for at, ends in enumerate(searched)
        for rival in ends[1:]
    ]
    rivals.sort(key=lambda end: end.chi2)
    return (_joined(problem, best), *rivals)


def _search(problem: Problem, starts: int, seed: int) -> tuple[Optimum, ...]:
    """Search a problem as it is; see `find_optima`."""
    found = [descend(problem, start) for start in _starts(problem, starts, seed)]
    for one in sorted(found, key=lambda end: end.chi2)[:_FOLLOWED]:
        found += _open_ways(problem, one)
    kept: list[Optimum] = []
    for one in sorted(found, key=lambda end: end.chi2):
        if not any(
            np.all(np.abs(one.unknowns - other.unknowns) < _SAME) for other in kept
        ):
            kept.append(one)
    return tuple(kept)


def _open_ways(problem: Problem, best: Optimum) -> list[Optimum]:
    """Return fits with what nothing decides held elsewhere: they show how open it is.

    A descent along a valley stops wherever it begins, so that chance starts alone may
    all end within a narrow part of it.
    """
    spread = np.sqrt(np.diag(best.covariance()))
    ends = []
    for at in np.flatnonzero(spread > 1.0):
        for factor in _HELD_AWAY:
            start = best.unknowns.copy()
            start[at] += np.log(factor)
            if problem.low[at] < start[at] < problem.high[at]:
                ends.append(descend(problem, start, fixed=[int(at)]))
    return ends


def _starts(problem: Problem, count: int, seed: int) -> list[FloatArray]:
    """Spread stiffness over the box; damping follows at light damping ratios."""
    low, high = np.log(problem.model.box[0]), np.log(problem.model.box[1])
    share = qmc.LatinHypercube(problem.size, seed=seed).random(count)
    points = low + (high - low) * share
    light = np.log(_DAMPING_START / np.sqrt(problem.model.shift))
    by_name = {name: at for at, name in enumerate(problem.names)}
    for at, name in enumerate(problem.names):
        if problem.damping[at]:
            partner = by_name.get(name.removesuffix("_damping") + "_stiffness")
            level = points[:, partner] if partner is not None else 0.5 * (low + high)
            points[:, at] = level + light
    return list(points)
