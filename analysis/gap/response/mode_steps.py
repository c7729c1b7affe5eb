# SPDX-License-Identifier: MIT
"""Compiled steps of the modes between the ports of a linear model.

A mode is integrated exactly for port forces that are linear within a step (first-order
hold). Its state is scaled so that the real part is the displacement at one of its
ports. With one port, its force drives each mode directly and its motion is the sum of
the real parts; with several, a mode is driven by the forces through its inputs and
moves each port through its shape.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.response.law_forces import (
    DEFECT,
    FORCE,
    GUESS,
    HOLD,
    LANES,
    LEAN,
    MOTION,
    PORT,
    SLOPE,
    SPEED,
)

_REAL, _IMAGINARY, _TURN, _QUARTER, _START, _START_I, _END, _END_I, _POLE, _POLE_I = (
    i * LANES for i in range(10)
)
"""Offsets within a mode: its state, growth, hold weights and pole (re, im)."""
_ONE_PORT_MODE = 10 * LANES
_OLD, _OLD_I, _NEW, _NEW_I = (i * LANES for i in range(10, 14))
"""With several ports: drive at the start and, estimated, at the end of the step."""
_PORTS = 14 * LANES
_INPUT, _INPUT_I, _SHAPE, _SHAPE_I = (i * LANES for i in range(4))
"""Offsets within the port of a mode."""
_AT_PORT = 4 * LANES


@compiled(forceinline=True)
def mode_size(n_ports: int) -> int:
    """Return the size of a mode in the state of the lanes."""
    return _ONE_PORT_MODE if n_ports == 1 else _PORTS + n_ports * _AT_PORT


@compiled()
def resting_state(
    poles: ComplexArray,
    gains: ComplexArray,
    inputs: ComplexArray,
    shapes: ComplexArray,
    dt: float,
) -> FloatArray:
    """Return the initial state of the lanes, at rest.

    The ports come first, then the modes, then, for several ports, the change of the
    speed of each port per unit force at each other one within a step.

    Args:
        poles: [rad/s], shape (n_modes, LANES).
        gains: of each mode [m/N rad/s], same shape.
        inputs: relative drive by each port, shape (n_modes, n_ports, LANES).
        shapes: relative motion of each port, same shape.
        dt: step [s].
    """
    n_modes, n_ports = inputs.shape[0], inputs.shape[1]
    size = mode_size(n_ports)
    coupled = 0 if n_ports == 1 else n_ports * n_ports * LANES
    beyond = n_ports * PORT + n_modes * size
    w = np.zeros(beyond + coupled)
    for m in range(n_modes):
        for k in range(LANES):
            at, pole = n_ports * PORT + m * size + k, poles[m, k]
            z = pole * dt
            growth = np.exp(z)
            end = gains[m, k] * dt * (growth - 1.0 - z) / (z * z)
            start = gains[m, k] * dt * (growth - 1.0) / z - end
            w[at + _TURN], w[at + _QUARTER] = growth.real, growth.imag
            w[at + _START], w[at + _START_I] = start.real, start.imag
            w[at + _END], w[at + _END_I] = end.real, end.imag
            w[at + _POLE], w[at + _POLE_I] = pole.real, pole.imag
            for p in range(n_ports):
                push = end * inputs[m, p, k]
                own = push * shapes[m, p, k]
                slope = own.real * pole.real - own.imag * pole.imag
                w[p * PORT + SLOPE + k] += slope
                held = (start + end) * inputs[m, p, k] * shapes[m, p, k] * pole
                w[p * PORT + HOLD + k] += held.real
                if n_ports == 1:
                    continue
                there = at + _PORTS + p * _AT_PORT
                drive, shape = inputs[m, p, k], shapes[m, p, k]
                w[there + _INPUT], w[there + _INPUT_I] = drive.real, drive.imag
                w[there + _SHAPE], w[there + _SHAPE_I] = shape.real, shape.imag
                for q in range(n_ports):
                    moved = push * shapes[m, q, k] * pole
                    w[beyond + (q * n_ports + p) * LANES + k] += moved.real
    return w


@compiled(fastmath=True, forceinline=True)
def predict_one_port(w: FloatArray, n_modes: int) -> None:
    """Advance the modes with an estimated force; add them to the motion of the port."""
    for m in range(n_modes):
        at = PORT + m * _ONE_PORT_MODE
        for k in range(LANES):
            x, y = w[at + _REAL + k], w[at + _IMAGINARY + k]
            turn, quarter = w[at + _TURN + k], w[at + _QUARTER + k]
            old, change = w[FORCE + k], w[GUESS + k]
            moved = turn * x - quarter * y
            moved -= w[at + _START + k] * old + w[at + _END + k] * change
            w[at + _IMAGINARY + k] = (
                turn * y
                + quarter * x
                - w[at + _START_I + k] * old
                - w[at + _END_I + k] * change
            )
            w[at + _REAL + k] = moved
            w[MOTION + k] += moved


@compiled(fastmath=True, forceinline=True)
def add_speed_one_port(w: FloatArray, n_modes: int) -> None:
    """Add the speed of the modes to that of the port."""
    for m in range(n_modes):
        for k in range(LANES):
            at = PORT + m * _ONE_PORT_MODE + k
            w[SPEED + k] += w[at + _POLE] * w[at + _REAL]
            w[SPEED + k] -= w[at + _POLE_I] * w[at + _IMAGINARY]


@compiled(fastmath=True, forceinline=True)
def correct_one_port(w: FloatArray, n_modes: int, uneven: bool) -> None:
    """Correct the modes by the force minus its estimate, which is in `GUESS`.

    Args:
        w: state of the lanes; changed in place.
        n_modes: number of modes.
        uneven: True if the force may jump or bend within a step.
    """
    if uneven:
        _push_one_port(w, n_modes)
    for m in range(n_modes):
        for k in range(LANES):
            at = PORT + m * _ONE_PORT_MODE + k
            w[at + _REAL] -= w[at + _END] * w[GUESS + k]
            w[at + _IMAGINARY] -= w[at + _END_I] * w[GUESS + k]


@compiled(fastmath=True, forceinline=True)
def _push_one_port(w: FloatArray, n_modes: int) -> None:
    """Move the modes by what the force of the step exceeds a straight line by.

    A line has the same mean and first moment.
    """
    for m in range(n_modes):
        for k in range(LANES):
            at = PORT + m * _ONE_PORT_MODE + k
            lean = 6.0 * w[LEAN + k]
            start, end = w[DEFECT + k] - lean, w[DEFECT + k] + lean
            w[at + _REAL] -= w[at + _START] * start + w[at + _END] * end
            w[at + _IMAGINARY] -= w[at + _START_I] * start + w[at + _END_I] * end


@compiled(fastmath=True, forceinline=True)
def _push_ports(w: FloatArray, n_modes: int, n_ports: int) -> None:
    """Move the modes by what the forces of the step exceed straight lines by."""
    for m in range(n_modes):
        at = n_ports * PORT + m * mode_size(n_ports)
        for k in range(LANES):
            start, start_i, end, end_i = 0.0, 0.0, 0.0, 0.0
            for p in range(n_ports):
                there, own = at + _PORTS + p * _AT_PORT + k, p * PORT + k
                mean, lean = w[own + DEFECT], 6.0 * w[own + LEAN]
                start += w[there + _INPUT] * (mean - lean)
                start_i += w[there + _INPUT_I] * (mean - lean)
                end += w[there + _INPUT] * (mean + lean)
                end_i += w[there + _INPUT_I] * (mean + lean)
            own = at + k
            w[own + _REAL] -= w[own + _START] * start - w[own + _START_I] * start_i
            w[own + _REAL] -= w[own + _END] * end - w[own + _END_I] * end_i
            w[own + _IMAGINARY] -= w[own + _START] * start_i + w[own + _START_I] * start
            w[own + _IMAGINARY] -= w[own + _END] * end_i + w[own + _END_I] * end


@compiled(fastmath=True, forceinline=True)
def _drive(w: FloatArray, at: int, n_ports: int) -> None:
    """Write the drive of a mode by `GUESS` of all ports to its `_NEW`."""
    for k in range(LANES):
        w[at + _NEW + k] = 0.0
        w[at + _NEW_I + k] = 0.0
    for p in range(n_ports):
        there, guess = at + _PORTS + p * _AT_PORT, p * PORT + GUESS
        for k in range(LANES):
            w[at + _NEW + k] += w[there + _INPUT + k] * w[guess + k]
            w[at + _NEW_I + k] += w[there + _INPUT_I + k] * w[guess + k]


@compiled(fastmath=True, forceinline=True)
def predict_ports(w: FloatArray, n_modes: int, n_ports: int) -> None:
    """Advance the modes with estimated forces; add them to the motion of all ports."""
    for m in range(n_modes):
        at = n_ports * PORT + m * mode_size(n_ports)
        _drive(w, at, n_ports)
        for k in range(LANES):
            x, y = w[at + _REAL + k], w[at + _IMAGINARY + k]
            turn, quarter = w[at + _TURN + k], w[at + _QUARTER + k]
            start, start_i = w[at + _START + k], w[at + _START_I + k]
            end, end_i = w[at + _END + k], w[at + _END_I + k]
            old, old_i = w[at + _OLD + k], w[at + _OLD_I + k]
            new, new_i = w[at + _NEW + k], w[at + _NEW_I + k]
            held = start * old - start_i * old_i + end * new - end_i * new_i
            held_i = start * old_i + start_i * old + end * new_i + end_i * new
            w[at + _REAL + k] = turn * x - quarter * y - held
            w[at + _IMAGINARY + k] = turn * y + quarter * x - held_i
            w[at + _OLD + k] = new
            w[at + _OLD_I + k] = new_i
        for p in range(n_ports):
            there, motion = at + _PORTS + p * _AT_PORT, p * PORT + MOTION
            for k in range(LANES):
                w[motion + k] += w[there + _SHAPE + k] * w[at + _REAL + k]
                w[motion + k] -= w[there + _SHAPE_I + k] * w[at + _IMAGINARY + k]


@compiled(fastmath=True, forceinline=True)
def add_speed_ports(w: FloatArray, n_modes: int, n_ports: int) -> None:
    """Add the speed of the modes to that of all ports."""
    for m in range(n_modes):
        at = n_ports * PORT + m * mode_size(n_ports)
        for p in range(n_ports):
            there, speed = at + _PORTS + p * _AT_PORT, p * PORT + SPEED
            for k in range(LANES):
                x, y = w[at + _REAL + k], w[at + _IMAGINARY + k]
                pole, pole_i = w[at + _POLE + k], w[at + _POLE_I + k]
                w[speed + k] += w[there + _SHAPE + k] * (pole * x - pole_i * y)
                w[speed + k] -= w[there + _SHAPE_I + k] * (pole * y + pole_i * x)


@compiled(fastmath=True, forceinline=True)
def correct_ports(w: FloatArray, n_modes: int, n_ports: int, uneven: bool) -> None:
    """Correct the modes by the forces minus their estimates, which are in `GUESS`."""
    if uneven:
        _push_ports(w, n_modes, n_ports)
    for m in range(n_modes):
        at = n_ports * PORT + m * mode_size(n_ports)
        _drive(w, at, n_ports)
        for k in range(LANES):
            end, end_i = w[at + _END + k], w[at + _END_I + k]
            new, new_i = w[at + _NEW + k], w[at + _NEW_I + k]
            w[at + _REAL + k] -= end * new - end_i * new_i
            w[at + _IMAGINARY + k] -= end * new_i + end_i * new
            w[at + _OLD + k] += new
            w[at + _OLD_I + k] += new_i
