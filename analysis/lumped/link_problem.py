# SPDX-License-Identifier: MIT
"""The least-squares problem of a joint identification.

Unknowns: ln stiffness of the unknown links, their damping over a common scale (linear,
since it may be zero), and ln mass of every body whose mass is not exact. Rows: measured
minus predicted over its standard deviation; a weighed mass, or a stiffness or damping
known beforehand, is one more measurement.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.lumped.lumped_matrices import incidence
from jointbench.analysis.lumped.lumped_model import LumpedModel, require_tested_masses
from jointbench.analysis.lumped.lumped_modes import mode_derivatives, modes_of
from jointbench.analysis.lumped.measured_modes import MeasuredModes


@dataclass(frozen=True, slots=True, eq=False)
class JointProblem:
    """Unknowns, measured modes, and their assignment.

    Attributes:
        model: start values of the unknowns, fixed values of the rest.
        measured: modes with uncertainty.
        mode_numbers: index of the model's mode for each measured one.
        stiff: indices of the links with unknown stiffness.
        damped: indices of the links with unknown damping.
        weighed: indices of the bodies whose mass is not exact.
        damping_scale: unit of the damping unknowns [N s/m].
        outputs: degree of freedom of each measured output.
    """

    model: LumpedModel
    measured: MeasuredModes
    mode_numbers: IntArray
    stiff: IntArray
    damped: IntArray
    weighed: IntArray
    damping_scale: float
    outputs: IntArray

    @property
    def size(self) -> int:
        """Number of unknowns, masses included."""
        return self.stiff.size + self.damped.size + self.weighed.size

    @property
    def measured_numbers(self) -> int:
        """Number of measured frequencies, damping ratios and shape components."""
        n_modes = self.measured.natural_frequency.size
        each = 1 if self.measured.damping_ratio is None else 2
        if self.measured.shapes is not None:
            each += 2 * (self.outputs.size - 1)
        return n_modes * each


def pose_problem(
    model: LumpedModel,
    measured: MeasuredModes,
    *,
    unknown: Sequence[str] | None = None,
    mode_numbers: Sequence[int] | None = None,
) -> JointProblem:
    """Set up the identification problem.

    Args:
        model: masses; stiffness and damping of the links that are known.
        measured: modes with uncertainty.
        unknown: names of the links to identify; default all.
        mode_numbers: index of the model's oscillating mode, from 0, for each measured
            one; default the lowest.

    Returns:
        The problem; damping is unknown only where damping ratios were measured.

    Raises:
        BadData: more modes than the model can have, or one response given twice.
        UsageError: a link, body or mode number that does not exist, or a body whose
            mass is impossible for a test.
    """
    require_tested_masses(model)
    n_modes = measured.natural_frequency.size
    numbers = np.asarray(
        range(n_modes) if mode_numbers is None else mode_numbers, dtype=np.int64
    )
    _require_numbers(numbers, n_modes, len(model.bodies))
    _require_own_outputs(measured)
    stiff = _links(model, unknown)
    omega = 2 * np.pi * float(np.exp(np.mean(np.log(measured.natural_frequency))))
    mass = float(np.mean([body.mass for body in model.bodies]))
    ratio = 0.01 if measured.damping_ratio is None else measured.damping_ratio.mean()
    return JointProblem(
        model=model,
        measured=measured,
        mode_numbers=numbers,
        stiff=stiff,
        damped=stiff if measured.damping_ratio is not None else stiff[:0],
        weighed=np.flatnonzero([body.mass_spread > 0 for body in model.bodies]),
        damping_scale=float(2 * max(abs(ratio), 1e-6) * mass * omega),
        outputs=np.array([model.index(name) for name in measured.outputs], np.int64),
    )


def model_at(problem: JointProblem, unknowns: FloatArray) -> LumpedModel:
    """Return the model with the values of `unknowns`."""
    log_stiffness, damping, log_mass = split(problem, unknowns)
    links, bodies = list(problem.model.links), list(problem.model.bodies)
    for i, value in zip(problem.stiff, log_stiffness, strict=True):
        links[i] = replace(links[i], stiffness=float(np.exp(value)))
    for i, value in zip(problem.damped, damping, strict=True):
        links[i] = replace(links[i], damping=float(value * problem.damping_scale))
    for i, value in zip(problem.weighed, log_mass, strict=True):
        bodies[i] = replace(bodies[i], mass=float(bodies[i].mass * np.exp(value)))
    return replace(problem.model, bodies=tuple(bodies), links=tuple(links))


def split(
    problem: JointProblem, unknowns: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return ln stiffness, damping over its scale, ln mass over the weighed mass."""
    first, second = problem.stiff.size, problem.stiff.size + problem.damped.size
    return unknowns[:first], unknowns[first:second], unknowns[second:]


def residuals(
    problem: JointProblem, unknowns: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Compare prediction and measurement.

    Args:
        problem: what was measured.
        unknowns: shape (size,).

    Returns:
        Residuals over their standard deviations, shape (n_rows,), and their
        derivatives, shape (n_rows, size); None where the model has too few oscillating
        modes with these values.
    """
    mass, damping, stiffness = matrices = _matrices(problem, unknowns)
    modes = modes_of(mass, damping, stiffness)
    if modes.poles.size <= problem.mode_numbers.max():
        return None
    blocks = []
    for row, number in enumerate(problem.mode_numbers):
        pole, shape = modes.poles[number], modes.shapes[number]
        change = _change(problem, unknowns, pole, mass)
        reference = _reference(problem, row, shape)
        by_pole, by_shape = mode_derivatives(pole, shape, reference, matrices, change)
        blocks.append(_pole_rows(problem, row, pole, by_pole))
        if problem.measured.shapes is not None and problem.outputs.size > 1:
            ratio = shape / shape[reference]
            blocks.append(_shape_rows(problem, row, ratio, by_shape))
    blocks.append(_prior_rows(problem, unknowns))
    values, slopes = zip(*blocks, strict=True)
    return np.concatenate(values), np.concatenate(slopes)


def _matrices(
    problem: JointProblem, unknowns: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the diagonal of M, C and K."""
    log_stiffness, damping, log_mass = split(problem, unknowns)
    mass = np.array([body.mass for body in problem.model.bodies])
    stiff = np.array([link.stiffness for link in problem.model.links])
    damp = np.array([link.damping for link in problem.model.links])
    mass[problem.weighed] *= np.exp(log_mass)
    stiff[problem.stiff] = np.exp(log_stiffness)
    damp[problem.damped] = damping * problem.damping_scale
    rows = incidence(problem.model)
    return mass, (rows.T * damp) @ rows, (rows.T * stiff) @ rows


def _change(
    problem: JointProblem, unknowns: FloatArray, pole: complex, mass: FloatArray
) -> tuple[ComplexArray, FloatArray]:
    """Return the change of dynamic stiffness by each unknown: a and v of a v v^T."""
    rows = incidence(problem.model)
    log_stiffness, damping, _ = split(problem, unknowns)
    factor = np.concatenate(
        [
            np.exp(log_stiffness) + 0j,
            np.full(damping.size, pole * problem.damping_scale),
            pole**2 * mass[problem.weighed],
        ]
    )
    bodies = np.eye(mass.size)[problem.weighed]
    return factor, np.concatenate([rows[problem.stiff], rows[problem.damped], bodies])


def _reference(problem: JointProblem, row: int, shape: ComplexArray) -> int:
    """Return the degree of freedom that a shape is compared relative to."""
    if problem.measured.shapes is None or not problem.outputs.size:
        return int(np.argmax(np.abs(shape)))
    return int(problem.outputs[np.argmax(np.abs(problem.measured.shapes[row]))])


def _pole_rows(
    problem: JointProblem, row: int, pole: complex, by_pole: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Return the rows of frequency and damping ratio of one mode."""
    measured = problem.measured
    ratio = -pole.real / abs(pole)
    by_log = (by_pole / pole).real
    by_ratio = -by_pole.real / abs(pole) - ratio * by_log
    frequency = measured.natural_frequency[row]
    weight = frequency / measured.frequency_sd[row]
    value = [np.log(abs(pole) / (2 * np.pi * frequency)) * weight]
    slope = [by_log * weight]
    if measured.damping_ratio is not None and measured.damping_ratio_sd is not None:
        sd = measured.damping_ratio_sd[row]
        value.append((ratio - measured.damping_ratio[row]) / sd)
        slope.append(by_ratio / sd)
    return np.array(value), np.array(slope)


def _shape_rows(
    problem: JointProblem, row: int, ratio: ComplexArray, by_shape: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Return the rows of one shape, each component over the largest measured one."""
    measured = problem.measured
    if measured.shapes is None or measured.shape_sd is None:
        raise UsageError("shapes were requested but not measured")
    lead = int(np.argmax(np.abs(measured.shapes[row])))
    wanted = measured.shapes[row] / measured.shapes[row, lead]
    sd = np.hypot(
        measured.shape_sd[row], np.abs(wanted) * measured.shape_sd[row, lead]
    ) / abs(measured.shapes[row, lead])
    others = np.arange(wanted.size) != lead
    dof = problem.outputs[others]
    difference = (ratio[dof] - wanted[others]) / sd[others]
    slope = by_shape[:, dof].T / sd[others, None]
    return (
        np.concatenate([difference.real, difference.imag]),
        np.concatenate([slope.real, slope.imag]),
    )


def _prior_rows(
    problem: JointProblem, unknowns: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return one row for each prior."""
    log_stiffness, damping, _ = split(problem, unknowns)
    links, bodies = problem.model.links, problem.model.bodies
    centre, sd = np.zeros(problem.size), np.full(problem.size, np.inf)
    for at, i in enumerate(problem.stiff):
        spread = links[i].stiffness_spread
        if spread and links[i].stiffness > 0:
            centre[at] = np.log(links[i].stiffness)
            sd[at] = spread
    for at, i in enumerate(problem.damped, start=log_stiffness.size):
        spread = links[i].damping_spread
        if spread and links[i].damping > 0:
            centre[at] = links[i].damping / problem.damping_scale
            sd[at] = spread * centre[at]
    for at, i in enumerate(problem.weighed, start=log_stiffness.size + damping.size):
        sd[at] = bodies[i].mass_spread
    known = np.isfinite(sd)
    value = (unknowns[known] - centre[known]) / sd[known]
    return value, np.diag(1 / sd)[known]


def _links(model: LumpedModel, unknown: Sequence[str] | None) -> IntArray:
    """Return the indices of the unknown links."""
    names = [link.name for link in model.links]
    missing = [name for name in unknown or () if name not in names]
    if missing:
        raise UsageError(f"no link {missing[0]!r} in the model; its links are {names}")
    wanted = names if unknown is None else unknown
    return np.array([i for i, name in enumerate(names) if name in wanted], np.int64)


def _require_numbers(numbers: IntArray, n_modes: int, n_bodies: int) -> None:
    """Raise unless every measured mode has a separate mode of the model."""
    if numbers.size != n_modes or np.any(np.diff(numbers) <= 0) or numbers.min() < 0:
        raise UsageError(
            f"mode numbers {numbers.tolist()} for {n_modes} measured modes; give one "
            "for each, from 0, in ascending order"
        )
    if numbers.max() >= n_bodies:
        raise BadData(
            f"mode {numbers.max() + 1} was measured, a model of {n_bodies} bodies has "
            f"at most {n_bodies} modes; narrow the band or add a body to the model"
        )


def _require_own_outputs(measured: MeasuredModes) -> None:
    """Raise where two outputs are on one body, or two bodies share one channel."""
    names = measured.outputs
    for at, name in enumerate(names):
        if name in names[:at]:
            raise BadData(
                f"body {name!r} has two outputs; give one output for each body"
            )
        if measured.shapes is None or measured.shapes.shape[0] < 2:
            continue  # one mode alone may move two bodies alike
        for before in range(at):
            if np.array_equal(measured.shapes[:, before], measured.shapes[:, at]):
                raise BadData(
                    f"bodies {names[before]!r} and {name!r} read the same output: "
                    "their shapes agree to the last digit in every mode; give each "
                    "body its own channel"
                )
