# SPDX-License-Identifier: MIT
"""The lines of an FRF of a fit, and the width of its peaks."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.signal.frf.frf import Frf
from jointbench.signal.frf.record_end import EndOnLines

# Lines farther apart than this many of the usual distances have a gap between them.
_GAP_LINES = 3.0


@dataclass(frozen=True, slots=True, weakref_slot=True, eq=False)
class FrfLines:
    """The lines of an FRF of a fit.

    Attributes:
        laplace: s of each line [rad/s], shape (n_lines,).
        response: FRF, one row for each pair of output and input, shape
            (n_frf, n_lines).
        derivatives: q of the FRF's kind.
        end: of the records, None where it does not matter or is not known.
    """

    laplace: ComplexArray
    response: ComplexArray
    derivatives: int
    end: EndOnLines | None = None


def gaps_of(lines: FrfLines) -> FloatArray:
    """Return the ends of the gaps between lines that were left out [rad/s].

    Shape (n_gaps, 2), none where the lines are evenly spaced.
    """
    omega = lines.laplace.imag
    pitch = np.diff(omega)
    last = np.flatnonzero(pitch > _GAP_LINES * np.median(pitch))
    return np.asarray(np.stack((omega[last], omega[last + 1]), axis=1))


def measured_width(lines: FrfLines, pole: ComplexArray) -> FloatArray:
    """Return half the half-power width of each peak as measured [rad/s].

    The exponential window's decay rate is part of it.
    """
    return np.asarray(np.abs(pole.real - lines.laplace[0].real))


def lines_of(frf: Frf, keep: BoolArray) -> FrfLines:
    """Return the kept lines of an FRF.

    Args:
        frf: any kind.
        keep: True for the lines to fit, shape (n_lines,).

    Returns:
        The lines with one row per pair of output and input, inputs varying fastest.
    """
    laplace = np.asarray(2j * np.pi * frf.frequency[keep] + frf.added_decay_rate)
    response = frf.response[:, :, keep].reshape(-1, laplace.size)
    end = None if frf.end is None else frf.end.on(laplace)
    return FrfLines(laplace, response, frf.kind.derivatives, end)
