# SPDX-License-Identifier: MIT
"""Modes that work the same joint: each sees the amplitude of all.

A joint's stiffness and loss for one mode depend on its whole motion. With two modes far
apart in frequency the first harmonics are nearly those of an amplitude S with
exp(2 S) = exp(2 L) + sum of c exp(2 L of the other): exact for a cubic spring (c is
twice the square of the ratio of their motions at the joint). The weights c are free,
one for frequency and one for damping.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.amplitude.band_fit import BandFit, criterion
from jointbench.signal.amplitude.curve_fit import fit_jointly
from jointbench.signal.amplitude.mode_state import ModeState
from jointbench.signal.amplitude.slow_flow import decays
from jointbench.signal.amplitude.smoothness import MOST_LIKELY_WEIGHT

# Other modes that are taken along: those with the largest displacements.
_MOST_OTHERS = 3


def displacement(fit: BandFit, number: int) -> float:
    """Return the amplitude of a mode's displacement after the hardest hit [m]."""
    mode = fit.curved.modes[number]
    size = np.linalg.norm(fit.lines.mixing @ mode.shape)
    return float(size * np.exp(mode.start.max()) / fit.lines.centre**fit.power)


def with_others(
    fit: BandFit, others: Sequence[Sequence[tuple[BandFit, int]]]
) -> BandFit:
    """Refit the curves of a band with the amplitudes of other modes.

    Args:
        fit: of the band.
        others: for each of its modes, fits of the same decays and which mode of each.

    Returns:
        The fit with other modes where it explains more, else `fit`.
    """
    modes = []
    for mode, beside in zip(fit.curved.modes, others, strict=True):
        largest = sorted(beside, key=lambda one: -displacement(*one))[:_MOST_OTHERS]
        levels = [_levels(one, number, fit) for one, number in largest]
        modes.append(_beside(mode, np.stack(levels, axis=2)) if levels else mode)
    curved = fit_jointly(fit.lines, modes, fit.power)
    if criterion(curved) < criterion(fit.curved):
        return replace(fit, curved=curved)
    return fit


def _levels(other: BandFit, number: int, fit: BandFit) -> FloatArray:
    """Return L of a mode of another band at the nodes of a fit, 0 at its largest.

    Beyond its own decays, where it is below all noise, it continues at its last rate.
    """
    mode = other.curved.modes[number]
    level = decays(mode, other.lines.panels, other.lines.centre, 0).level
    time, wanted = other.lines.time, fit.lines.time
    last = (level[:, -1] - level[:, -2]) / (time[-1] - time[-2])
    beyond = np.maximum(wanted - time[-1], 0.0)
    inside = np.stack([np.interp(wanted, time, row) for row in level])
    return np.asarray(inside + last[:, None] * beyond - mode.start.max())


def _beside(mode: ModeState, levels: FloatArray) -> ModeState:
    """Return a mode with the squares of others, largest equal to its own largest."""
    weights = mode.log_weights
    if weights.shape[1] != levels.shape[2]:
        weights = np.full((2, levels.shape[2]), MOST_LIKELY_WEIGHT)
    return replace(
        mode,
        squares=np.exp(2.0 * (levels + mode.start.max())),
        log_weights=weights,
    )
