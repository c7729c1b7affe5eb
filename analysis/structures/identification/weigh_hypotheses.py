# SPDX-License-Identifier: MIT
"""Try the hypotheses about a measurement, price them, and list those that survive."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import IntArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.lumped.identified import JointParameter
from jointbench.analysis.structures.identification.hypotheses import (
    HypothesisKind,
    HypothesisSettings,
    StructureHypothesis,
    hypotheses_of,
)
from jointbench.analysis.structures.identification.hypothesis_evidence import (
    WeighedEnd,
)
from jointbench.analysis.structures.identification.hypothesis_search import (
    POOR_FIT,
    HypothesisSearch,
    log_weights,
    posed,
)
from jointbench.analysis.structures.identification.hypothesis_text import (
    hypothesis_text,
)
from jointbench.analysis.structures.identification.mixed_parameters import (
    mixed_parameters,
)
from jointbench.analysis.structures.identification.stiffness_problem import (
    Prior,
    StiffnessProblem,
    values_of,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
    evidence_pairs,
)
from jointbench.analysis.structures.identification.surveyed_starts import (
    survey_starts,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    modal_state,
)
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel


@dataclass(frozen=True, slots=True, eq=False)
class WeighedHypothesis:
    """A hypothesis after its own search.

    Attributes:
        kind: what it changes.
        text: the hypothesis in one line.
        probability: after the measurement, among all that were tried [-].
        survives: whether it is too probable to be left out.
        chi2: of its best solution [-].
        rows: number of measured numbers and priors in it.
        parameters: stiffness and damping under it.
    """

    kind: HypothesisKind
    text: str
    probability: float
    survives: bool
    chi2: float
    rows: int
    parameters: tuple[JointParameter, ...]


@dataclass(frozen=True, slots=True, eq=False)
class StateHypotheses:
    """All hypotheses about one state, the most probable first.

    Attributes:
        state: its label.
        hypotheses: that were tried.
        parameters: over all of them, each with its probability.
        fits: whether one of them explains the measurement, with the noise factor at
            its largest. If none does, probabilities only order what is wrong.
    """

    state: str
    hypotheses: tuple[WeighedHypothesis, ...]
    parameters: tuple[JointParameter, ...]
    fits: bool

    @property
    def surviving(self) -> tuple[WeighedHypothesis, ...]:
        """Those too probable to be left out, the most probable first."""
        return tuple(one for one in self.hypotheses if one.survives)


@one_thread()
def weigh_hypotheses(
    model: ReducedModel,
    evidence: Sequence[StructureEvidence],
    *,
    known: JointValues | None = None,
    sought: Sequence[str] | None = None,
    priors: Mapping[str, Prior] | None = None,
    structure: Structure | None = None,
    start: Mapping[str, float] | None = None,
    settings: HypothesisSettings | None = None,
) -> tuple[StateHypotheses, ...]:
    """Try what else could explain each state by itself, and price it.

    Args:
        model: the reduced structure.
        evidence: modes or FRFs of one or several states; each is weighed alone.
        known: values of the directions that are not sought.
        sought: names ``"<joint>.<direction>"``; default all.
        priors: of stiffnesses and of factors on moduli, by name.
        structure: on its meshes, for hypotheses about supports; None leaves them out.
        start: values of the solution as measured by name, as in
            `JointSolution.parameters`, where each search begins as well.
        settings: None for the defaults.

    Returns:
        For each state its hypotheses with probabilities, and parameters over all.

    Raises:
        BadData: names do not exist, or more modes were measured than predicted.

    Source:
        Kass and Raftery 1995, J. Am. Stat. Assoc. 90, 773-795 (evidence); Hoeting et
        al. 1999, Stat. Sci. 14, 382-417 (parameters over several models).
    """
    settings = settings or HypothesisSettings()
    found = []
    for one in evidence:
        base = StructureHypothesis(
            HypothesisKind.AS_MEASURED, 1.0, model, one, dict(priors or {})
        )
        plain = posed(base, known, sought)
        surveyed = survey_starts(plain, settings.surveyed, settings.seed)
        search = HypothesisSearch(
            known, sought, _named(start or {}, one.label), surveyed, settings
        )
        first = search.ends(base)
        paired, predicted = _paired(*first, one)
        cases = hypotheses_of(
            model, one, paired, base.priors, settings, structure, predicted
        )
        tried = [first, *(search.ends(case) for case in cases[1:])]
        tried = search.further(cases, tried)
        found.append(_weighed(one.label, cases, tried, settings))
    return tuple(found)


def _named(start: Mapping[str, float], label: str) -> dict[str, float]:
    """Return the values of one state by plain names."""
    own = {name.removeprefix(f"{label}:"): value for name, value in start.items()}
    return {name: value for name, value in own.items() if ":" not in name}


def _paired(
    problem: StiffnessProblem, ends: Sequence[WeighedEnd], evidence: StructureEvidence
) -> tuple[IntArray, int]:
    """Return the elastic predicted mode of each measured one, and their number.

    Both are those of the best end.
    """
    if evidence.modes is None:
        return np.zeros(0, np.int64), 0
    best = max(ends, key=lambda one: one.log_evidence)
    values = values_of(problem, best.end.unknowns, 0)
    state = modal_state(problem.model, values.stiffness)
    candidates = np.arange(state.rigid, problem.model.modes)
    pairs = evidence_pairs(state, candidates, evidence) - state.rigid
    return np.asarray(pairs), int(candidates.size)


def _weighed(
    label: str,
    cases: Sequence[StructureHypothesis],
    tried: Sequence[tuple[StiffnessProblem, list[WeighedEnd]]],
    settings: HypothesisSettings,
) -> StateHypotheses:
    """Turn evidence into probabilities, and mix the parameters."""
    logs = [
        log_weights(case, ends) for case, (_, ends) in zip(cases, tried, strict=True)
    ]
    top = max(float(one.max()) for one in logs)
    weights = [np.exp(one - top) for one in logs]
    total = sum(float(one.sum()) for one in weights)
    found, parts = [], []
    for case, (problem, ends), log, weight in zip(
        cases, tried, logs, weights, strict=True
    ):
        share = weight / total
        parts += [(one, problem, end) for one, end in zip(share, ends, strict=True)]
        own = np.exp(log - log.max())
        best = ends[int(np.argmax(own))]
        found.append(
            WeighedHypothesis(
                case.kind,
                hypothesis_text(case, problem, best.end.unknowns),
                float(share.sum()),
                bool(share.sum() >= settings.survives),
                best.end.chi2,
                best.end.slopes.shape[0],
                mixed_parameters(
                    [(one, problem, end) for one, end in zip(own, ends, strict=True)]
                ),
            )
        )
    names = tried[0][0].names
    found.sort(key=lambda one: -one.probability)
    allowed = settings.largest_noise**2
    fits = any(
        one.chi2 <= allowed * chi2_limit(POOR_FIT, one.rows)
        for one in found
        if one.survives
    )
    return StateHypotheses(label, tuple(found), mixed_parameters(parts, names), fits)
