# SPDX-License-Identifier: MIT
"""Propose a measurement that would identify an undetermined parameter."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.identification.sensor_masses import is_mass
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    StiffnessProblem,
    values_of,
)
from jointbench.analysis.structures.reduction.predict_modes import (
    damping_ratios,
    modal_state,
)

# Usual uncertainty of a hammer test: frequency 0.2 %, damping ratio 5 % of its value.
_FREQUENCY_SD = 0.002
_DAMPING_SD = 0.05
# A measurement helps if it brings the standard deviation below this in ln.
_HELPS = 0.5
# Least relative difference of distinguishable frequencies of two solutions.
_DISTINGUISHABLE = 0.003


def what_to_measure(problem: StiffnessProblem, best: Optimum, at: int) -> str:
    """Name the mode whose frequency or damping would determine a parameter best.

    Args:
        problem: of the identification.
        best: solution.
        at: number of the undetermined parameter.

    Returns:
        One clause on what to measure and the resulting uncertainty.
    """
    if is_mass(problem.names[at]):
        return "weigh the sensor"
    row = int(np.flatnonzero(np.any(problem.columns == at, axis=1))[0])
    state = modal_state(problem.model, values_of(problem, best.unknowns, row).stiffness)
    values = values_of(problem, best.unknowns, row)
    frequency = np.sqrt(np.maximum(state.eigenvalue, 0.0)) / (2 * np.pi)
    information = best.slopes.T @ best.slopes
    options = []
    for number in range(state.rigid, problem.model.modes):
        slope = _frequency_slope(problem, row, number, best)
        text = f"mode {number - state.rigid + 1} near {frequency[number]:.0f} Hz"
        if problem.damping[at]:
            slope = _damping_slope(problem, row, number, best)
            text = f"the damping ratio of {text}"
        else:
            text = f"the frequency of {text}"
        options.append((_sd_with(information, slope, at), text))
    sd, text = min(options)
    if sd < _HELPS:
        return f"measure {text}: that would bring it to {100 * sd:.2g} %"
    ratio = damping_ratios(state, values.damping)[state.rigid : problem.model.modes]
    if problem.damping[at] and ratio.max() > 0:
        return "measure FRFs with damping, at sensors on both sides of the joint"
    return (
        "no single mode determines it; measure FRFs or mode shapes at sensors on both "
        "sides of "
        f"the joint, up to {frequency[problem.model.modes - 1]:.0f} Hz"
    )


def what_separates(problem: StiffnessProblem, best: Optimum, rival: Optimum) -> str:
    """Name the mode whose frequency differs most between two solutions.

    Args:
        problem: of the identification.
        best: solution.
        rival: another one that fits equally well.

    Returns:
        One clause on what to measure.
    """
    found = []
    for row in range(len(problem.evidence)):
        both = [
            modal_state(problem.model, values_of(problem, one.unknowns, row).stiffness)
            for one in (best, rival)
        ]
        rigid = max(state.rigid for state in both)
        level = [state.eigenvalue[rigid : problem.model.modes] for state in both]
        ratio = np.exp(0.5 * np.abs(np.log(level[0] / level[1]))) - 1.0
        at = int(np.argmax(ratio))
        frequency = [np.sqrt(one[at]) / (2 * np.pi) for one in level]
        found.append((float(ratio[at]), at + 1, frequency))
    ratio_of, number, (first, second) = max(found)
    if ratio_of < _DISTINGUISHABLE:
        return "no frequency separates them; measure FRFs or mode shapes on both sides"
    return f"mode {number} separates them: {first:.0f} Hz or {second:.0f} Hz"


def _sd_with(information: FloatArray, slope: FloatArray, at: int) -> float:
    """Return the standard deviation in ln after one more row."""
    whole = information + np.outer(slope, slope)
    # Scaled, so that undetermined unknowns do not spoil the determined ones.
    # Relative to the largest, or rounding could leave the matrix singular.
    size = max(1.0, float(np.trace(whole)))
    whole = whole + 1e-12 * size * np.eye(whole.shape[0])
    return float(np.sqrt(np.linalg.inv(whole)[at, at]))


def _frequency_slope(
    problem: StiffnessProblem, row: int, number: int, best: Optimum
) -> FloatArray:
    values = values_of(problem, best.unknowns, row)
    state = modal_state(problem.model, values.stiffness)
    count = values.stiffness.size
    share = values.stiffness * state.flex[:, number, number] / state.eigenvalue[number]
    return _placed(problem, row, np.concatenate([0.5 * share, np.zeros(count)])) / (
        _FREQUENCY_SD
    )


def _damping_slope(
    problem: StiffnessProblem, row: int, number: int, best: Optimum
) -> FloatArray:
    values = values_of(problem, best.unknowns, row)
    state = modal_state(problem.model, values.stiffness)
    part = values.damping * state.flex[:, number, number]
    whole = float(part.sum())
    share = part / whole if whole > 0 else part
    return _placed(problem, row, np.concatenate([np.zeros(part.size), share])) / (
        _DAMPING_SD
    )


def _placed(problem: StiffnessProblem, row: int, slope: FloatArray) -> FloatArray:
    whole = np.zeros(problem.size)
    columns = problem.columns[row]
    np.add.at(whole, columns[columns >= 0], slope[columns >= 0])
    return whole
