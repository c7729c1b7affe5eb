# SPDX-License-Identifier: MIT
"""The modal model of a structure, built from a fit."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.records.provenance import Provenance
from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.mode_selection import FittedModes
from jointbench.signal.modal.residue_covariance import residue_uncertainty
from jointbench.signal.modal.stabilisation import PoleCandidate

# Interval twice as wide as for noise alone.
_SYSTEMATIC = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class ModalModel:
    """The modes of a structure, by ascending frequency.

    Attributes:
        natural_frequency: |pole| / 2 pi [Hz], shape (n_modes,).
        frequency_sd: its standard uncertainty [Hz], shape (n_modes,).
        damping_ratio: [-], shape (n_modes,).
        damping_ratio_sd: its standard uncertainty [-], shape (n_modes,).
        residues: of the receptance, for any kind of FRF [m/(N s)], shape (n_modes,
            n_outputs, n_inputs).
        residues_sd: standard uncertainty of their real part and, as imaginary part, of
            their imaginary part, same shape.
        shapes: response of each output, largest component real and 1, shape
            (n_modes, n_outputs).
        shapes_sd: standard uncertainty of real and imaginary part, likewise.
        participation: residue of that largest component from each input [m/(N s)],
            shape (n_modes, n_inputs).
        significance: increase of chi-squared if the mode were left out [-], shape
            (n_modes,).
        residual_ratio: around each mode, rms residual over noise [-]: 1 for noise
            alone, shape (n_modes,).
        stable_orders: at how many orders it was stable, shape (n_modes,).
        by_hand: True for a mode kept by the operator, shape (n_modes,).
        outputs: labels of the outputs.
        inputs: labels of the inputs.
        provenance: origin and processing steps.
    """

    natural_frequency: FloatArray
    frequency_sd: FloatArray
    damping_ratio: FloatArray
    damping_ratio_sd: FloatArray
    residues: ComplexArray
    residues_sd: ComplexArray
    shapes: ComplexArray
    shapes_sd: ComplexArray
    participation: ComplexArray
    significance: FloatArray
    residual_ratio: FloatArray
    stable_orders: IntArray
    by_hand: BoolArray
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    provenance: Provenance = field(default=())

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        n_modes, n_outputs, n_inputs = (
            self.natural_frequency.size,
            len(self.outputs),
            len(self.inputs),
        )
        for name, shape in (
            ("frequency_sd", (n_modes,)),
            ("damping_ratio", (n_modes,)),
            ("damping_ratio_sd", (n_modes,)),
            ("residues", (n_modes, n_outputs, n_inputs)),
            ("residues_sd", (n_modes, n_outputs, n_inputs)),
            ("shapes", (n_modes, n_outputs)),
            ("shapes_sd", (n_modes, n_outputs)),
            ("participation", (n_modes, n_inputs)),
            ("significance", (n_modes,)),
            ("residual_ratio", (n_modes,)),
            ("stable_orders", (n_modes,)),
            ("by_hand", (n_modes,)),
        ):
            require_shape(name, getattr(self, name), shape)
            freeze(self, name)
        freeze(self, "natural_frequency")

    @property
    def systematic(self) -> BoolArray:
        """True where the residual exceeds the noise in the interval, shape (n_modes,).

        The model is inexact there: leakage, a missing neighbour, a nonlinear structure.
            More averages would not narrow the interval.
        """
        return np.asarray(self.residual_ratio > _SYSTEMATIC)

    @property
    def poles(self) -> ComplexArray:
        """Poles with positive frequency [rad/s], shape (n_modes,)."""
        omega, ratio = 2.0 * np.pi * self.natural_frequency, self.damping_ratio
        poles: ComplexArray = omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2))
        return poles


def build_model(
    frf: Frf,
    fitted: FittedModes,
    found: Sequence[PoleCandidate],
    provenance: Provenance,
) -> ModalModel:
    """Build a modal model from fitted poles and residues.

    Args:
        frf: the fitted FRF; names outputs and inputs.
        fitted: the accepted modes.
        found: all candidates; `fitted.chosen` indexes them.
        provenance: of the model.

    Returns:
        The modes by ascending frequency.
    """
    pole = fitted.poles.pole
    by_frequency = np.argsort(np.abs(pole))
    chosen = [found[i] for i in fitted.chosen[by_frequency]]
    frequency_sd, damping_sd = _uncertainty(fitted, [found[i] for i in fitted.chosen])
    shape = (pole.size, len(frf.outputs), len(frf.inputs))
    residues = fitted.fit.residues().reshape(shape)
    residues_sd, shapes_sd = residue_uncertainty(fitted.poles, residues)
    residues = residues[by_frequency]
    shapes, participation = split_residues(residues)
    ordered = pole[by_frequency]
    return ModalModel(
        natural_frequency=np.abs(ordered) / (2.0 * np.pi),
        frequency_sd=frequency_sd[by_frequency],
        damping_ratio=-ordered.real / np.abs(ordered),
        damping_ratio_sd=damping_sd[by_frequency],
        residues=residues,
        residues_sd=residues_sd[by_frequency],
        shapes=shapes,
        shapes_sd=shapes_sd[by_frequency],
        participation=participation,
        significance=fitted.significance[by_frequency],
        residual_ratio=fitted.residual_ratio[by_frequency],
        stable_orders=np.array([c.stable_orders for c in chosen], np.int64),
        by_hand=np.array([c.by_hand for c in chosen], bool),
        outputs=frf.outputs,
        inputs=frf.inputs,
        provenance=provenance,
    )


def split_residues(residues: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Split each residue matrix into a shape and participation factors.

    Args:
        residues: shape (n_modes, n_outputs, n_inputs).

    Returns:
        Shapes, largest component 1, shape (n_modes, n_outputs), and participation,
        shape (n_modes, n_inputs): their product is the best rank-one residue.
    """
    left, scale, right = np.linalg.svd(residues, full_matrices=False)
    shapes, participation = left[:, :, 0], scale[:, :1] * right[:, 0, :]
    largest = np.argmax(np.abs(shapes), axis=1)[:, None]
    unit = np.take_along_axis(shapes, largest, axis=1)
    scaled = np.asarray(shapes / unit)
    # A complex number over itself may differ from 1 by its rounding.
    np.put_along_axis(scaled, largest, 1.0, axis=1)
    return scaled, np.asarray(participation * unit)


def _uncertainty(
    fitted: FittedModes, chosen: Sequence[PoleCandidate]
) -> tuple[FloatArray, FloatArray]:
    """Return sd of frequency [Hz] and damping ratio [-] by linear propagation."""
    poles = fitted.poles
    pole, size = poles.pole, np.abs(poles.pole)
    covariance = poles.covariance * poles.inflation[:, None, None]
    covariance = covariance + fitted.forced
    # One residual shows both: the larger counts. It also shows the noise of the force.
    rest = np.trace(fitted.shared - fitted.forced, axis1=1, axis2=2) > 0.0
    shown = np.where(rest[:, None, None], fitted.shared - fitted.forced, 0.0)
    parts = np.stack((shown, fitted.doubts.shift))
    larger = np.argmax(np.trace(parts, axis1=2, axis2=3), axis=0)
    covariance = covariance + parts[larger, np.arange(pole.size)]
    # d|p| and d(-Re p / |p|) for a change of (Re p, Im p).
    along = np.stack((pole.real, pole.imag), axis=1) / size[:, None]
    across = np.stack((-(pole.imag**2), pole.real * pole.imag), axis=1)
    across = across / size[:, None] ** 3
    frequency = np.einsum("mi,mij,mj->m", along, covariance, along) / (2 * np.pi) ** 2
    damping = np.einsum("mi,mij,mj->m", across, covariance, across)
    wander = np.array([c.scatter for c in chosen]).reshape(-1, 2) ** 2
    wander[poles.converged] = 0.0
    # Rounding can leave a variance of exact data below zero.
    frequency, damping = np.maximum(frequency, 0.0), np.maximum(damping, 0.0)
    return np.sqrt(frequency + wander[:, 0]), np.sqrt(damping + wander[:, 1])
