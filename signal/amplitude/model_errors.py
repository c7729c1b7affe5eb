# SPDX-License-Identifier: MIT
"""What first-order theory of a joint leaves out: corrections and their errors."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.amplitude.band_fit import BandFit
from jointbench.signal.amplitude.mode_state import ModeState
from jointbench.signal.amplitude.slow_flow import decays

# Rate of a decay over that of the pole, see `energy_share`: elastic, friction, least
# ratio of the changes of damping and frequency in friction, and what q may be off.
_ELASTIC, _MASING, _FRICTION_RATIO, _ENERGY_SD = 0.5, 2.0, 0.27, 0.4
# Share of what other modes on the joint change that the common amplitude may miss.
_INTERACTION_SD = 0.2


def energy_share(relative: FloatArray, zeta: FloatArray) -> float:
    """Return q: amplitude times omega^q falls at the rate of the pole.

    A decay is not a steady vibration: amplitude falls as the energy that is stored
    does. To first order in the softening the rate is zeta omega / (1 + q d ln omega /
    dL), with q = 1/2 where the joint is elastic (the action is lost) and q = 2 where it
    is friction after Masing (energy changes with the tangent of the backbone). What
    the joint adds to damping distinguishes the two.

    Args:
        relative: ln omega over even L, shape (n,).
        zeta: there, shape (n,).
    """
    change = relative[-1] - relative[0]
    if change == 0.0:
        return _ELASTIC
    ratio = -(zeta[-1] - zeta[0]) / change
    friction = float(np.clip(ratio / _FRICTION_RATIO, 0.0, 1.0))
    return _ELASTIC + friction * (_MASING - _ELASTIC)


def model_errors(
    fit: BandFit, mode: ModeState, level: FloatArray, slope: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return standard uncertainties of ln omega and ln zeta that no residual shows.

    Args:
        fit: of the band.
        mode: of the fit, with curves.
        level: L where they are asked for, ascending, shape (n,).
        slope: d ln omega / dL there, shape (n,).
    """
    omega, zeta = _interaction(fit, mode, level)
    return (
        _INTERACTION_SD * omega,
        np.hypot(_INTERACTION_SD * zeta, _ENERGY_SD * slope),
    )


def _interaction(
    fit: BandFit, mode: ModeState, level: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return how far other modes on the joint move ln omega and ln zeta, rms over hits.

    At each L, over the hits that pass it, at the time when they do.
    """
    none = np.zeros(level.size)
    if not mode.log_weights.size:
        return none, none
    flow = decays(mode, fit.lines.panels, fit.lines.centre, 0).level
    moved = []
    for weights, curve in zip(
        np.exp(mode.log_weights), (mode.log_omega, mode.log_zeta), strict=True
    ):
        both = 0.5 * np.log(np.exp(2.0 * flow) + mode.squares @ weights)
        table = mode.basis.values @ curve
        change = np.interp(both, mode.basis.grid, table) - np.interp(
            flow, mode.basis.grid, table
        )
        squares = [
            np.interp(level, own[::-1], one[::-1] ** 2, left=np.nan, right=np.nan)
            for own, one in zip(flow, change, strict=True)
        ]
        passing = np.isfinite(squares)
        total = np.where(passing, squares, 0.0).sum(axis=0)
        moved.append(np.sqrt(total / np.maximum(passing.sum(axis=0), 1)))
    return moved[0], moved[1]
