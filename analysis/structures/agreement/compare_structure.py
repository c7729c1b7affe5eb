# SPDX-License-Identifier: MIT
"""A measured structure beside its model: modes, FRFs, suspected coordinates."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.structures.agreement.paired_modes import (
    ModeDifference,
    ModeSet,
    comac,
    enhanced_comac,
    frac,
    pair_mode_sets,
)
from jointbench.analysis.structures.agreement.suspect_coordinates import (
    ShapesAtPlaces,
    Suspect,
    find_suspects,
)
from jointbench.analysis.structures.reduction.full_modes import frequency_of
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    damping_ratios,
    energy_shares,
    modal_state,
)
from jointbench.analysis.structures.reduction.predict_response import predict_frf
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.modal.modal_model import ModalModel

# Lines compared and drawn of each FRF, at most.
_LINES = 400


@dataclass(frozen=True, slots=True, eq=False)
class ComparedPlaces:
    """The outputs and hit points of a measurement in the model.

    Attributes:
        outputs: rows of `readout`, shape (n_outputs, r).
        inputs: rows of `readout`, shape (n_inputs, r).
        axes: rows of the outputs along x, y, z, shape (3 n_outputs, r).
        along: axis that each output measures mostly, shape (n_outputs,).
    """

    outputs: FloatArray
    inputs: FloatArray
    axes: FloatArray
    along: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Agreement:
    """How a model agrees with a measurement.

    Attributes:
        measured: modes.
        computed: modes at the same places.
        pairs: one for each measured mode with a partner.
        mac: of all, shape (n_measured, n_computed).
        comac: of each output [-], shape (n_outputs,).
        enhanced_comac: of each output [-], shape (n_outputs,).
        frequency: lines of the FRFs [Hz], shape (n_lines,).
        measured_frf: shape (n_outputs, n_inputs, n_lines).
        computed_frf: same shape and kind.
        frac: of each output and input [-], shape (n_outputs, n_inputs).
        suspects: outputs and hit points with a doubtful sign, label or axis.
        outputs: labels.
        inputs: labels.
        kind: of the FRFs.
    """

    measured: ModeSet
    computed: ModeSet
    pairs: tuple[ModeDifference, ...]
    mac: FloatArray
    comac: FloatArray
    enhanced_comac: FloatArray
    frequency: FloatArray
    measured_frf: ComplexArray
    computed_frf: ComplexArray
    frac: FloatArray
    suspects: tuple[Suspect, ...]
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    kind: FrfKind

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "mac", "comac", "enhanced_comac", "frequency", "frac")
        freeze(self, "measured_frf", "computed_frf")


@one_thread()
def compare_structure(
    model: ReducedModel,
    values: JointValues,
    places: ComparedPlaces,
    modes: ModalModel,
    frf: Frf,
    covariance: FloatArray | None = None,
    *,
    band: tuple[float, float] | None = None,
) -> Agreement:
    """Compare modes and FRFs, and look for wrong signs, labels and axes.

    Args:
        model: the reduced structure.
        values: of its joints.
        places: the outputs and hit points of the measurement.
        modes: measured.
        frf: measured.
        covariance: of ln stiffness, then ln damping, shape (2 n_parameters, 2
            n_parameters); None takes the model as exact.
        band: of the FRFs that are compared [Hz]; None is the excited one.

    Returns:
        The agreement; intervals hold the measured uncertainty and, to first order,
        that of the joints.
    """
    whole = (float(frf.frequency[0]), float(frf.frequency[-1]))
    measured = measured_set(modes)
    computed, shapes, axes = _computed_set(model, values, places, covariance)
    pairs, likeness = pair_mode_sets(measured, computed)
    left = [one.measured for one in pairs]
    own = computed.shapes[[one.computed for one in pairs]]
    lines = _lines(frf, band or frf.usable_band or whole)
    found = _computed_frf(model, values, places, frf, lines)
    response = frf.response[:, :, lines]
    coordinates = ShapesAtPlaces(
        computed.frequency,
        computed.shapes.real,
        shapes[1],
        axes.reshape(computed.frequency.size, -1, 3),
        places.along,
        (modes.outputs, modes.inputs),
    )
    return Agreement(
        measured=measured,
        computed=computed,
        pairs=pairs,
        mac=likeness,
        comac=comac(measured.shapes[left], own),
        enhanced_comac=enhanced_comac(measured.shapes[left], own)
        if pairs
        else np.full(len(modes.outputs), np.nan),
        frequency=frf.frequency[lines],
        measured_frf=response,
        computed_frf=found,
        frac=frac(response, found),
        suspects=find_suspects(measured, coordinates),
        outputs=modes.outputs,
        inputs=modes.inputs,
        kind=frf.kind,
    )


def measured_set(modes: ModalModel) -> ModeSet:
    """Return measured modes with their modal constants.

    Source:
        A residue of the receptance of a lightly damped real mode is
        phi_o phi_i/(2 j omega) (Ewins, Modal Testing (2000), sec. 2.7).
    """
    omega = 2.0 * np.pi * modes.natural_frequency
    turn = (2j * omega * np.sqrt(1.0 - np.minimum(modes.damping_ratio, 0.9) ** 2))[
        :, None, None
    ]
    # Real part of j times the residue: its imaginary part counts.
    deviation = np.abs(turn) * modes.residues_sd.imag
    return ModeSet(
        modes.natural_frequency,
        modes.frequency_sd,
        modes.damping_ratio,
        modes.damping_ratio_sd,
        modes.shapes,
        (turn * modes.residues).real,
        deviation,
    )


def _computed_set(
    model: ReducedModel,
    values: JointValues,
    places: ComparedPlaces,
    covariance: FloatArray | None,
) -> tuple[ModeSet, tuple[FloatArray, FloatArray], FloatArray]:
    state = modal_state(model, values.stiffness)
    elastic = np.arange(state.rigid, model.modes)
    vector = state.shapes[:, elastic]
    frequency = frequency_of(state.eigenvalue[elastic])
    damping = damping_ratios(state, values.damping)[elastic]
    sd = np.zeros((2, elastic.size))
    if covariance is not None:
        share = 0.5 * energy_shares(state, values.stiffness)[elastic]
        viscous = values.damping * np.einsum("dii->id", state.flex)[elastic]
        viscous = viscous / (4.0 * np.pi * frequency[:, None])
        none = np.zeros_like(share)
        slopes = (np.hstack([share, none]), np.hstack([none, viscous]))
        for row, slope in enumerate(slopes):
            variance = np.einsum("md,de,me->m", slope, covariance, slope)
            sd[row] = np.sqrt(np.maximum(variance, 0.0))
    shapes = (places.outputs @ vector).T, (places.inputs @ vector).T
    constants = shapes[0][:, :, None] * shapes[1][:, None, :]
    found = ModeSet(
        frequency,
        sd[0] * frequency,
        damping,
        sd[1],
        shapes[0].astype(complex),
        constants,
        np.zeros_like(constants),
    )
    return found, shapes, (places.axes @ vector).T


def _lines(frf: Frf, band: tuple[float, float]) -> IntArray:
    low, high = band
    inside = np.flatnonzero((frf.frequency >= low) & (frf.frequency <= high))
    return np.asarray(inside[:: -(-inside.size // _LINES)])


def _computed_frf(
    model: ReducedModel,
    values: JointValues,
    places: ComparedPlaces,
    frf: Frf,
    lines: IntArray,
) -> ComplexArray:
    laplace = np.asarray(
        2j * np.pi * frf.frequency[lines] + frf.added_decay_rate, complex
    )
    found = predict_frf(model, values, laplace, places.outputs, places.inputs)
    return np.asarray(found.response * laplace**frf.kind.derivatives)
