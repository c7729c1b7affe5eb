# SPDX-License-Identifier: MIT
"""A group of neighbouring modes refitted on the lines around them.

What a further pole would change is settled by the lines around it. So the modes far
away are taken from the FRF as they are, the smooth rest is left to the residual terms,
and only the group is fitted: a trial costs a small share of a fit of the whole band.
"""

from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.lsfd import LinearFit, modal_basis

# Lines for each pole of a group, and for the residual terms, at least.
_LINES_A_POLE, _LINES_REST = 6, 24


@dataclass(frozen=True, slots=True, eq=False)
class WholeFit:
    """A fit of all lines from which groups are taken.

    Attributes:
        lines: what was fitted.
        pole: modes, then computational poles [rad/s], shape (n_poles,).
        n_modes: how many of them are modes.
        fit: residues and synthesis with all of them.
        noise: noise variance of the lines, shape (n_frf, n_lines).
        variance: noise and model error, same shape.
        residual: measured less fitted FRF, same shape.
    """

    lines: FrfLines
    pole: ComplexArray
    n_modes: int
    fit: LinearFit
    noise: FloatArray
    variance: FloatArray
    residual: ComplexArray = field(init=False)

    def __post_init__(self) -> None:
        """Subtract the fit once."""
        residual = self.lines.response - self.fit.synthesis
        object.__setattr__(self, "residual", residual)


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Neighbouring poles with their lines.

    Attributes:
        lines: around them, without all other poles.
        noise: noise variance of these lines, shape (n_frf, n_lines).
        variance: noise and model error, same shape.
        residual: of the whole fit on these lines, same shape.
        modes: indices of the modes of the group.
        beyond: indices of its computational poles.
    """

    lines: FrfLines
    noise: FloatArray
    variance: FloatArray
    residual: ComplexArray
    modes: IntArray
    beyond: IntArray


def group_around(
    whole: WholeFit, omega: float, reach: float, *, with_beyond: bool = False
) -> Group:
    """Return the poles within reach of a frequency, and the lines around it.

    Args:
        whole: fit of all lines.
        omega: middle of the group [rad/s].
        reach: lines on each side [rad/s]; more where the group has many poles.
        with_beyond: whether computational poles belong to it.
    """
    places = whole.lines.laplace.imag
    keep = _enough_lines(whole, omega, reach)
    low, high = places[keep][[0, -1]]
    width = measured_width(whole.lines, whole.pole)
    near = (whole.pole.imag > low - width) & (whole.pole.imag < high + width)
    outer = np.arange(whole.pole.size) >= whole.n_modes
    # Beyond an edge of the band all poles belong to the modes at that edge.
    near |= outer & bool(keep[-1]) & (whole.pole.imag > places[-1])
    near |= outer & bool(keep[0]) & (whole.pole.imag < places[0])
    near &= ~outer | with_beyond
    index = np.flatnonzero(near)
    own = _contribution(whole, index, keep)
    return Group(
        FrfLines(
            whole.lines.laplace[keep],
            whole.residual[:, keep] + own,
            whole.lines.derivatives,
        ),
        whole.noise[:, keep],
        whole.variance[:, keep],
        whole.residual[:, keep],
        index[index < whole.n_modes],
        index[index >= whole.n_modes],
    )


def _enough_lines(whole: WholeFit, omega: float, reach: float) -> BoolArray:
    """Return the lines within reach; the reach grows until they carry the poles."""
    places = whole.lines.laplace.imag
    away = np.abs(places - omega)
    while True:
        keep = away < reach
        inside = np.count_nonzero(np.abs(whole.pole.imag - omega) < reach)
        if keep.sum() >= _LINES_A_POLE * (inside + 1) + _LINES_REST or keep.all():
            return np.asarray(keep)
        reach *= 1.3


def _contribution(whole: WholeFit, index: IntArray, keep: BoolArray) -> ComplexArray:
    """Return what some poles add to the kept lines, shape (n_frf, n_kept)."""
    lines = FrfLines(
        whole.lines.laplace[keep],
        whole.lines.response[:, keep],
        whole.lines.derivatives,
    )
    basis = modal_basis(lines, whole.pole[index])[:, : 2 * index.size]
    columns = (2 * index[:, None] + np.arange(2)).ravel()
    return np.asarray(whole.fit.coefficients[:, columns] @ basis.T)
