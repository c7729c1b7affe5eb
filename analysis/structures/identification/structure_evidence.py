# SPDX-License-Identifier: MIT
"""Measurements of a structure, and their residual for a set of joint values."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.frf_gains import (
    EXACT,
    FrfGains,
    without_gains,
)
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    ModalState,
    damping_ratios,
    modal_state,
)
from jointbench.analysis.structures.reduction.predict_response import predict_frf
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    solve_reduced,
)
from jointbench.signal.frf.frf import Frf

# Modes closer than this, relative in lambda, mix: their shapes have no derivative.
_CLOSEST = 1e-6
# Weight of ln frequency against the MAC of a pair.
_FREQUENCY_WEIGHT = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class StructureEvidence:
    """Measurements of one structure in one state, for example at one torque.

    Attributes:
        label: of the state.
        modes: frequencies, damping and shapes, or None.
        frf: FRFs with their variance, or None.
        outputs: rows of `readout` for the sensors of `modes` and `frf`, shape
            (n_outputs, r).
        inputs: rows of `readout` for the hit points of `frf`, shape (n_inputs, r).
        pairing: number of the elastic predicted mode of each measured one, from 0,
            shape (n_modes,); None pairs by MAC or by order.
        gains: what is known of the scale of `frf`; exact by default.
    """

    label: str
    modes: MeasuredModes | None
    frf: Frf | None
    outputs: FloatArray
    inputs: FloatArray
    pairing: IntArray | None = None
    gains: FrfGains = EXACT

    def __post_init__(self) -> None:
        """Check that there are measurements, with their uncertainty."""
        if self.modes is None and self.frf is None:
            raise BadData(f"state {self.label!r} holds neither modes nor FRFs")
        if self.frf is not None and self.frf.variance is None:
            raise BadData(
                f"the FRFs of {self.label!r} carry no variance; average several hits, "
                "or give their noise"
            )
        if self.frf is not None and np.any(np.asarray(self.frf.variance) <= 0):
            raise BadData(f"a variance of the FRFs of {self.label!r} is not above zero")
        freeze(self, "outputs", "inputs", "pairing")

    @property
    def damped(self) -> bool:
        """Whether the measurement contains damping."""
        return self.frf is not None or (
            self.modes is not None and self.modes.damping_ratio is not None
        )


def evidence_residual(
    model: ReducedModel, evidence: StructureEvidence, values: JointValues
) -> tuple[FloatArray, FloatArray]:
    """Compare prediction and measurement.

    Args:
        model: the reduced structure.
        evidence: measurements.
        values: of its joints.

    Returns:
        Differences over their standard deviations, shape (n_rows,), and derivatives by
        ln stiffness and ln damping, shape (n_rows, 2 n_parameters).
    """
    blocks = []
    if evidence.modes is not None:
        blocks.append(_modal_rows(model, evidence, evidence.modes, values))
    if evidence.frf is not None:
        blocks.append(_frf_rows(model, evidence, evidence.frf, values))
    rows, slopes = zip(*blocks, strict=True)
    return np.concatenate(rows), np.concatenate(slopes)


def pair_modes(
    state: ModalState, candidates: IntArray, measured: MeasuredModes, rows: FloatArray
) -> IntArray:
    """Assign a predicted mode to each measured one.

    Args:
        state: predicted modes.
        candidates: numbers of the elastic ones among them.
        measured: modes; by MAC where they have shapes, else by order of frequency.
        rows: of the sensors.

    Returns:
        Numbers of modes, shape (n_measured,).

    Raises:
        BadData: there are more measured modes than predicted ones.

    Source:
        Allemang and Brown 1982, Proc. 1st IMAC, 110-116 (MAC).
    """
    count = measured.natural_frequency.size
    _require_enough(count, candidates.size)
    if measured.shapes is None or rows.shape[0] < 2:
        return candidates[:count]
    shapes = rows @ state.shapes[:, candidates]
    likeness = mac(measured.shapes, shapes.T.astype(complex))
    frequency = np.sqrt(np.maximum(state.eigenvalue[candidates], 0.0)) / (2 * np.pi)
    apart = np.log(measured.natural_frequency[:, None] / frequency)
    cost = 1.0 - likeness + _FREQUENCY_WEIGHT * np.minimum(np.abs(apart), 2.0)
    return np.asarray(candidates[linear_sum_assignment(cost)[1]])


def evidence_pairs(
    state: ModalState, candidates: IntArray, evidence: StructureEvidence
) -> IntArray:
    """Return the predicted mode of each measured one: as given, or by `pair_modes`.

    Raises:
        BadData: there are more measured modes than predicted ones, or none at all.
    """
    if evidence.modes is None:
        raise BadData(f"state {evidence.label!r} has no modes to pair")
    if evidence.pairing is not None:
        return np.asarray(candidates[evidence.pairing])
    return pair_modes(state, candidates, evidence.modes, evidence.outputs)


def _require_enough(measured: int, predicted: int) -> None:
    if measured > predicted:
        raise BadData(
            f"{measured} modes were measured, the reduced model predicts {predicted} "
            "elastic ones; reduce for more modes"
        )


def mac(first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Return the modal assurance criterion between two sets of shapes.

    Args:
        first: shape (n, n_outputs).
        second: shape (m, n_outputs).

    Returns:
        0 to 1, shape (n, m) [-].
    """
    crossed = np.abs(first.conj() @ second.T) ** 2
    size = np.sum(np.abs(first) ** 2, axis=1)[:, None]
    other = np.sum(np.abs(second) ** 2, axis=1)
    return np.asarray(crossed / np.maximum(size * other, 1e-300))


def _modal_rows(
    model: ReducedModel,
    evidence: StructureEvidence,
    measured: MeasuredModes,
    values: JointValues,
) -> tuple[FloatArray, FloatArray]:
    with_shapes = measured.shapes is not None and evidence.outputs.shape[0] > 1
    if measured.damping_ratio is None and not with_shapes:
        return _frequencies_alone(model, evidence, measured, values)
    state = modal_state(model, values.stiffness)
    candidates = np.arange(state.rigid, model.modes)
    pairs = evidence_pairs(state, candidates, evidence)
    change = _shape_changes(state, values.stiffness, pairs)
    blocks = [_frequency_rows(state, measured, values, pairs)]
    if measured.damping_ratio is not None and measured.damping_ratio_sd is not None:
        blocks.append(_damping_rows(state, measured, values, pairs, change))
    if with_shapes:
        blocks.append(_shape_rows(state, measured, evidence.outputs, pairs, change))
    rows, slopes = zip(*blocks, strict=True)
    return np.concatenate(rows), np.concatenate(slopes)


def _frequencies_alone(
    model: ReducedModel,
    evidence: StructureEvidence,
    measured: MeasuredModes,
    values: JointValues,
) -> tuple[FloatArray, FloatArray]:
    """Compare frequencies by the lowest modes alone, which is several times faster."""
    found = solve_reduced(model, values.stiffness)
    elastic = np.arange(found.rigid, found.eigenvalue.size)
    count = measured.natural_frequency.size
    _require_enough(count, elastic.size)
    chosen = elastic[:count] if evidence.pairing is None else elastic[evidence.pairing]
    flex = model.spread.diagonal(found.shapes[:, chosen])
    level = found.eigenvalue[chosen]
    return _log_rows(level, flex.T, measured, values)


def _frequency_rows(
    state: ModalState, measured: MeasuredModes, values: JointValues, pairs: IntArray
) -> tuple[FloatArray, FloatArray]:
    flex = state.flex[:, pairs, pairs].T
    return _log_rows(state.eigenvalue[pairs], flex, measured, values)


def _log_rows(
    level: FloatArray, flex: FloatArray, measured: MeasuredModes, values: JointValues
) -> tuple[FloatArray, FloatArray]:
    """Compare logarithms of frequencies; flex has shape (n_modes, n_parameters)."""
    weight = measured.natural_frequency / measured.frequency_sd
    ratio = np.sqrt(level) / (2 * np.pi * measured.natural_frequency)
    slope = 0.5 * flex * values.stiffness / level[:, None] * weight[:, None]
    return np.log(ratio) * weight, np.hstack([slope, np.zeros_like(slope)])


def _shape_changes(
    state: ModalState, stiffness: FloatArray, pairs: IntArray
) -> FloatArray:
    """Return d phi_i / d ln theta_d in modal coordinates, shape (d, n, n_pairs).

    Source: Fox and Kapoor 1968, AIAA J. 6, 2426-2429.
    """
    apart = state.eigenvalue[pairs] - state.eigenvalue[:, None]
    scale = state.eigenvalue[pairs]
    safe = np.where(np.abs(apart) < _CLOSEST * scale, np.inf, apart)
    return np.asarray(stiffness[:, None, None] * state.flex[:, :, pairs] / safe)


def _damping_rows(
    state: ModalState,
    measured: MeasuredModes,
    values: JointValues,
    pairs: IntArray,
    change: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    assert measured.damping_ratio is not None
    assert measured.damping_ratio_sd is not None
    sd = measured.damping_ratio_sd
    level, omega = state.eigenvalue[pairs], np.sqrt(state.eigenvalue[pairs])
    viscous = np.tensordot(values.damping, state.flex, 1)
    ratio = damping_ratios(state, values.damping)[pairs]
    whole = viscous / (2 * omega[:, None, None]) + state.loss / (
        2 * level[:, None, None]
    )
    own = whole[np.arange(pairs.size), :, pairs]  # (n_pairs, n)
    by_shape = 2.0 * np.einsum("pn,dnp->pd", own, change)
    by_level = state.flex[:, pairs, pairs].T * values.stiffness / level[:, None]
    part = np.einsum("d,dp->p", values.damping, state.flex[:, pairs, pairs]) / (
        2 * omega
    )
    by_stiffness = by_shape - (ratio - 0.5 * part)[:, None] * by_level
    by_damping = values.damping * state.flex[:, pairs, pairs].T / (2 * omega[:, None])
    slope = np.hstack([by_stiffness, by_damping]) / sd[:, None]
    return (ratio - measured.damping_ratio) / sd, slope


def _shape_rows(
    state: ModalState,
    measured: MeasuredModes,
    outputs: FloatArray,
    pairs: IntArray,
    change: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Compare shapes, each scaled to fit; the scaling is projected out."""
    assert measured.shapes is not None
    assert measured.shape_sd is not None
    at_sensors = outputs @ state.shapes
    rows, slopes = [], []
    for row, number in enumerate(pairs):
        weight = 1.0 / measured.shape_sd[row]
        wanted = measured.shapes[row] * weight
        shape = at_sensors[:, number] * weight
        unit = shape / np.linalg.norm(shape)
        factor = (unit @ wanted) / np.linalg.norm(shape)
        left = factor * shape - wanted
        moved = (at_sensors @ change[:, :, row].T) * weight[:, None]
        moved = factor * (moved - np.outer(unit, unit @ moved))
        rows.append(np.concatenate([left.real, left.imag]))
        still = np.zeros((2 * weight.size, moved.shape[1]))
        parts = np.concatenate([moved.real, moved.imag])
        slopes.append(np.hstack([parts, still]))
    return np.concatenate(rows), np.concatenate(slopes)


def _frf_rows(
    model: ReducedModel, evidence: StructureEvidence, frf: Frf, values: JointValues
) -> tuple[FloatArray, FloatArray]:
    laplace = np.asarray(2j * np.pi * frf.frequency + frf.added_decay_rate, complex)
    found = predict_frf(model, values, laplace, evidence.outputs, evidence.inputs)
    # The variance is that of real and imaginary part together.
    weight = laplace**frf.kind.derivatives / np.sqrt(0.5 * np.asarray(frf.variance))
    left = found.response * weight - frf.response / np.sqrt(
        0.5 * np.asarray(frf.variance)
    )
    shape = (values.stiffness.size, -1)
    by_k = (found.by_stiffness * weight).reshape(shape).T * values.stiffness
    by_c = (found.by_damping * weight).reshape(shape).T * values.damping
    slope = np.hstack([by_k, by_c])
    flat = left.ravel()
    return without_gains(
        np.concatenate([flat.real, flat.imag]),
        np.concatenate([slope.real, slope.imag]),
        frf,
        evidence.gains,
    )


def states(evidence: Sequence[StructureEvidence]) -> tuple[str, ...]:
    """Return the labels; each state has a separate one.

    Raises:
        BadData: a label is given twice.
    """
    labels = tuple(one.label for one in evidence)
    if len(set(labels)) != len(labels):
        raise BadData(f"states {labels} must have different labels")
    return labels
