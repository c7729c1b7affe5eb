# SPDX-License-Identifier: MIT
"""Response of a jointed structure: modes of any damping, FRFs, response to a force."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    ModalState,
    modal_state,
)
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
)

# Number of modes coupled by damping directly; others are coupled by refinement.
_COUPLED = 60
_REFINEMENTS = 4
# Least ratio of imaginary to real part of an oscillating pole; the loss of the bodies
# alone gives a decay about its loss factor.
_SWINGS = 0.02
# Poles this small relative to the largest are zero: free rigid motions.
_NO_POLE = 1e-13


def predict_complex_modes(
    model: ReducedModel, values: JointValues
) -> tuple[FloatArray, FloatArray]:
    """Predict modes of any damping from the quadratic eigenvalue problem.

    Args:
        model: the reduced structure.
        values: of its joints.

    Returns:
        |pole| / 2 pi [Hz] and damping ratio [-] of oscillating elastic modes, by
        frequency, at most the number of modes of the model.

    Source:
        Ewins, Modal Testing (2000), sec. 2.7.
    """
    state = modal_state(model, values.stiffness)
    count = min(_COUPLED, state.eigenvalue.size)
    moved = np.s_[state.rigid : count]
    # Unknowns: omega times displacement (not of rigid motions), and velocity.
    omega = np.sqrt(state.eigenvalue[moved])
    spring = np.zeros((count, omega.size), complex)
    spring[moved] = np.diag(omega) + 1j * state.loss[moved, moved] / omega
    matrix = np.zeros((omega.size + count,) * 2, complex)
    matrix[: omega.size, omega.size + state.rigid :] = np.diag(omega)
    matrix[omega.size :, : omega.size] = -spring
    matrix[omega.size :, omega.size :] = -np.tensordot(
        values.damping, state.flex[:, :count, :count], 1
    )
    pole = np.linalg.eigvals(matrix)
    size = np.abs(pole)
    swings = (pole.imag > _SWINGS * size) & (size > _NO_POLE * size.max())
    pole = pole[swings & (pole.real <= 0)]
    pole = pole[np.argsort(np.abs(pole))][: model.modes - state.rigid]
    return np.abs(pole) / (2 * np.pi), -pole.real / np.abs(pole)


@dataclass(frozen=True, slots=True, eq=False)
class FrfSlopes:
    """FRFs and their derivatives by the joints.

    Attributes:
        response: receptance [m/N], shape (n_outputs, n_inputs, n_lines).
        by_stiffness: derivatives by each stiffness [m/N per N/m], shape
            (n_parameters, n_outputs, n_inputs, n_lines).
        by_damping: derivatives by each damping [m/N per N s/m], same shape.
    """

    response: ComplexArray
    by_stiffness: ComplexArray
    by_damping: ComplexArray


def predict_frf(
    model: ReducedModel,
    values: JointValues,
    laplace: ComplexArray,
    outputs: FloatArray,
    inputs: FloatArray,
) -> FrfSlopes:
    """Predict receptances and their derivatives.

    Args:
        model: the reduced structure.
        values: of its joints.
        laplace: lines: j omega plus the decay rate of an exponential window [1/s],
            shape (n_lines,).
        outputs: rows of `readout`, shape (n_outputs, r).
        inputs: rows of `readout`, shape (n_inputs, r).

    Returns:
        Receptances; times s or s^2 for mobility or accelerance.

    Source:
        Z = K + s C + s^2 M: dH/dp = -H dZ/dp H.
    """
    state = modal_state(model, values.stiffness)
    both = np.concatenate([outputs, inputs]) @ state.shapes
    motion = _solve_lines(state, values.damping, laplace, both.T)
    n_out = outputs.shape[0]
    left, right = motion[:, :, :n_out], motion[:, :, n_out:]
    response = np.einsum("or,lri->oil", both[:n_out], right)
    stretched = np.einsum("drs,lsi->dlri", state.flex, right, optimize=True)
    slope = -np.einsum("lro,dlri->doil", left, stretched, optimize=True)
    return FrfSlopes(response, slope, slope * laplace)


def _solve_lines(
    state: ModalState, damping: FloatArray, laplace: ComplexArray, load: FloatArray
) -> ComplexArray:
    """Return Z^-1 load for every line, shape (n_lines, r, n_loads).

    The first estimate couples low modes and treats high ones separately; the residual
    of all modes refines it. A line that does not improve keeps the estimate.
    """
    viscous = np.tensordot(damping, state.flex, 1)
    own = state.eigenvalue + laplace[:, None] ** 2
    rough = _rough_inverse(state, viscous, laplace, own)
    wanted = np.broadcast_to(load.astype(complex), (laplace.size, *load.shape))

    def missing(answer: ComplexArray) -> ComplexArray:
        coupled = laplace[:, None, None] * (viscous @ answer) + 1j * (
            state.loss @ answer
        )
        return np.asarray(wanted - own[:, :, None] * answer - coupled)

    motion = rough(wanted)
    left = missing(motion)
    for _ in range(_REFINEMENTS if state.eigenvalue.size > _COUPLED else 0):
        better = motion + rough(left)
        remains = missing(better)
        helps = np.linalg.norm(remains, axis=(1, 2)) < np.linalg.norm(left, axis=(1, 2))
        motion = np.where(helps[:, None, None], better, motion)
        left = np.where(helps[:, None, None], remains, left)
    return motion


def _rough_inverse(
    state: ModalState, viscous: FloatArray, laplace: ComplexArray, own: ComplexArray
) -> Callable[[ComplexArray], ComplexArray]:
    """Return an inverse of Z that couples the low modes only."""
    count = min(_COUPLED, state.eigenvalue.size)
    whole = (
        laplace[:, None, None] * viscous[:count, :count]
        + 1j * (state.loss[:count, :count])
    )
    inverse = np.linalg.inv(whole + own[:, :count, None] * np.eye(count))
    alone = own[:, count:] + 1j * np.diag(state.loss)[count:]
    alone = alone + laplace[:, None] * np.diag(viscous)[count:]

    def solve(load: ComplexArray) -> ComplexArray:
        high = load[:, count:] / alone[:, :, None]
        return np.concatenate([inverse @ load[:, :count], high], axis=1)

    return solve


def response_to_force(
    model: ReducedModel,
    values: JointValues,
    force: FloatArray,
    sample_rate: float,
    outputs: FloatArray,
    inputs: FloatArray,
) -> FloatArray:
    """Predict the displacement of sensors under a measured force, from rest.

    Args:
        model: the reduced structure.
        values: of its joints.
        force: [N], shape (n_inputs, n_samples); it should end long before the record,
            or the record should contain the decay.
        sample_rate: [Hz].
        outputs: rows of `readout`.
        inputs: rows of `readout`.

    Returns:
        Displacement [m], shape (n_outputs, n_samples). Rigid motions of a free
        structure are left out: they grow without limit.

    Source:
        Fourier transform of twice the record with an exponential window (Ewins, Modal
        Testing (2000), sec. 3.7), which is then removed.
    """
    count = force.shape[1]
    padded = 2 * count
    # The window reduces the circular response of the second half by exp(-decay T) =
    # 1e-6.
    decay = np.log(1e6) * sample_rate / padded
    time = np.arange(padded) / sample_rate
    press = np.exp(-decay * time)
    spectrum = np.fft.rfft(force * press[:count], padded)
    laplace = 2j * np.pi * np.fft.rfftfreq(padded, 1 / sample_rate) + decay
    state = modal_state(model, values.stiffness)
    elastic = np.arange(state.rigid, state.eigenvalue.size)
    kept = ModalState(
        state.eigenvalue[elastic],
        state.shapes[:, elastic],
        state.flex[:, elastic][:, :, elastic],
        state.loss[np.ix_(elastic, elastic)],
        0,
    )
    motion = _solve_lines(kept, values.damping, laplace, (inputs @ kept.shapes).T)
    transfer = np.einsum("or,lri->oil", outputs @ kept.shapes, motion)
    answer = np.fft.irfft(np.einsum("oil,il->ol", transfer, spectrum), padded)
    return np.asarray(answer[:, :count] / press[:count])
