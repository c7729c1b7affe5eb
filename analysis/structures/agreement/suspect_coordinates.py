# SPDX-License-Identifier: MIT
"""Outputs and hit points whose sign, label or direction is suspected to be wrong.

Measured modal constants phi_o phi_i have signs and sizes. Each alternative - a sign
turned, two labels exchanged, another axis - is tried on the computed ones; the best is
taken while the residual falls by more than chance.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.tail_probabilities import chi2_limit

# Relative error of a modal constant that is no fault of a label: sensitivity of two
# sensors, aim and small differences of the model.
_FLOOR = 0.1
# Probability of a false suspicion: dof ln(chi2 / chi2) of all alternatives is below
# this quantile of chi-squared with one degree of freedom, times their number.
_FALSE = 1e-3
# Residual of an alternative over that of the labels as given, at most.
_FALLS = 0.6
_MOST = 4


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
class Coordinates:
    """Computed shapes of paired modes at all places and axes.

    Attributes:
        outputs: shapes at the outputs, shape (n_pairs, n_outputs).
        inputs: shapes at the hit points, shape (n_pairs, n_inputs).
        axes: shapes at the outputs along x, y, z, shape (n_pairs, n_outputs, 3).
        along: axis that each output measures mostly, shape (n_outputs,).
        names: of the outputs and of the hit points.
    """

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


def find_suspects(
    measured: FloatArray, deviation: FloatArray, computed: Coordinates
) -> tuple[Suspect, ...]:
    """Find coordinates whose sign, label or axis explains the measurement better.

    Args:
        measured: modal constants of paired modes [1/kg], shape (n_pairs, n_outputs,
            n_inputs).
        deviation: their standard deviations, same shape.
        computed: shapes at the same coordinates.

    Returns:
        Suspects, the largest gain first; none where the labels as given fit.
    """
    largest = np.abs(measured).max(axis=(1, 2), keepdims=True)
    weight = 1.0 / np.hypot(deviation, _FLOOR * largest)
    freedom = max(measured.size - measured.shape[0], 1)
    found: list[Suspect] = []
    now = _Trial("", (), "", computed.outputs, computed.inputs)
    chi2 = _chi2(measured, weight, now)
    touched: set[str] = set()
    while len(found) < _MOST:
        trials = [one for one in _trials(computed, now) if not touched & set(one.names)]
        if not trials:
            break
        values = np.array([_chi2(measured, weight, one) for one in trials])
        best = int(np.argmin(values))
        gain = freedom * np.log(max(chi2, 1e-300) / max(values[best], 1e-300))
        limit = chi2_limit(_FALSE / len(trials), 1)
        if gain < limit or values[best] > _FALLS * chi2:
            break
        close = freedom * np.log(np.maximum(values, 1e-300) / values[best]) < limit
        equal = [trials[k].text for k in np.flatnonzero(close) if k != best]
        size = float(np.sum((measured * weight) ** 2))
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


def _chi2(measured: FloatArray, weight: FloatArray, trial: _Trial) -> float:
    """Return the weighted squares of what is left after a positive scale per mode."""
    constants = trial.outputs[:, :, None] * trial.inputs[:, None, :]
    wanted, own = measured * weight, constants * weight
    scale = np.sum(wanted * own, axis=(1, 2))
    scale = scale / np.maximum(np.sum(own**2, axis=(1, 2)), 1e-300)
    left = wanted - np.maximum(scale, 0.0)[:, None, None] * own
    return float(np.sum(left**2))


def _trials(computed: Coordinates, now: _Trial) -> Iterator[_Trial]:
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
