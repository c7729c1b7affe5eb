# SPDX-License-Identifier: MIT
"""What speaks for one pole of the stabilisation diagram, before it is chosen."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.frf_lines import lines_of
from jointbench.signal.modal.refined_pole_covariance import refine_poles
from jointbench.signal.modal.shape_checks import phase_collinearity
from jointbench.signal.modal.stabilisation import Stabilisation

# Lines on each side of a pole: half-power half-widths, and lines for each unknown pole
# and for the residual terms, at least.
_REACH, _LINES_A_POLE, _LINES_REST = 10.0, 6, 24


@dataclass(frozen=True, slots=True)
class PoleEvidence:
    """One pole of the diagram.

    Attributes:
        frequency: natural frequency at its order [Hz].
        damping_ratio: at its order [-].
        frequency_sd: standard uncertainty from the lines around it [Hz].
        damping_ratio_sd: likewise [-].
        frequency_scatter: sd over the orders of its track [Hz].
        damping_scatter: likewise [-].
        collinearity: MPC of its shape [-]; 1 for a real mode, nan for one point.
        orders: number of orders of its track at which it was stable.
    """

    frequency: float
    damping_ratio: float
    frequency_sd: float
    damping_ratio_sd: float
    frequency_scatter: float
    damping_scatter: float
    collinearity: float
    orders: int


@one_thread()
def examine_pole(
    frf: Frf, keep: BoolArray, variance: FloatArray, table: Stabilisation, row: int
) -> PoleEvidence:
    """Fit the lines around one pole of the diagram, at its place.

    The poles of the same order in reach are fitted with it; those farther away are
    left to the residual terms. The poles do not move: the covariance is what a
    refinement would begin with, times the residual over the noise.

    Args:
        frf: of the diagram.
        keep: lines of the diagram, shape (n_lines,).
        variance: of these lines, shape (n_outputs, n_inputs, n_kept).
        table: the diagram.
        row: of the pole in it.

    Returns:
        Frequency, damping, their uncertainty and the collinearity of the shape.
    """
    own = complex(table.pole[row])
    same = np.flatnonzero(table.order == table.order[row])
    near, members = _around(frf, keep, table.pole[same], own)
    poles = table.pole[same][members]
    place = int(np.argmin(np.abs(poles - own)))
    part = variance[:, :, near[keep]].reshape(-1, int(near.sum()))
    found = refine_poles(lines_of(frf, near), poles, part, steps=0)
    covariance = found.covariance[place] * max(1.0, float(found.inflation[place]))
    size = abs(own)
    along = np.array([own.real, own.imag]) / size
    across = np.array([-(own.imag**2), own.real * own.imag]) / size**3
    residue = found.fit.residues()[place].reshape(frf.response.shape[:2])
    track = (table.track == table.track[row]) & table.stable
    return PoleEvidence(
        float(table.frequency[row]),
        float(table.damping_ratio[row]),
        _root(along @ covariance @ along) / (2.0 * np.pi),
        _root(across @ covariance @ across),
        _spread(table.frequency[track]),
        _spread(table.damping_ratio[track]),
        _collinearity(residue),
        int(np.count_nonzero(track)),
    )


def _around(
    frf: Frf, keep: BoolArray, poles: ComplexArray, own: complex
) -> tuple[BoolArray, IntArray]:
    """Return the lines around a pole, and which poles of its order stand on them."""
    omega = 2.0 * np.pi * frf.frequency
    away = np.where(keep, np.abs(omega - own.imag), np.inf)
    reach = _REACH * abs(own.real - frf.added_decay_rate)
    for _ in range(2):
        members = np.flatnonzero(np.abs(poles.imag - own.imag) <= reach)
        least = _LINES_REST + _LINES_A_POLE * members.size
        count = min(max(least, int(np.sum(away <= reach))), int(keep.sum()))
        reach = max(reach, float(np.sort(away)[count - 1]))
    return np.asarray(away <= reach), members


def _collinearity(residue: ComplexArray) -> float:
    """Return the MPC of the side with more points; nan for a single one."""
    matrix = residue if residue.shape[0] >= residue.shape[1] else residue.T
    if matrix.shape[0] < 2:
        return float("nan")
    shape = np.linalg.svd(matrix, full_matrices=False)[0][:, 0]
    return float(phase_collinearity(shape[None])[0])


def _spread(values: FloatArray) -> float:
    return float(np.std(values)) if values.size else float("nan")


def _root(variance: float) -> float:
    return float(np.sqrt(max(float(variance), 0.0)))
