# SPDX-License-Identifier: MIT
"""Outputs and hit points whose sign, label or direction is suspected to be wrong.

Measured modal constants phi_o phi_i have signs and sizes. Each alternative - a sign
turned, two labels exchanged, another axis - is tried on the computed ones; the best is
taken while the residual falls by more than chance.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.structures.agreement.paired_modes import ModeSet

# Relative error of a modal constant that is no fault of a label: sensitivity of two
# sensors, aim and small differences of the model.
_FLOOR = 0.1
# Probability of a false suspicion: dof ln(chi2 / chi2) of all alternatives is below
# this quantile of chi-squared with one degree of freedom, times their number.
_FALSE = 1e-3
# Residual of an alternative over that of the labels as given, at most.
_FALLS = 0.6
_MOST = 4
# Relative frequency error of a model whose joints were identified; modes are paired
# again for each alternative, because a wrong sign also spoils the MAC ...
_FREQUENCY_SD = 0.03
# ... but not beyond this distance in ln.
_FARTHEST = 0.3


@dataclass(frozen=True, slots=True)
class Suspect:
    """A coordinate that is suspected.

    Attributes:
        text: what is suspected, with its names.
        kind: ``sign``, ``exchange`` or ``axis``.
        names: of the outputs or hit points.
        residual_before: rms difference of modal constants over their size [-].
        residual_after: with the alternative [-].
        equal: other alternatives that explain it equally well.
    """

    text: str
    kind: str
    names: tuple[str, ...]
    residual_before: float
    residual_after: float
    equal: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class ShapesAtPlaces:
    """Computed shapes at all places and axes.

    Attributes:
        frequency: of the modes [Hz], shape (n_modes,).
        outputs: shapes at the outputs, shape (n_modes, n_outputs).
        inputs: shapes at the hit points, shape (n_modes, n_inputs).
        axes: shapes at the outputs along x, y, z, shape (n_modes, n_outputs, 3).
        along: axis that each output measures mostly, shape (n_outputs,).
        names: of the outputs and of the hit points.
    """

    frequency: FloatArray
    outputs: FloatArray
    inputs: FloatArray
    axes: FloatArray
    along: IntArray
    names: tuple[tuple[str, ...], tuple[str, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class _Trial:
    kind: str
    names: tuple[str, ...]
    text: str
    outputs: FloatArray
    inputs: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Evidence:
    """Weighted modal constants, their weights, and the cost of distant pairs."""

    wanted: FloatArray
    weight: FloatArray
    apart: FloatArray


def find_suspects(measured: ModeSet, computed: ShapesAtPlaces) -> tuple[Suspect, ...]:
    """Find coordinates whose sign, label or axis explains the measurement better.

    Args:
        measured: modes with their modal constants.
        computed: shapes at the same coordinates.

    Returns:
        Suspects, the largest gain first; none where the labels as given fit.
    """
    evidence = _evidence(measured, computed)
    count = measured.frequency.size
    freedom = max(evidence.wanted.size - count, 1)
    found: list[Suspect] = []
    now = _Trial("", (), "", computed.outputs, computed.inputs)
    chi2 = _chi2(evidence, now)
    touched: set[str] = set()
    while len(found) < _MOST:
        trials = [one for one in _trials(computed, now) if not touched & set(one.names)]
        if not trials:
            break
        values = np.array([_chi2(evidence, one) for one in trials])
        best = int(np.argmin(values))
        gain = freedom * np.log(max(chi2, 1e-300) / max(values[best], 1e-300))
        limit = chi2_limit(_FALSE / len(trials), 1)
        if gain < limit or values[best] > _FALLS * chi2:
            break
        close = freedom * np.log(np.maximum(values, 1e-300) / values[best]) < limit
        equal = [trials[k].text for k in np.flatnonzero(close) if k != best]
        size = float(np.sum(evidence.wanted**2))
        found.append(
            Suspect(
                trials[best].text,
                trials[best].kind,
                trials[best].names,
                float(np.sqrt(chi2 / size)),
                float(np.sqrt(values[best] / size)),
                tuple(equal),
            )
        )
        touched |= set(trials[best].names)
        now, chi2 = trials[best], float(values[best])
    return tuple(found)


def _evidence(measured: ModeSet, computed: ShapesAtPlaces) -> _Evidence:
    constants = measured.constants
    largest = np.abs(constants).max(axis=(1, 2), keepdims=True)
    weight = 1.0 / np.hypot(measured.constants_sd, _FLOOR * largest)
    apart = np.log(measured.frequency[:, None] / computed.frequency)
    cost = np.where(np.abs(apart) < _FARTHEST, (apart / _FREQUENCY_SD) ** 2, np.inf)
    return _Evidence(constants * weight, weight, cost)


def _chi2(evidence: _Evidence, trial: _Trial) -> float:
    """Return the weighted squares of what the best pairs leave.

    Each pair has a positive scale; a measured mode without a partner is left whole.
    """
    constants = trial.outputs[:, :, None] * trial.inputs[:, None, :]
    wanted, weight = evidence.wanted, evidence.weight
    crossed = np.einsum("moi,moi,coi->mc", wanted, weight, constants)
    size = np.einsum("moi,coi->mc", weight**2, constants**2)
    whole = np.sum(wanted**2, axis=(1, 2))[:, None]
    left = whole - np.maximum(crossed, 0.0) ** 2 / np.maximum(size, 1e-300)
    cost = np.minimum(left + evidence.apart, whole)
    rows, columns = linear_sum_assignment(cost)
    missing = np.setdiff1d(np.arange(wanted.shape[0]), rows)
    return float(cost[rows, columns].sum() + whole[missing].sum())


def _trials(computed: ShapesAtPlaces, now: _Trial) -> Iterator[_Trial]:
    outputs, inputs = computed.names
    for at, name in enumerate(outputs):
        yield _Trial(
            "sign",
            (name,),
            f"output {name} has the wrong sign",
            _turned(now.outputs, at),
            now.inputs,
        )
    for at, name in enumerate(inputs):
        yield _Trial(
            "sign",
            (f"hit {name}",),
            f"hit {name} has the wrong sign",
            now.outputs,
            _turned(now.inputs, at),
        )
    yield from _exchanges(outputs, inputs, now)
    for at, name in enumerate(outputs):
        for axis in {0, 1, 2} - {int(computed.along[at])}:
            for sign in (1.0, -1.0):
                shapes = now.outputs.copy()
                shapes[:, at] = sign * computed.axes[:, at, axis]
                word = f"{'-' if sign < 0 else ''}{'xyz'[axis]}"
                text = f"output {name} measures along {word}"
                yield _Trial("axis", (name,), text, shapes, now.inputs)


def _exchanges(
    outputs: Sequence[str], inputs: Sequence[str], now: _Trial
) -> Iterator[_Trial]:
    for i in range(len(outputs)):
        for j in range(i):
            pair = (outputs[j], outputs[i])
            text = f"outputs {pair[0]} and {pair[1]} are exchanged"
            shapes = _exchanged(now.outputs, i, j)
            yield _Trial("exchange", pair, text, shapes, now.inputs)
    for i in range(len(inputs)):
        for j in range(i):
            pair = (f"hit {inputs[j]}", f"hit {inputs[i]}")
            text = f"hits {inputs[j]} and {inputs[i]} are exchanged"
            shapes = _exchanged(now.inputs, i, j)
            yield _Trial("exchange", pair, text, now.outputs, shapes)


def _turned(shapes: FloatArray, at: int) -> FloatArray:
    found = shapes.copy()
    found[:, at] *= -1.0
    return found


def _exchanged(shapes: FloatArray, i: int, j: int) -> FloatArray:
    order = np.arange(shapes.shape[1])
    order[[i, j]] = j, i
    return np.asarray(shapes[:, order])
