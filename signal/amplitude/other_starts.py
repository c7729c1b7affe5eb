# SPDX-License-Identifier: MIT
"""A fitted mode as the start of another fit: other channels, knots, or a later time."""

from dataclasses import replace

import numpy as np

from jointbench.signal.amplitude.band_lines import BandLines
from jointbench.signal.amplitude.curve_basis import CurveBasis, spline_basis
from jointbench.signal.amplitude.mode_state import ModeState
from jointbench.signal.amplitude.slow_flow import decays


def carried_over(
    modes: tuple[ModeState, ...], old: BandLines, new: BandLines
) -> tuple[ModeState, ...]:
    """Return modes with their shapes in the virtual channels of other lines.

    The carrier must be the same, so that amplitudes keep their meaning.
    """
    turn = new.reduction @ old.mixing
    found = []
    for mode in modes:
        shape = turn @ mode.shape
        reference = int(np.argmax(np.abs(shape)))
        turned = mode.turn
        if turned.size:
            turned = turn @ turned
            # What turns alike in all channels is amplitude.
            turned = turned - shape * (turned[reference] / shape[reference])
        found.append(replace(mode, shape=shape, reference=reference, turn=turned))
    return tuple(found)


def with_knots(mode: ModeState, like: CurveBasis, pitch: float) -> ModeState:
    """Return a mode with its curves on splines over another range.

    Args:
        mode: with curves.
        like: whose range of L is taken.
        pitch: wanted distance of the knots in L.
    """
    basis = spline_basis(float(like.grid[0]), like.low, like.high, pitch)
    old = mode.basis.at(basis.grid)
    both = np.stack((old @ mode.log_omega, old @ mode.log_zeta), axis=1)
    # A trace of the penalty decides what lies beyond the old range.
    matrix = basis.values.T @ basis.values + 1e-6 * basis.penalty
    curves = np.asarray(np.linalg.solve(matrix, basis.values.T @ both), float)
    # Squares of second differences go with the third power of the pitch.
    scale = (mode.basis.pitch / basis.pitch) ** 3
    return replace(
        mode,
        basis=basis,
        log_omega=curves[:, 0],
        log_zeta=curves[:, 1],
        weights=(mode.weights[0] * scale, mode.weights[1] * scale),
    )


def begun_later(
    mode: ModeState, old: BandLines, new: BandLines, delay: float
) -> ModeState:
    """Return a mode as it is some time after the start of the decays.

    Args:
        mode: as fitted.
        old: lines that it was fitted to.
        new: lines from the later start.
        delay: [s].
    """
    flow = decays(mode, old.panels, old.centre, 0)
    time = old.time
    level = [np.interp(delay, time, row) for row in flow.level]
    # Beside the carrier phases turn slowly.
    phase = [np.interp(delay, time, row) for row in np.unwrap(np.angle(flow.signal))]
    squares = np.log(mode.squares + 1e-300)
    moved = [
        [np.interp(new.time + delay, time, squares[hit, :, one]) for one in range(n)]
        for hit in range(squares.shape[0])
        if (n := squares.shape[2])
    ]
    if moved:
        mode = replace(mode, squares=np.exp(np.array(moved)).transpose(0, 2, 1))
    return replace(
        mode,
        start=np.array(level),
        phase=np.array(phase) + old.centre * delay,
    )
