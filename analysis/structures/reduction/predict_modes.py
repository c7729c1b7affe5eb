# SPDX-License-Identifier: MIT
"""Modes of a lightly damped, jointed structure, with energy shares of the joints."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.structures.reduction.full_modes import frequency_of
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    solve_reduced,
)


@dataclass(frozen=True, slots=True, eq=False)
class JointValues:
    """Stiffness and damping of every joint and direction.

    Attributes:
        stiffness: totals [N/m], shape (n_parameters,).
        damping: totals [N s/m], shape (n_parameters,).
    """

    stiffness: FloatArray
    damping: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "damping")


@dataclass(frozen=True, slots=True, eq=False)
class ModalState:
    """All reduced modes of a structure at one set of joint values.

    Attributes:
        eigenvalue: [1/s^2], shape (n,); exactly zero for rigid motions.
        shapes: columns, orthonormal, shape (r, n).
        flex: phi_i' G_d phi_j of every direction, shape (n_parameters, n, n).
        loss: phi_i' (eta K) phi_j [1/s^2], shape (n, n).
        rigid: number of motions without strain, the first ones.
    """

    eigenvalue: FloatArray
    shapes: FloatArray
    flex: FloatArray
    loss: FloatArray
    rigid: int


def modal_state(model: ReducedModel, stiffness: FloatArray) -> ModalState:
    """Find all reduced modes at one set of stiffnesses [N/m], shape (n_parameters,)."""
    found = solve_reduced(model, stiffness, model.size)
    vector = found.shapes
    flex = model.spread.between(vector)
    loss = vector.T @ (model.loss @ vector)
    return ModalState(found.eigenvalue, vector, flex, loss, found.rigid)


@dataclass(frozen=True, slots=True, eq=False)
class PredictedModes:
    """Elastic modes with damping.

    Attributes:
        natural_frequency: [Hz], shape (n_modes,).
        damping_ratio: [-], shape (n_modes,).
        shapes: response at the sensors, mass-normalised, shape (n_modes, n_sensors).
        energy_share: part of the strain energy in each joint and direction [-], shape
            (n_modes, n_parameters).
    """

    natural_frequency: FloatArray
    damping_ratio: FloatArray
    shapes: FloatArray
    energy_share: FloatArray


def predict_modes(
    model: ReducedModel, values: JointValues, rows: FloatArray | None = None
) -> PredictedModes:
    """Predict the elastic modes in the range of the reduced model.

    Args:
        model: the reduced structure.
        values: of its joints.
        rows: of the sensors, of `readout`; none when left out.

    Returns:
        Frequencies of the undamped structure, and damping ratios to first order in
        the damping: valid for light damping.

    Source:
        Ewins, Modal Testing (2000), sec. 2.4.
    """
    state = modal_state(model, values.stiffness)
    elastic = np.arange(state.rigid, model.modes)
    return PredictedModes(
        natural_frequency=frequency_of(state.eigenvalue[elastic]),
        damping_ratio=damping_ratios(state, values.damping)[elastic],
        shapes=state.shapes[:, elastic].T
        @ (np.zeros((0, model.size)) if rows is None else rows).T,
        energy_share=energy_shares(state, values.stiffness)[elastic],
    )


def damping_ratios(state: ModalState, damping: FloatArray) -> FloatArray:
    """Return the damping ratio of every mode to first order [-], shape (n,).

    That of a rigid motion, which has no frequency, is zero.
    """
    omega = np.sqrt(_straining(state))
    viscous = np.einsum("d,dii->i", damping, state.flex) / (2.0 * omega)
    return np.asarray(viscous + np.diag(state.loss) / (2.0 * omega**2))


def energy_shares(state: ModalState, stiffness: FloatArray) -> FloatArray:
    """Return theta_d phi' G_d phi / lambda: d ln f^2 / d ln theta_d, shape (n, d)."""
    level = _straining(state)
    return np.asarray(np.einsum("d,dii->id", stiffness, state.flex) / level[:, None])


def _straining(state: ModalState) -> FloatArray:
    """Return eigenvalues to divide by; motions without strain have zero shares."""
    return np.where(state.eigenvalue > 0, state.eigenvalue, np.inf)
