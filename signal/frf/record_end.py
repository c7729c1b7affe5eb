# SPDX-License-Identifier: MIT
"""What the end of the record leaves out of an FRF, mode by mode.

After the pulse a structure decays freely: a mode with pole p and residue R has
R sum_n f_n exp(p (t - t_n)) left at time t. Where the block ends at T while it still
rings, the transform lacks the rest, R sum_n f_n exp(p (T - t_n)) / (s - p) on the lines
of the block, where exp(-s T) is 1; in the FRF that is divided by the force. Nothing in
it is unknown but the pole and the residue that the fit seeks.

Source:
    Pintelon and Schoukens, System Identification (2012), sec. 6.3.2: leakage of a
    finite record is a rational function with the poles of the system.
"""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.signal.hits.hit_spectra import SpectraPlan
from jointbench.signal.hits.windows import HammerWindow

# Samples below this share of the highest are no part of the pulse.
_NO_PULSE = 1e-3
# Lines on which the force has less than this share of its highest carry no FRF.
_NO_FORCE = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class RecordEnd:
    """Where the blocks of an FRF end, and the pulse before.

    Attributes:
        length: of the block [s].
        time: of the samples of the pulse from the start of the block [s], shape (n,).
        force: on them, windowed, sum over the hits [N], shape (n,).
        start: of what the window keeps [s].
    """

    length: float
    time: FloatArray
    force: FloatArray
    start: float = 0.0

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "time", "force")

    def on(self, laplace: ComplexArray) -> "EndOnLines":
        """Return the end with the force on lines.

        Args:
            laplace: s of the lines [rad/s], with the decay rate of the exponential
                window as real part, shape (n_lines,).
        """
        added = float(laplace[0].real)
        pulse = np.exp(np.multiply.outer(added - laplace, self.time)) @ self.force
        strong = np.abs(pulse) > _NO_FORCE * np.abs(pulse).max()
        inverse = np.where(strong, 1.0 / np.where(strong, pulse, 1.0), 0.0)
        return EndOnLines(self, laplace, inverse)


@dataclass(frozen=True, slots=True, eq=False)
class EndOnLines:
    """The end of a record, on the lines of a fit.

    Attributes:
        end: of the record.
        laplace: s of the lines [rad/s], shape (n_lines,).
        inverse: 1 over the force on them [1/N], 0 where there is none, same shape.
    """

    end: RecordEnd
    laplace: ComplexArray
    inverse: ComplexArray

    def at(self, part: slice | IntArray) -> "EndOnLines":
        """Return the same on some of the lines."""
        return EndOnLines(self.end, self.laplace[part], self.inverse[part])

    def shares(self, pole: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Return what each mode still holds at the end, for `inverse` on the lines.

        Times `inverse` it is the share of the mode's receptance numerator that is left
        out.

        Args:
            pole: without the decay rate of the window [rad/s], shape (n_modes,).

        Returns:
            The share times the force [N] and its derivative with respect to the pole
            [N s], shape (n_modes,) each.
        """
        added = float(self.laplace[0].real)
        away = self.end.length - self.end.time
        rest = self.end.force * np.exp(np.multiply.outer(pole - added, away))
        return rest.sum(axis=1), np.asarray(rest @ away, dtype=np.complex128)

    @property
    def sees_offset(self) -> bool:
        """True where an offset changes more than the line at zero."""
        return self.end.start > 0.0 or float(self.laplace[0].real) > 0.0

    def offset(self) -> ComplexArray:
        """Return what an offset of the response adds to an FRF, in any unit.

        The mean over a cut decay is no offset: what is subtracted too much is a step
        where the window begins.
        """
        added = float(self.laplace[0].real)
        whole = np.exp(-self.laplace * self.end.start)
        whole -= np.exp(-added * self.end.length)
        return np.asarray(whole / self.laplace * self.inverse)


def record_end(
    plan: SpectraPlan, window: HammerWindow, force: ComplexArray
) -> RecordEnd | None:
    """Return where the blocks of all hits end, None where hits differ in it.

    Args:
        plan: of the hits.
        window: applied to each of them.
        force: sum of their spectra [N s], shape (n_lines,).
    """
    places = {(hit.trigger - hit.start) for _, hit in plan.chosen}
    whole = all(hit.stop - hit.start >= plan.block for _, hit in plan.chosen)
    if len(places) > 1 or not whole:
        return None
    total = scipy.fft.irfft(force, plan.block) * plan.rate
    strong = np.flatnonzero(np.abs(total) > _NO_PULSE * np.abs(total).max())
    if strong.size == 0:
        return None
    pulse = slice(int(strong[0]), int(strong[-1]) + 1)
    time = np.arange(plan.block)[pulse] / plan.rate
    (place,) = places
    lead = place / plan.rate if window.lead is None else window.lead
    start = max(0, int(np.ceil(place - lead * plan.rate))) / plan.rate
    return RecordEnd(plan.block / plan.rate, time, total[pulse].copy(), start)
