# SPDX-License-Identifier: MIT
"""Stiffness and damping of joints from measured modes of a lumped bench."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.lumped.identified import (
    Identification,
    IdentificationVerdict,
    JointParameter,
    Solution,
)
from jointbench.analysis.lumped.link_problem import (
    JointProblem,
    model_at,
    pose_problem,
    split,
)
from jointbench.analysis.lumped.link_search import LinkOptimum, find_optima
from jointbench.analysis.lumped.lumped_matrices import incidence
from jointbench.analysis.lumped.lumped_model import LumpedModel
from jointbench.analysis.lumped.lumped_modes import solve_modes
from jointbench.analysis.lumped.measured_modes import MeasuredModes

# A solution is out if its chi2 exceeds the best one's by three standard deviations.
_SEPARATES = 9.0
_NO_FIT = (
    "the model does not fit the modes, so its value has no meaning; check masses, "
    "mode numbers and links, then identify again"
)
# The model does not fit if the probability of a larger chi2 is below this.
_POOR_FIT = 1e-3
# Standard deviation in ln above which a parameter is not determined (100 %).
_LARGEST_LOG_SD = 1.0
# Above this one the value has no meaning: no measurement determines it.
_NO_SD = 1e3
# 95 % of a normal distribution.
_Z = 1.959963984540054
# A search may end at many points of a continuum, or at poor local optima: most rivals
# of the best that are listed, and most excluded solutions.
_LISTED = 7


@one_thread()
def identify_links(
    model: LumpedModel,
    measured: MeasuredModes,
    *,
    unknown: Sequence[str] | None = None,
    mode_numbers: Sequence[int] | None = None,
    starts: int = 24,
    seed: int = 0,
) -> Identification:
    """Find the stiffness and damping of links from measured modes.

    Args:
        model: weighed bodies, and links. The stiffness and damping of an unknown link
            are only a start, unless their standard deviations are given.
        measured: natural frequencies, damping ratios and, if there are any, shapes.
        unknown: names of the links to identify; default all.
        mode_numbers: index of the model's mode, from 0, for each measured one; default
            the lowest.
        starts: of the search over decades of stiffness.
        seed: of the starts.

    Returns:
        Values with standard deviations (enlarged where chi2 shows that the given
        uncertainties are too small), every distinct solution, and a verdict. Two
        frequencies of two bodies in a chain have two exact solutions: without mode
        shapes the answer is "several solutions".

    Raises:
        BadData: more modes than the model can have, or one response given twice.
        UsageError: a link, body or mode number that does not exist.

    Source:
        Appl. Sci. 2023, 13, 11680, eqs. (5)-(6), whose genetic algorithm on absolute
        frequency errors is replaced by weighted least squares on relative ones.
    """
    problem = pose_problem(model, measured, unknown=unknown, mode_numbers=mode_numbers)
    optima = find_optima(problem, starts=starts, seed=seed)
    best = optima[0]
    freedom = best.slopes.shape[0] - problem.size
    scale = max(1.0, best.chi2 / max(freedom, 1))
    limit = best.chi2 + _SEPARATES * scale
    rivals = [one for one in optima[1:] if one.chi2 < limit]
    fallen = [one for one in optima[1:] if one.chi2 >= limit]
    parameters = _parameters(problem, [best, *rivals], scale)
    verdict, reasons = _judge(problem, best, rivals, parameters, freedom)
    if verdict is IdentificationVerdict.INCONSISTENT:
        parameters = tuple(
            replace(
                one,
                identifiable=False,
                reason=_NO_FIT,
                sd=None,
                interval=(None, None),
            )
            for one in parameters
        )
    found = model_at(problem, best.unknowns)
    return Identification(
        verdict=verdict,
        reasons=reasons,
        parameters=parameters,
        log_covariance=_log_covariance(problem, best, scale),
        solutions=(
            *(_solution(problem, one, True) for one in [best, *rivals[:_LISTED]]),
            *(_solution(problem, one, False) for one in fallen[:_LISTED]),
        ),
        measured_frequency=measured.natural_frequency,
        energy_share=_energy_share(problem, found),
        degrees_of_freedom=freedom,
        model=found,
    )


def _names(problem: JointProblem) -> list[tuple[str, str]]:
    """Return name and unit of every parameter, in the order of the unknowns."""
    links = problem.model.links
    return [(f"{links[i].name}.stiffness", "N/m") for i in problem.stiff] + [
        (f"{links[i].name}.damping", "N s/m") for i in problem.damped
    ]


def _values(problem: JointProblem, unknowns: FloatArray) -> FloatArray:
    """Return stiffnesses [N/m], then damping [N s/m]."""
    log_stiffness, damping, _ = split(problem, unknowns)
    return np.concatenate([np.exp(log_stiffness), damping * problem.damping_scale])


def _solution(problem: JointProblem, optimum: LinkOptimum, stands: bool) -> Solution:
    """Return an optimum in physical numbers."""
    modes = solve_modes(model_at(problem, optimum.unknowns))
    values = _values(problem, optimum.unknowns).tolist()
    names = [name for name, _ in _names(problem)]
    return Solution(
        dict(zip(names, values, strict=True)),
        optimum.chi2,
        bool(stands),
        modes.natural_frequency[problem.mode_numbers],
        modes.damping_ratio[problem.mode_numbers],
    )


def _energy_share(problem: JointProblem, model: LumpedModel) -> FloatArray:
    """Return the share of each link in the strain energy of each measured mode."""
    shapes = solve_modes(model).shapes[problem.mode_numbers]
    stiffness = np.array([link.stiffness for link in model.links])
    energy = stiffness * np.abs(shapes @ incidence(model).T) ** 2
    return np.asarray(energy / energy.sum(axis=1, keepdims=True))


def _parameters(
    problem: JointProblem, standing: Sequence[LinkOptimum], scale: float
) -> tuple[JointParameter, ...]:
    """Return every parameter with its uncertainty and whether it is determined."""
    values = np.array([_values(problem, one.unknowns) for one in standing])
    spreads = np.array([_spreads(problem, one, scale) for one in standing])
    result = []
    for at, (name, symbol) in enumerate(_names(problem)):
        value, spread = float(values[0, at]), float(spreads[0, at])
        reason = _undecided(value, spread, symbol, problem.damping_scale)
        apart = np.abs(values[1:, at] - value) > max(spread, 1e-3 * value)
        if apart.any() and not reason:
            different = values[1:, at][apart].tolist()
            reason = _rivals(problem, [value, *different], symbol)
        count = len(standing) if reason else 1
        ends = _interval(
            values[:count, at], spreads[:count, at], symbol, problem.damping_scale
        )
        sd = None if reason else spread
        result.append(JointParameter(name, value, sd, symbol, not reason, reason, ends))
    return tuple(result)


def _spreads(problem: JointProblem, end: LinkOptimum, scale: float) -> FloatArray:
    """Return the standard deviation of every parameter around a solution [SI]."""
    values = _values(problem, end.unknowns)
    sd = np.sqrt(scale * np.diag(end.covariance())[: values.size])
    # The unknowns are ln stiffness and scaled damping: back to physical numbers.
    unit = np.where(np.arange(sd.size) < problem.stiff.size, values, 0.0)
    return np.asarray(sd * np.where(unit > 0, unit, problem.damping_scale))


def _log_covariance(
    problem: JointProblem, end: LinkOptimum, scale: float
) -> FloatArray:
    """Return the covariance of ln parameters around a solution."""
    damping = _values(problem, end.unknowns)[problem.stiff.size :]
    # Where a damping may be zero its logarithm is open: the sd is limited.
    least = _spreads(problem, end, scale)[problem.stiff.size :] / _NO_SD
    unit = np.ones(problem.stiff.size + damping.size)
    unit[problem.stiff.size :] = problem.damping_scale / np.maximum(damping, least)
    own = scale * end.covariance()[: unit.size, : unit.size]
    return np.asarray(own * np.multiply.outer(unit, unit))


def _interval(
    values: FloatArray, spreads: FloatArray, unit: str, scale: float
) -> tuple[float | None, float | None]:
    """Return the range of the 95 % intervals of solutions; None where it is open.

    Stiffness is uncertain in its logarithm; damping is not, and it may be zero.
    """
    if unit == "N/m":
        if np.any(spreads >= _LARGEST_LOG_SD * values):
            return (None, None)
        factor = np.exp(_Z * spreads / values)
        return (float((values / factor).min()), float((values * factor).max()))
    low = float(np.maximum(values - _Z * spreads, 0.0).min())
    if np.any(spreads >= _NO_SD * np.maximum(values, scale)):
        return (0.0, None)
    return (low, float((values + _Z * spreads).max()))


def _undecided(value: float, sd: float, unit: str, scale: float) -> str:
    """Return why one parameter is not determined; empty if it is."""
    if sd < _LARGEST_LOG_SD * value:
        return ""
    if unit == "N/m":
        return (
            "its standard deviation exceeds its value: the measurement does not "
            "determine it; measure a mode that strains this link, or more modes"
        )
    if not sd < _NO_SD * max(value, scale):
        return (
            "the measurement does not determine it; measure the damping ratio of a "
            "mode that strains this link"
        )
    return (
        f"it cannot be distinguished from zero (95 % below {value + 2 * sd:.3g} "
        f"{unit}); "
        "measure damping ratios with smaller uncertainty"
    )


def _rivals(problem: JointProblem, values: Sequence[float], unit: str) -> str:
    """Return which values fit equally well, and what would separate them."""
    listed = " or ".join(f"{value:.4g}" for value in values[: _LISTED + 1])
    return f"{listed} {unit} fit equally well; {_separator(problem)}"


def _separator(problem: JointProblem) -> str:
    """Return the measurement that would separate several solutions."""
    if problem.measured.shapes is None or problem.outputs.size < 2:
        return "measure the response at two bodies: the mode shapes separate them"
    return "mode shapes of smaller uncertainty, or one more mode, would separate them"


def _judge(
    problem: JointProblem,
    best: LinkOptimum,
    rivals: Sequence[LinkOptimum],
    parameters: Sequence[JointParameter],
    freedom: int,
) -> tuple[IdentificationVerdict, tuple[str, ...]]:
    """Return the verdict on the identification, and its reasons."""
    limit = chi2_limit(_POOR_FIT, freedom) if freedom > 0 else _SEPARATES
    undecided = [one for one in parameters if not one.identifiable]
    reasons = [f"{one.name}: {one.reason}" for one in undecided]
    if best.chi2 > limit:
        reasons.insert(
            0,
            f"chi2 is {best.chi2:.3g} for {freedom} degrees of freedom: no stiffness "
            "and damping explain these modes within their uncertainty; check masses, "
            "mode numbers and whether a link is missing",
        )
        return IdentificationVerdict.INCONSISTENT, tuple(reasons)
    if best.flat:
        reasons.insert(
            0,
            f"{problem.measured_numbers} measured numbers leave a continuum of "
            f"solutions for {len(parameters)} unknowns; measure more modes, or give "
            "known values of a link",
        )
    elif rivals and undecided:
        reasons.insert(
            0, f"{len(rivals) + 1} solutions fit equally well; {_separator(problem)}"
        )
        return IdentificationVerdict.AMBIGUOUS, tuple(reasons)
    if len(undecided) == len(parameters):
        return IdentificationVerdict.UNDETERMINED, tuple(reasons)
    if undecided:
        return IdentificationVerdict.PARTLY, tuple(reasons)
    return IdentificationVerdict.DETERMINED, ()
