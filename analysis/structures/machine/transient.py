# SPDX-License-Identifier: MIT
"""Response to loads over time in complex modal coordinates, in closed form.

Each pole is one first-order equation. Harmonic parts have an exact steady state; what
remains is a decay from the initial state, and exact steps for loads that are linear in
between. There is no error of a time step, whatever its length.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.array_checks import require_positive
from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.machine.complex_modes import PoleSet
from jointbench.analysis.structures.machine.loads import (
    Begin,
    HarmonicLoad,
    Load,
    TableLoad,
)

# Below this size of pole times step, series replace differences that cancel.
_SMALL = 1e-2
_SERIES = 8
# States below this are zero, whatever their unit.
_NOTHING = 1e-200
_MOST_SAMPLES = 20_000_000


def transient(
    poles: PoleSet,
    loads: Sequence[Load],
    *,
    duration: float,
    step: float,
    begin: Begin = Begin.REST,
) -> tuple[FloatArray, FloatArray]:
    """Return the motion of the outputs under loads.

    Args:
        poles: of the structure; poles left out respond statically.
        loads: which act together.
        duration: [s].
        step: between samples of the result [s]; it has no effect on their accuracy.
        begin: from rest, or in the steady state of the harmonic parts and in static
            equilibrium with the first values of the tables.

    Returns:
        Time [s], shape (n,), and displacement [m], shape (n_outputs, n).

    Raises:
        BadData: duration or step are not above zero, there are too many samples, or a
            load acts on an input that there is not.

    Source:
        Exact integration of linear equations under piecewise linear load: Moler and Van
        Loan 2003, SIAM Rev. 45, 3-49, sec. 2; first-order hold.
    """
    require_positive("duration", duration)
    require_positive("step", step)
    count = int(np.floor(duration / step * (1.0 + 1e-12))) + 1
    if count * poles.outputs.shape[0] > _MOST_SAMPLES:
        raise BadData(
            f"{count} samples of {poles.outputs.shape[0]} outputs; at most "
            f"{_MOST_SAMPLES} values: choose a longer step"
        )
    _require_inputs(poles, loads)
    harmonic = [one for one in loads if isinstance(one, HarmonicLoad)]
    tables = [one for one in loads if isinstance(one, TableLoad)]
    time = np.asarray(step * np.arange(count), np.float64)
    motion = _steady_motion(poles, harmonic, time)
    forces = np.zeros((poles.inputs.shape[1], count))
    for one in tables:
        forces[one.input] += one.at(time)
    motion += poles.residual @ forces
    start = -_steady_state(poles, harmonic)
    if begin is Begin.STEADY:
        start = poles.inputs @ forces[:, 0].astype(complex) / -poles.poles
    extra = _between(poles, tables, time)
    return time, motion + _decay(poles, start, forces, step, extra)


def _require_inputs(poles: PoleSet, loads: Sequence[Load]) -> None:
    for one in loads:
        if not 0 <= one.input < poles.inputs.shape[1]:
            raise BadData(
                f"a load acts on input {one.input}; there are {poles.inputs.shape[1]}"
            )


def _phasors(
    poles: PoleSet, loads: Sequence[HarmonicLoad]
) -> list[tuple[float, ComplexArray]]:
    """Return rate and force vector U of each load: Re(U exp(j rate t))."""
    found = []
    for one in loads:
        force = np.zeros(poles.inputs.shape[1], complex)
        force[one.input] = -1j * one.amplitude * np.exp(1j * one.phase)
        found.append((one.rate, force))
    return found


def _steady_motion(
    poles: PoleSet, loads: Sequence[HarmonicLoad], time: FloatArray
) -> FloatArray:
    motion = np.zeros((poles.outputs.shape[0], time.size))
    for rate, force in _phasors(poles, loads):
        line = poles.receptance(np.array([rate / (2.0 * np.pi)]))[:, :, 0]
        answer = line @ force
        turn = rate * time
        motion += np.outer(answer.real, np.cos(turn))
        motion -= np.outer(answer.imag, np.sin(turn))
    return motion


def _steady_state(poles: PoleSet, loads: Sequence[HarmonicLoad]) -> ComplexArray:
    """Return the modal coordinates of the steady state at time zero."""
    state = np.zeros(poles.poles.size, complex)
    for rate, force in _phasors(poles, loads):
        state += 0.5 * (poles.inputs @ force) / (1j * rate - poles.poles)
        state += 0.5 * (poles.inputs @ force.conj()) / (-1j * rate - poles.poles)
    return state


def _weights(change: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return (e^z - 1)/z and (e^z - 1 - z)/z^2, small z by their series."""
    z = np.where(np.abs(change) < _SMALL, 1.0, change)
    first, second = np.expm1(z) / z, (np.expm1(z) - z) / z**2
    term = np.ones_like(change)
    one, two = np.zeros_like(change), np.zeros_like(change)
    for n in range(_SERIES):
        one += term / (n + 1)
        two += term / ((n + 1) * (n + 2))
        term = term * change / (n + 1)
    small = np.abs(change) < _SMALL
    return np.where(small, one, first), np.where(small, two, second)


def _linear_step(
    poles: PoleSet, step: float
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return the factors of state, first and last force over one step."""
    change = poles.poles * step
    first, second = _weights(change)
    return np.exp(change), step * (first - second), step * second


def _between(
    poles: PoleSet, tables: Sequence[TableLoad], time: FloatArray
) -> dict[int, ComplexArray]:
    """Return what points of tables between samples add to the state, by step."""
    added: dict[int, ComplexArray] = {}
    step = time[1] - time[0] if time.size > 1 else 1.0
    for one in tables:
        inside = one.time[(one.time > 0.0) & (one.time < time[-1])]
        place = inside / step
        off = inside[np.abs(place - np.round(place)) > 1e-9]
        for at in np.unique((off / step).astype(int)).tolist():
            knots = off[(off / step).astype(int) == at]
            line = np.concatenate([[time[at]], knots, [time[at + 1]]])
            exact = _stretch(poles, one, line) - _stretch(poles, one, line[[0, -1]])
            added[at] = added.get(at, 0.0) + exact
    return added


def _stretch(poles: PoleSet, load: TableLoad, line: FloatArray) -> ComplexArray:
    """Return the state at the end of a line of times, from zero at its beginning."""
    state = np.zeros(poles.poles.size, complex)
    force = load.at(line)
    drive = poles.inputs[:, load.input]
    for at, long in enumerate(np.diff(line)):
        grow, first, last = _linear_step(poles, float(long))
        state = grow * state + drive * (first * force[at] + last * force[at + 1])
    return state


def _decay(
    poles: PoleSet,
    start: ComplexArray,
    forces: FloatArray,
    step: float,
    extra: dict[int, ComplexArray],
) -> FloatArray:
    """Return the part of the motion that the states of the poles make."""
    grow, first, last = _linear_step(poles, step)
    weight = np.where(poles.oscillates, 2.0, 1.0)
    shapes = np.ascontiguousarray(poles.outputs * weight)
    motion = np.zeros((shapes.shape[0], forces.shape[1]))
    steps = np.array(sorted(extra), np.int64)
    jumps = np.array([extra[at] for at in steps.tolist()], complex)
    used = np.flatnonzero(np.any(forces != 0.0, axis=1))
    _integrate(
        motion,
        start.copy(),
        (grow, shapes),
        (
            np.ascontiguousarray(poles.inputs[:, used] * first[:, None]),
            np.ascontiguousarray(poles.inputs[:, used] * last[:, None]),
        ),
        np.ascontiguousarray(forces[used]),
        (steps, jumps.reshape(-1, start.size)),
    )
    return motion


@compiled()
def _integrate(
    motion: FloatArray,
    state: ComplexArray,
    modes: tuple[ComplexArray, ComplexArray],
    drives: tuple[ComplexArray, ComplexArray],
    forces: FloatArray,
    extra: tuple[np.ndarray[tuple[int, ...], np.dtype[np.int64]], ComplexArray],
) -> None:  # pragma: no cover - compiled
    grow, shapes = modes
    first, last = drives
    steps, jumps = extra
    following = 0
    for at in range(motion.shape[1]):
        for r in range(state.size):
            value = state[r]
            for o in range(motion.shape[0]):
                motion[o, at] += (
                    shapes[o, r].real * value.real - shapes[o, r].imag * value.imag
                )
            value = value * grow[r]
            # Denormal numbers of a long decay would take most of the time.
            if abs(value.real) + abs(value.imag) < _NOTHING:
                value = 0j
            if at + 1 < motion.shape[1]:
                for i in range(forces.shape[0]):
                    value += (
                        first[r, i] * forces[i, at] + last[r, i] * forces[i, at + 1]
                    )
            state[r] = value
        if following < steps.size and steps[following] == at:
            for r in range(state.size):
                state[r] += jumps[following, r]
            following += 1
