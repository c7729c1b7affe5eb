# SPDX-License-Identifier: MIT
"""Hypotheses in words."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.identification.hypotheses import (
    HypothesisKind,
    StructureHypothesis,
)
from jointbench.analysis.structures.identification.stiffness_problem import (
    StiffnessProblem,
    values_of,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    evidence_pairs,
)
from jointbench.analysis.structures.reduction.full_modes import frequency_of
from jointbench.analysis.structures.reduction.predict_modes import (
    ModalState,
    modal_state,
)


def hypothesis_text(
    one: StructureHypothesis, problem: StiffnessProblem, unknowns: FloatArray
) -> str:
    """Describe a hypothesis by what its best solution makes of it.

    Args:
        one: the hypothesis.
        problem: of its search.
        unknowns: logarithms at its best end, shape (n_unknowns,).

    Returns:
        One clause, with frequencies in Hz.
    """
    modes = one.evidence.modes
    if one.kind in (HypothesisKind.MODULUS, HypothesisKind.SUPPORT):
        body, _, what = one.freed.rpartition(".")
        factor = float(np.exp(unknowns[problem.names.index(one.freed)]))
        what = "modulus" if what == "modulus" else "supports"
        return f"{what} of {body} {factor:.3g} times as stiff as stated"
    if modes is None:
        return "model and FRFs as stated"
    state = modal_state(problem.model, values_of(problem, unknowns, 0).stiffness)
    if one.kind is HypothesisKind.MISSING:
        return f"{_model_mode(state, one.modes[0])} was not measured"
    measured = modes.natural_frequency
    if one.kind is HypothesisKind.SWAPPED:
        first, second = measured[list(one.modes)]
        return f"the modes at {first:.5g} and {second:.5g} Hz exchanged"
    if one.kind is HypothesisKind.SPURIOUS:
        return f"the mode at {one.left_out:.5g} Hz is none of the structure"
    candidates = np.arange(state.rigid, problem.model.modes)
    pairs = evidence_pairs(state, candidates, one.evidence) - state.rigid
    left = sorted(set(range(int(pairs.max()) + 1)) - set(pairs.tolist()))
    if not left:
        return "modes as measured"
    without = ", ".join(_model_mode(state, at) for at in left)
    return f"modes as measured, by their shapes; {without} has no partner"


def _model_mode(state: ModalState, at: int) -> str:
    """Name an elastic mode of the model."""
    frequency = float(
        frequency_of(state.eigenvalue[state.rigid + at : state.rigid + at + 1])[0]
    )
    return f"mode {at + 1} of the model, near {frequency:.5g} Hz,"
