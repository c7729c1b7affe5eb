# SPDX-License-Identifier: MIT
"""Stiffness and damping of joints from measurements of a structure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.lumped.identified import IdentificationVerdict, JointParameter
from jointbench.analysis.structures.identification.joint_result import (
    FullCheck,
    JointSolution,
    LikelihoodProfile,
    StateFit,
    StructureIdentification,
)
from jointbench.analysis.structures.identification.multistart import find_optima
from jointbench.analysis.structures.identification.next_measurement import (
    what_separates,
    what_to_measure,
)
from jointbench.analysis.structures.identification.parameter_intervals import (
    admissible_interval,
    local_interval,
)
from jointbench.analysis.structures.identification.profile_likelihood import (
    profile_likelihood,
)
from jointbench.analysis.structures.identification.sensor_masses import (
    SensorMasses,
    is_mass,
    structure_with_masses,
)
from jointbench.analysis.structures.identification.solution_branches import (
    LARGEST_LOG_SD,
)
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    Prior,
    StiffnessProblem,
    pose_problem,
    state_at,
    values_of,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
    evidence_pairs,
    mac,
    states,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import (
    is_modulus,
    scaled_structure,
)
from jointbench.analysis.structures.reduction.full_modes import frequency_of, solve_full
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    damping_ratios,
    energy_shares,
    modal_state,
)
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    frequency_bound,
)

# The model does not fit if the probability of a larger chi2 is below this.
_POOR_FIT = 1e-3
# Largest chi2 of a fit without degrees of freedom: three sd.
_NO_FREEDOM = 9.0
# Rivals further away than this many standard deviations make a value ambiguous ...
_RIVAL_SD = 3.0
# ... if they differ by more than this in ln.
_RIVAL_LOG = 0.02
_LISTED = 12
_NAMED = 3
# Rounding of the full eigensolution, relative frequency.
_ROUNDING = 1e-7


@dataclass(frozen=True, slots=True)
class StructureSearch:
    """Settings of the search for the joints of a structure.

    Attributes:
        starts: of the search over the box of the reduction.
        seed: of the starts.
        profiles: whether to follow the likelihood of every parameter.
        masses: of sensors that are unknown as well; None is none.
    """

    starts: int = 48
    seed: int = 0
    profiles: bool = True
    masses: SensorMasses | None = None


@one_thread()
def identify_structure(
    model: ReducedModel,
    evidence: Sequence[StructureEvidence],
    *,
    known: JointValues | None = None,
    sought: Sequence[str] | None = None,
    shared: Sequence[str] = (),
    priors: Mapping[str, Prior] | None = None,
    search: StructureSearch | None = None,
    structure: Structure | None = None,
) -> StructureIdentification:
    """Find the stiffness and damping of joints.

    Args:
        model: the reduced structure.
        evidence: modes or FRFs of one or several states (torques).
        known: values of the directions that are not sought.
        sought: names ``"<joint>.<direction>"``; default all.
        shared: names common to all states.
        priors: of stiffnesses and of factors on moduli (`with_moduli`), by name.
        search: settings, and masses of sensors that are unknown; None for the
            defaults.
        structure: for a check of the optimum by one full solve; None skips it.

    Returns:
        Values with standard deviations (enlarged where chi2 shows that the given
        uncertainties are too small), every distinct solution, and what to measure next
        for parameters that are not identifiable.

    Raises:
        BadData: names do not exist, or more modes were measured than predicted.

    Source:
        Appl. Sci. 2023, 13, 11680, eq. (6), whose genetic algorithm on absolute
        frequency errors is replaced by weighted least squares from many starts.
    """
    search = search or StructureSearch()
    states(evidence)
    problem = pose_problem(
        model,
        evidence,
        known=known,
        sought=sought,
        shared=shared,
        priors=priors,
        masses=search.masses,
    )
    optima = find_optima(problem, starts=search.starts, seed=search.seed)
    best = optima[0]
    freedom = best.slopes.shape[0] - problem.size
    scale, limit = best.noise(), best.limit()
    standing = [best, *(one for one in optima[1:] if one.chi2 < limit)]
    covariance = scale * best.covariance()
    curves = profile_likelihood(problem, best, covariance, scale, search.profiles)
    parameters = tuple(
        _parameter(problem, standing, at, curves) for at in range(problem.size)
    )
    verdict, reasons = _judge(parameters, best, freedom, len(standing) > 1)
    return StructureIdentification(
        verdict=verdict,
        reasons=reasons,
        parameters=parameters,
        log_covariance=covariance,
        solutions=tuple(
            _solution(problem, one, limit) for one in _listed(optima, standing)
        ),
        profiles=curves,
        states=tuple(_state_fit(problem, best, at) for at in range(len(evidence))),
        full_check=_full_checks(structure, problem, best),
        degrees_of_freedom=freedom,
    )


def _parameter(
    problem: StiffnessProblem,
    standing: Sequence[Optimum],
    at: int,
    curves: Mapping[str, LikelihoodProfile],
) -> JointParameter:
    """Return a parameter with its uncertainty and whether it is determined."""
    best, name = standing[0], problem.names[at]
    scale = best.noise()
    value = float(np.exp(best.unknowns[at]))
    plain = is_modulus(name) or is_mass(name)
    unit = "N s/m" if problem.damping[at] else "" if plain else "N/m"
    sd = float(np.sqrt(scale * best.covariance()[at, at]))
    reason = _open_reason(problem, standing, at, sd, unit)
    if reason:
        ends = admissible_interval(problem, standing, at, scale)
        return JointParameter(name, value, None, unit, False, reason, ends)
    curve = curves.get(name)
    own = local_interval(best, at, scale) if curve is None else (curve.low, curve.high)
    return JointParameter(name, value, value * sd, unit, True, "", own)


def _open_reason(
    problem: StiffnessProblem,
    standing: Sequence[Optimum],
    at: int,
    sd: float,
    unit: str,
) -> str:
    """Return why a parameter is not identifiable; empty if it is."""
    best, rivals = standing[0], standing[1:]
    if not sd < LARGEST_LOG_SD:
        return (
            "not identifiable: its standard deviation exceeds 100 %; "
            + what_to_measure(problem, best, at)
        )
    limit = max(_RIVAL_LOG, _RIVAL_SD * sd)
    others = [
        one for one in rivals if abs(one.unknowns[at] - best.unknowns[at]) > limit
    ]
    if not others:
        return ""
    logs = [float(one.unknowns[at]) for one in (best, *others)]
    return (
        f"not identifiable: {_listing(np.exp(np.sort(logs)), unit)} fit equally well; "
        + what_separates(problem, best, others[0])
    )


def _listed(
    optima: Sequence[Optimum], standing: Sequence[Optimum]
) -> tuple[Optimum, ...]:
    """Return the solutions to list: the best ones, and the extremes of each unknown."""
    value = np.array([one.unknowns for one in standing])
    wanted = {*range(_LISTED), *value.argmin(axis=0), *value.argmax(axis=0)}
    # The admissible ones come first.
    return tuple(one for at, one in enumerate(optima) if at in wanted)


def _listing(values: FloatArray, unit: str) -> str:
    """List a few values, or give their number and range."""
    if values.size <= _NAMED:
        return " or ".join(f"{one:.3g}" for one in values) + f" {unit}"
    return f"{values.size} values from {values[0]:.3g} to {values[-1]:.3g} {unit}"


def _judge(
    parameters: Sequence[JointParameter], best: Optimum, freedom: int, rivals: bool
) -> tuple[IdentificationVerdict, tuple[str, ...]]:
    """Return the verdict on the identification, and its reasons."""
    reasons = [f"{one.name}: {one.reason}" for one in parameters if one.reason]
    limit = chi2_limit(_POOR_FIT, freedom) if freedom > 0 else _NO_FREEDOM
    if best.chi2 > limit:
        line = (
            f"chi2 is {best.chi2:.3g} for {freedom} degrees of freedom: no joint "
            "explains the measurement within its uncertainty; check material, masses, "
            "supports and the pairing of modes"
        )
        return IdentificationVerdict.INCONSISTENT, (line, *reasons)
    open_ones = sum(not one.identifiable for one in parameters)
    if not open_ones:
        return IdentificationVerdict.DETERMINED, ()
    if open_ones == len(parameters):
        word = (
            IdentificationVerdict.AMBIGUOUS
            if rivals
            else IdentificationVerdict.UNDETERMINED
        )
        return word, tuple(reasons)
    return IdentificationVerdict.PARTLY, tuple(reasons)


def _solution(
    problem: StiffnessProblem, optimum: Optimum, limit: float
) -> JointSolution:
    values = np.exp(optimum.unknowns).tolist()
    named = dict(zip(problem.names, values, strict=True))
    return JointSolution(named, optimum.chi2, optimum.chi2 < limit)


def _state_fit(problem: StiffnessProblem, best: Optimum, row: int) -> StateFit:
    """Return measured and predicted modes of one state."""
    model, evidence = state_at(problem, best.unknowns, row)
    values = values_of(problem, best.unknowns, row)
    state = modal_state(model, values.stiffness)
    elastic = np.arange(state.rigid, model.modes)
    measured, likeness, chosen = np.zeros(0), np.zeros(0), elastic
    if evidence.modes is not None:
        measured = evidence.modes.natural_frequency
        chosen = evidence_pairs(state, elastic, evidence)
        if evidence.modes.shapes is not None:
            shapes = (evidence.outputs @ state.shapes[:, chosen]).T.astype(complex)
            likeness = np.diag(mac(evidence.modes.shapes, shapes))
    return StateFit(
        evidence.label,
        measured,
        frequency_of(state.eigenvalue[chosen]),
        damping_ratios(state, values.damping)[chosen],
        likeness,
        energy_shares(state, values.stiffness)[chosen],
        values.stiffness,
    )


def _full_checks(
    structure: Structure | None, problem: StiffnessProblem, best: Optimum
) -> tuple[FullCheck, ...]:
    """Solve the optimum of every state once with the whole mesh, if there is one."""
    if structure is None:
        return ()
    checks = []
    if problem.masses is not None:
        factors = np.exp(best.unknowns[-len(problem.masses.names) :]).tolist()
        structure = structure_with_masses(structure, problem.masses, factors)
    for row, evidence in enumerate(problem.evidence):
        stiffness = values_of(problem, best.unknowns, row).stiffness
        model, _ = state_at(problem, best.unknowns, row)
        reduced, bound = frequency_bound(model, stiffness)
        named = dict(zip(problem.model.names, stiffness.tolist(), strict=True))
        joints = np.array([v for name, v in named.items() if not is_modulus(name)])
        moduli = {n.rpartition(".")[0]: v for n, v in named.items() if is_modulus(n)}
        whole_mesh = scaled_structure(structure, moduli) if moduli else structure
        full = solve_full(whole_mesh, joints, problem.model.modes)
        elastic = (reduced > 0) & (full.natural_frequency > 0)
        reduced, bound = reduced[elastic], bound[elastic]
        whole = full.natural_frequency[elastic]
        agrees = bool(np.all(np.abs(reduced - whole) <= bound + _ROUNDING * whole))
        checks.append(FullCheck(evidence.label, reduced, whole, bound, agrees))
    return tuple(checks)
