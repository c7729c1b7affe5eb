# SPDX-License-Identifier: MIT
"""Limits of the search for poles: how far they may move, and where they are seen."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.signal.modal.frf_lines import FrfLines, gaps_of, measured_width

# A pole that leaves its start by this many half-power half-widths has diverged.
_LEASH = 1.0
_LEASH_DAMPING = 10.0
# A band that begins below this share of its end begins at zero.
_NEXT_TO_ZERO = 0.1
# Poles beyond the band: shares of the band for their decay rates, and of its first line
# for their frequencies.
_LEAST_DECAY, _MOST_DECAY, _LEAST_PLACE = 5e-4, 0.3, 0.2


@dataclass(frozen=True, slots=True, eq=False)
class PolePrior:
    """Prior of the poles: their LSCF values, with weights.

    Closely overlapping modes can exchange damping for residue without a larger
    residual; only the start then distinguishes them. Its sd is taken as a half-power
    half-width, beyond which a pole counts as another one. Where the lines resolve a
    pole, this prior is negligible. The first `n_modes` are modes, the others
    computational poles beyond the band. Pinned ones stay at their start.
    """

    start: ComplexArray
    weight: FloatArray
    n_modes: int
    pinned: BoolArray

    @classmethod
    def around(
        cls,
        lines: FrfLines,
        start: ComplexArray,
        beyond: ComplexArray,
        doubt: FloatArray | float,
    ) -> "PolePrior":
        """Return the prior of modes and of computational poles, around their start.

        Args:
            lines: lines of the fit.
            start: of the modes [rad/s], shape (n_modes,).
            beyond: start of the computational poles [rad/s].
            doubt: factor on the weight of the modes; inf pins one.
        """
        doubt = np.broadcast_to(doubt, start.shape)
        pinned = np.append(np.isinf(doubt), np.zeros(beyond.size, bool))
        reach = _LEASH * measured_width(lines, start)
        reach = np.append(reach, np.full(beyond.size, np.ptp(lines.laplace.imag)))
        weight = (1.0 / reach) ** 2
        weight[: start.size] *= np.where(np.isinf(doubt), 1.0, doubt)
        return cls(np.append(start, beyond), weight, start.size, pinned)

    def cost(self, pole: ComplexArray) -> float:
        """Return the weighted squared distance from the start."""
        return float(self.weight @ np.abs(pole - self.start) ** 2)


def kept_beyond(
    lines: FrfLines, prior: PolePrior, pole: ComplexArray, trial: ComplexArray
) -> ComplexArray:
    """Return trial poles beyond the band, kept there and damped.

    Only a flank of them is seen: a step from a poor start often leaves the stable
    half-plane, or enters the band. One in a gap of the lines is kept in it.
    """
    n = prior.n_modes
    low, high = lines.laplace.imag[[0, -1]]
    start, span = prior.start[n:].imag, high - low
    above = start > 0.5 * (low + high)
    least = np.where(above, np.minimum(start, high), _LEAST_PLACE * low)
    most = np.where(above, high + span, np.maximum(start, low))
    width = np.full(start.size, span)
    for begin, end in gaps_of(lines):
        within = (start > begin) & (start < end)
        least, most = np.where(within, begin, least), np.where(within, end, most)
        width = np.where(within, end - begin, width)
    decay = np.maximum(-trial[n:].real, -pole[n:].real / 3.0)
    decay = np.clip(decay, _LEAST_DECAY * width, _MOST_DECAY * width)
    return np.asarray(1j * np.clip(trial[n:].imag, least, most) - decay)


def lost_poles(lines: FrfLines, pole: ComplexArray, prior: PolePrior) -> BoolArray:
    """Return which poles are no longer damped, or have diverged from their start.

    A computational pole is lost if it has moved into the band.
    """
    start = prior.start
    ratio = pole.real / start.real
    before, now = measured_width(lines, start), measured_width(lines, pole)
    diverged: BoolArray = np.abs((pole - start).imag) > _LEASH * np.maximum(before, now)
    diverged |= (ratio < 1.0 / _LEASH_DAMPING) | (ratio > _LEASH_DAMPING)
    inside = ~unresolved(lines, pole) | (pole.real >= 0.0) | (pole.imag <= 0.0)
    return np.asarray(np.where(np.arange(pole.size) < prior.n_modes, diverged, inside))


def unresolved(lines: FrfLines, pole: ComplexArray) -> BoolArray:
    """Return which poles do not have their peak within the band.

    These are poles beyond it, or less than a half-power half-width from its edge: with
    only one flank measured they cannot be distinguished from modes outside. So are
    those between lines that were left out of the band, a half-width from either side.

    Args:
        lines: lines of the fit.
        pole: [rad/s], shape (n,).

    Returns:
        Shape (n,).
    """
    low, high = lines.laplace.imag[[0, -1]]
    width = measured_width(lines, pole)
    # There are no modes below a band that begins next to zero.
    floor = low + width if low > _NEXT_TO_ZERO * high else 0.0 * width
    outside = (pole.imag < floor) | (pole.imag > high - width)
    return np.asarray(outside | _between(lines, pole, width))


def _between(lines: FrfLines, pole: ComplexArray, width: FloatArray) -> BoolArray:
    """Return which poles are in a gap of the lines, a half-width from either end."""
    low, high = gaps_of(lines).T
    place = pole.imag[:, None]
    away = np.minimum(place - low, high - place)
    return np.asarray(np.any(away > width[:, None], axis=1))
