# SPDX-License-Identifier: MIT
"""Complex modes and receptances of an assembly, with dampers of any strength.

The equations are projected on the modes at the joints' stiffness, those with the
dampers locked, and the static responses to the loads; the small state matrix gives
poles and residues, and every line is a sum over them.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.analysis.structures.reduction.dense_modes import shifted_inverse
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.receptance_bound import (
    DampedSolution,
    receptance_bound,
)
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    ReducedModes,
    solve_below,
    solve_reduced,
)

# Part of a direction outside of the others below which it is dropped, also of the
# responses that follow decays.
_DEPENDENT, _DECAY_DEPENDENT = 1e-7, 1e-6
# Modes are kept up to this multiple of the highest line.
_REACH = 1.2
# Terms of the series of the response to a load.
_TERMS = 4
# Dampers are light if the largest damping ratio of a mode stays below this.
_LIGHT = 0.02
# Strong dampers: positive real s, as shares of the highest line, at which responses are
# solved exactly; they follow decays.
_DECAYS = np.geomspace(0.05, 3.0, 10)
# The bound is that of a projection on the modes up to this multiple of the last line.
_BOUND_REACH = 2.5
# ... and on those with dampers replaced by springs at these shares of that line.
_BOUND_LOCKED = (1.0, 0.1)
# Lines whose terms of all poles stay in the cache.
_LINES_AT_ONCE = 125
# Least ratio of imaginary to real part of an oscillating pole.
_SWINGS = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class DampedModes:
    """Modes of a damped assembly, the lowest first.

    Attributes:
        pole: [1/s], shape (n_modes,); with positive imaginary part, or real.
        shapes: in the coordinates of the model, columns, largest entry 1, shape (r,
            n_modes).
    """

    pole: ComplexArray
    shapes: ComplexArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "pole", "shapes")

    @property
    def natural_frequency(self) -> FloatArray:
        """|pole| / 2 pi [Hz]."""
        return np.asarray(np.abs(self.pole) / (2.0 * np.pi))

    @property
    def damping_ratio(self) -> FloatArray:
        """-Re pole / |pole| [-]; of a decay without oscillation it is 1."""
        return np.asarray(-self.pole.real / np.maximum(np.abs(self.pole), 1e-300))

    @property
    def overdamped(self) -> FloatArray:
        """Whether a pole is a decay without oscillation."""
        return np.asarray(np.abs(self.pole.imag) <= _SWINGS * np.abs(self.pole.real))


@dataclass(frozen=True, slots=True, eq=False)
class _Projected:
    """Second-order matrices over a few orthonormal directions; the mass is unit.

    Attributes:
        space: the directions as columns, shape (r, m).
        stiffness: with structural damping [1/s^2], shape (m, m).
        damping: viscous [1/s], shape (m, m).
    """

    space: FloatArray
    stiffness: ComplexArray
    damping: FloatArray


def damping_matrix(model: ReducedModel, values: JointValues) -> FloatArray:
    """Return viscous damping of bodies, springs and joints [1/s], shape (r, r)."""
    return np.asarray(model.damping + model.spread.total(values.damping))


def project(
    model: ReducedModel,
    values: JointValues,
    top: float,
    loads: FloatArray,
    more: tuple[ReducedModes, FloatArray] | None = None,
) -> _Projected:
    """Project on modes up to a frequency [rad/s] and on responses to loads.

    Strong dampers hold their joints: then also on responses at real s, or without loads
    on the modes with the dampers locked.

    Args:
        model: of the assembly.
        values: of its joints.
        top: highest line [rad/s].
        loads: columns, shape (r, n_loads).
        more: undamped modes at these values, and further directions; None finds the
            modes up to the line.
    """
    stiffness = values.stiffness
    found = more[0] if more else solve_below(model, stiffness, (_REACH * top) ** 2)
    viscous = damping_matrix(model, values)
    omega = np.sqrt(np.maximum(found.eigenvalue, model.shift))
    ratio = np.einsum("rm,rm->m", found.shapes, viscous @ found.shapes) / omega
    whole = model.with_joints(stiffness)
    if 0.5 * ratio.max(initial=0.0) <= _LIGHT:
        space = _with_responses(whole, model.shift, found.shapes, loads)
    elif loads.shape[1]:
        space = _with_decays(whole, viscous, top, found.shapes, loads)
    else:
        locked = solve_below(model, stiffness + top * values.damping, top**2)
        space = _joined(found.shapes, locked.shapes)
    if more:
        space = _joined(space, more[1])
    small = space.T @ (whole @ space) + 1j * (space.T @ (model.loss @ space))
    small[: found.rigid] = small[:, : found.rigid] = 0.0
    return _Projected(space, small, space.T @ (viscous @ space))


def _with_decays(
    whole: FloatArray,
    viscous: FloatArray,
    top: float,
    space: FloatArray,
    loads: FloatArray,
) -> FloatArray:
    """Append the responses to loads at positive real s up to twice a line [rad/s]."""
    dynamic = np.empty_like(whole)
    # One by one: together, their small differences would count as rounding.
    for s in (top * _DECAYS).tolist():
        np.multiply(viscous, s, out=dynamic)
        dynamic += whole
        new = shifted_inverse(dynamic, s**2)(loads)
        space = _joined(space, new, _DECAY_DEPENDENT)
    return space


def _with_responses(
    whole: FloatArray, shift: float, space: FloatArray, loads: FloatArray
) -> FloatArray:
    """Append the response to loads at the shift, and the next terms of its series."""
    if not loads.shape[1]:
        return space
    solve = shifted_inverse(whole, shift)
    new = loads
    for _ in range(_TERMS):
        count = space.shape[1]
        space = _joined(space, solve(new))
        new = space[:, count:]
        if not new.shape[1]:
            break
    return space


def _joined(
    space: FloatArray, new: FloatArray, least: float = _DEPENDENT
) -> FloatArray:
    new = new / np.maximum(np.linalg.norm(new, axis=0), 1e-300)
    for limit in (least, 0.5):
        new = new - space @ (space.T @ new)
        vector, size, _ = np.linalg.svd(new, full_matrices=False)
        new = vector[:, size > limit]
    return np.concatenate([space, new], axis=1)


def complex_modes(model: ReducedModel, values: JointValues) -> DampedModes:
    """Find the modes of a damped assembly.

    Args:
        model: of the assembly.
        values: of its joints.

    Returns:
        Oscillating modes and decays, at most twice the number of modes of the model,
        by |pole|; rigid motions are left out.

    Source:
        Ewins, Modal Testing (2000), sec. 2.7.
    """
    top = float(np.sqrt(solve_reduced(model, values.stiffness).eigenvalue[-1]))
    small = project(model, values, top, np.zeros((model.size, 0)))
    count = small.damping.shape[0]
    pole, vector = np.linalg.eig(_state_matrix(small))
    size = np.abs(pole)
    kept = (size > 1e-9 * np.sqrt(model.shift)) & (
        pole.imag > -_SWINGS * np.abs(pole.real)
    )
    order = np.flatnonzero(kept)[np.argsort(size[kept])][: 2 * model.modes]
    shapes = small.space @ vector[:count, order]
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(order.size)]
    return DampedModes(pole[order], shapes / largest)


def _state_matrix(small: _Projected) -> ComplexArray:
    """Return the matrix of displacement and velocity, shape (2 m, 2 m)."""
    count = small.damping.shape[0]
    state = np.zeros((2 * count, 2 * count), complex)
    state[:count, count:] = np.eye(count)
    state[count:, :count] = -small.stiffness
    state[count:, count:] = -small.damping
    return state


def receptance(
    model: ReducedModel,
    values: JointValues,
    laplace: ComplexArray,
    outputs: FloatArray,
    inputs: FloatArray,
) -> ComplexArray:
    """Return receptances at many lines.

    Args:
        model: of the assembly.
        values: of its joints.
        laplace: lines [1/s], shape (n_lines,).
        outputs: rows from the coordinates of the model, shape (n_outputs, r).
        inputs: the same of the forces, shape (n_inputs, r).

    Returns:
        [m/N], shape (n_outputs, n_inputs, n_lines).
    """
    top = float(np.abs(laplace).max(initial=0.0))
    loads = np.concatenate([outputs, inputs]).T
    small = project(model, values, top, _distinct(loads))
    count = small.damping.shape[0]
    still = _uncoupled(small)
    moving = np.arange(still, count)
    inner = _Projected(
        small.space[:, moving],
        small.stiffness[np.ix_(moving, moving)],
        small.damping[np.ix_(moving, moving)],
    )
    out, into = outputs @ small.space, inputs @ small.space
    pole, vector = np.linalg.eig(_state_matrix(inner))
    force = np.zeros((2 * moving.size, inputs.shape[0]), complex)
    force[moving.size :] = into[:, moving].T
    weight = np.linalg.solve(vector, force)
    residue = (out[:, moving] @ vector[: moving.size])[:, None] * weight.T
    found = _sum_over_poles(residue.reshape(-1, pole.size), pole, laplace)
    rigid = (out[:, :still] @ into[:, :still].T)[:, :, None] / laplace**2
    shape = (outputs.shape[0], inputs.shape[0], laplace.size)
    return np.asarray(found.reshape(shape) + (rigid if still else 0.0))


def _sum_over_poles(
    residue: ComplexArray, pole: ComplexArray, laplace: ComplexArray
) -> ComplexArray:
    """Return the sums of residue / (s - pole), shape (n_rows, n_lines)."""
    found = np.empty((residue.shape[0], laplace.size), complex)
    for begin in range(0, laplace.size, _LINES_AT_ONCE):
        some = slice(begin, begin + _LINES_AT_ONCE)
        found[:, some] = residue @ _over_lines(laplace[some], pole)
    return found


def _over_lines(laplace: ComplexArray, pole: ComplexArray) -> ComplexArray:
    """Return 1 / (s - pole), shape (n_poles, n_lines).

    In real arithmetic: a complex division takes four times as long.
    """
    real = laplace.real - pole.real[:, None]
    imaginary = laplace.imag - pole.imag[:, None]
    inverse = 1.0 / (real * real + imaginary * imaginary)
    found = np.empty(inverse.shape, complex)
    np.multiply(real, inverse, out=found.real)
    np.multiply(imaginary, -inverse, out=found.imag)
    return found


def _uncoupled(small: _Projected) -> int:
    """Return the number of first directions with neither stiffness nor damping."""
    held = np.abs(small.damping).max(axis=0) + np.abs(small.stiffness).max(axis=0)
    free = held <= 1e-12 * held.max(initial=0.0)
    return int(np.argmin(free)) if not free.all() else int(free.size)


def _distinct(loads: FloatArray) -> FloatArray:
    """Return an orthonormal basis of load vectors, which often repeat."""
    vector, size, _ = np.linalg.svd(loads, full_matrices=False)
    return np.asarray(vector[:, size > _DEPENDENT * size.max(initial=0.0)])


def frf_bound(
    model: ReducedModel,
    values: JointValues,
    omega: FloatArray,
    rows: FloatArray,
    load: tuple[int, slice],
) -> FloatArray:
    """Bound the error of `receptance` between the rows of a port.

    It is the change by a projection on more modes, and the bound of that one's error.

    Args:
        model: of the assembly.
        values: of its joints.
        omega: lines [rad/s], shape (n_lines,); the highest sets the projection.
        rows: of the port from the coordinates of the model, shape (n_rows, r).
        load: number of its body, and its pattern columns.

    Returns:
        [m/N], shape (n_rows, n_rows, n_lines).
    """
    top = float(omega.max(initial=0.0))
    small = project(model, values, top, _distinct(rows.T), _wider(model, values, top))
    level, turn = np.linalg.eigh(small.stiffness.real)
    level = np.maximum(level, 0.0)
    modal = _Projected(
        small.space @ turn,
        turn.T @ small.stiffness @ turn,
        turn.T @ small.damping @ turn,
    )
    count = level.size
    pole, vector = np.linalg.eig(_state_matrix(modal))
    force = np.zeros((2 * count, rows.shape[0]), complex)
    force[count:] = (rows @ modal.space).T
    weight = np.linalg.solve(vector, force)
    laplace = np.asarray(1j * omega, complex)
    lines = _over_lines(laplace, pole)
    response = np.stack(
        [vector[:count] @ (one[:, None] * lines) for one in weight.T], axis=1
    )
    few = replace(
        model,
        loss=modal.stiffness.imag,
        residual=model.residual.restricted(modal.space),
    )
    solution = DampedSolution(
        model=few,
        values=values,
        eigenvalue=level,
        shapes=np.eye(count),
        damping=modal.damping,
        modal_damping=np.zeros(count),
        structural=True,
        poles=pole,
        vectors=vector[:count],
    )
    better = np.einsum("or,ril->oil", rows @ modal.space, response)
    apart = np.abs(receptance(model, values, laplace, rows, rows) - better)
    return np.asarray(apart + receptance_bound(solution, load, response, omega))


def _wider(
    model: ReducedModel, values: JointValues, top: float
) -> tuple[ReducedModes, FloatArray]:
    """Return modes beyond the last line, and those with the dampers locked."""
    limit = (_BOUND_REACH * top) ** 2
    found = solve_reduced(model, values.stiffness, model.size)
    kept = max(int(np.searchsorted(found.eigenvalue, limit)), found.rigid)
    modes = ReducedModes(
        found.eigenvalue[:kept],
        found.natural_frequency[:kept],
        found.shapes[:, :kept],
        found.rigid,
    )
    locked = [
        solve_below(model, values.stiffness + share * top * values.damping, limit)
        for share in _BOUND_LOCKED
        if values.damping.any()
    ]
    none = np.zeros((model.size, 0))
    return modes, np.concatenate([none, *(one.shapes for one in locked)], axis=1)
