# SPDX-License-Identifier: MIT
"""Remarks on modes beside which another one is hinted at, or could not be seen."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.modal_model import ModalModel

# A curve peaks at a mode where it exceeds that at the ends of the peak by this factor.
_PEAKED = 2.0
# The ends of a peak, in half-power half-widths.
_ENDS = 4.0
# Half-power half-widths within which modes share a pole as far as the data show,
# and within which they overlap: fits trade one for another there.
_SHARED, _OVERLAP = 0.2, 1.0


def second_mode_words(
    model: ModalModel,
    lines: FrfLines,
    matrices: ComplexArray,
    hints: Sequence[float],
) -> tuple[str, ...]:
    """State at which modes a second one at the same frequency is possible.

    Args:
        model: the modes.
        lines: what was fitted.
        matrices: FRFs on them, shape (n_rows, n_references, n_lines).
        hints: natural frequencies of modes whose residue is not of rank one [Hz].

    Returns:
        A sentence on each such mode, on each single mode at which the two largest
        singular values of the FRF matrix (CMIF) peak together, and on each group of
        modes that uses all references up.

    Source:
        Shih, Tsuei, Allemang and Brown, Mech. Systems and Signal Processing 2 (1988)
        367.
    """
    matrix = matrices.transpose(2, 0, 1)
    curves = np.asarray(np.linalg.svd(matrix, compute_uv=False)[:, :2].T)
    pole, width = model.poles, measured_width(lines, model.poles)
    words = []
    for number, frequency in enumerate(model.natural_frequency):
        apart = np.abs(pole.imag - pole[number].imag)
        single = np.count_nonzero(apart < 2.0 * width[number]) == 1
        at, around = float(pole[number].imag), float(width[number])
        if float(frequency) in hints or (
            single and _peak_together(curves, lines.laplace.imag, at, around)
        ):
            words.append(
                f"mode {number + 1} at {frequency:.6g} Hz: second mode at the same "
                "frequency possible (a second singular value of the FRF matrix rises "
                "there too): add a reference"
            )
    return (*words, *_used_up_words(model, width, matrices.shape[1]))


def _used_up_words(
    model: ModalModel, width: FloatArray, n_references: int
) -> tuple[str, ...]:
    """State where modes are as many as the references can show at one frequency.

    The residue of a shared pole has no more independent columns than there are
    references, whatever the number of modes: a further one leaves no trace.

    Args:
        model: the modes, by ascending frequency.
        width: half their half-power widths [rad/s].
        n_references: columns of the FRF matrix, 2 or more.
    """
    step = np.diff(model.poles.imag) / np.minimum(width[:-1], width[1:])
    cuts = np.flatnonzero(step > _OVERLAP) + 1
    words = []
    for group in np.split(np.arange(width.size), cuts):
        used = group.size > n_references
        if not used and group.size == n_references:
            used = bool(np.all(step[group[:-1]] < _SHARED))
        if used:
            numbers = ", ".join(str(number + 1) for number in group)
            places = ", ".join(f"{f:.6g}" for f in model.natural_frequency[group])
            words.append(
                f"modes {numbers} at {places} Hz: as many as {n_references} references "
                "can show at one frequency, so another mode may be here: a further "
                "reference would show it"
            )
    return tuple(words)


def _peak_together(
    curves: FloatArray, omega: FloatArray, at: float, width: float
) -> bool:
    """Return whether both curves peak within half a half-power width of a mode."""
    inside = np.flatnonzero(np.abs(omega - at) < width)
    around = np.flatnonzero(np.abs(omega - at) < _ENDS * width)
    if inside.size < 2 or around.size < inside.size + 4:
        return False
    ends = curves[:, around[[0, -1]]].max(axis=1)
    return bool(np.all(curves[:, inside].max(axis=1) > _PEAKED * ends))
