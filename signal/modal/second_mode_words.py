# SPDX-License-Identifier: MIT
"""Remarks on modes beside which the FRF matrix hints at a second one."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.modal_model import ModalModel

# A curve peaks at a mode where it exceeds that at the ends of the peak by this factor.
_PEAKED = 2.0
# The ends of a peak, in half-power half-widths.
_ENDS = 4.0


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
        A sentence on each such mode, and on each single mode at which the two largest
        singular values of the FRF matrix (CMIF) peak together.

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
