# SPDX-License-Identifier: MIT
"""A modal base from the records of the lowest level, with its uncertainty as priors.

Poles come from an FRF by the modal chain of the product. Modal constants and shapes
follow by linear least squares, and all of them are then fitted to the whole records in
time, with the residual that the later fits use.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.modal_bench.level_records import LevelRecord, RecordSet
from jointbench.analysis.gap.modal_bench.modal_base import ModalBase, UnitModes
from jointbench.analysis.gap.modal_bench.modal_bench import ModalBench, make_modal_bench
from jointbench.analysis.gap.modal_bench.modal_settings import MODAL
from jointbench.analysis.gap.modal_bench.port_response import modal_receptance
from jointbench.analysis.gap.modal_bench.record_frf import record_frf
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.modes import ModalSettings, identify_modes


@dataclass(frozen=True, slots=True)
class BaseRequest:
    """How the base is found.

    Attributes:
        band: lowest and highest frequency with modes [Hz].
        modes: number of modes in the band; None for those that the modal chain finds.
        beyond: whether a further mode may stand for those above the band.
    """

    band: tuple[float, float]
    modes: int | None = None
    beyond: bool = True


def base_from_records(given: RecordSet, wanted: BaseRequest) -> tuple[ModalBase, float]:
    """Identify the base from the records of the lowest level.

    Args:
        given: records with sensors and inputs.
        wanted: band and number of modes.

    Returns:
        The base with priors, and chi2/dof of its fit to the lowest level [-].

    Raises:
        BadData: the lowest level shows no or too few modes in the band.
    """
    frf = record_frf(given, given.lowest, wanted.band)
    poles = _poles(frf, wanted)
    bench, fit = _fitted(given, start_modes(given, frf, poles, None))
    if wanted.beyond:
        above = MODAL.beyond_band * wanted.band[1]
        more = _fitted(given, start_modes(given, frf, poles, above))
        gain = (fit.chi2 - more[1].chi2) / max(fit.chi2 / bench.blocks.dof, 1.0)
        if gain > MODAL.beyond_gain * (more[1].n_base - fit.n_base):
            bench, fit = more
    widened = float(np.sqrt(max(fit.chi2 / bench.blocks.dof, 1.0)))
    sd = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)) * widened
    modes = bench.base.modes(fit.base)
    floor = np.tile(
        [
            MODAL.frequency_floor,
            MODAL.damping_floor,
            *(MODAL.shape_floor for _ in given.points),
        ],
        modes.frequency.size,
    )
    sd = np.hypot(MODAL.widening * np.minimum(sd, MODAL.start_sd), floor)
    base = ModalBase(given.points, modes, sd)
    return replace(base, sd=np.hypot(sd, _change(given, base))), widened**2


def _change(given: RecordSet, base: ModalBase) -> FloatArray:
    """Return the change of the base from the lowest level to the next, (n_base,).

    A law adds to the lowest level as well, by about as much as to the step to the next:
    a base of the lowest level may be off by so much.
    """
    above = [r for r in given.training if r not in given.lowest]
    if not above:
        return np.zeros(base.sd.size)
    level = min(above, key=lambda r: r.rms).level
    records = tuple(r for r in above if r.level == level)
    _, fit = _refined(
        given, replace(base, sd=np.full(base.sd.size, MODAL.start_sd)), records
    )
    return np.minimum(np.abs(fit.base), MODAL.start_sd)


def _fitted(given: RecordSet, modes: UnitModes) -> tuple[ModalBench, Fit]:
    """Fit modes to the lowest level, with uninformative priors."""
    count = modes.frequency.size * (2 + len(given.points))
    base = ModalBase(given.points, modes, np.full(count, MODAL.start_sd))
    return _refined(given, base, given.lowest)


def _refined(
    given: RecordSet, base: ModalBase, records: tuple[LevelRecord, ...]
) -> tuple[ModalBench, Fit]:
    """Fit a base to some records, with their noise estimated twice."""
    bench = make_modal_bench(given, base, records=records)
    x = np.zeros(base.sd.size)
    fit = minimise(make_problem(bench, ()), x, iterations=MODAL.base_iterations)
    for _ in range(2):
        bench = bench.refine(fit.base, ())
        fit = minimise(make_problem(bench, ()), fit.x, iterations=MODAL.base_iterations)
    return bench, fit


def _poles(frf: Frf, wanted: BaseRequest) -> ComplexArray:
    """Return the poles of the band by the modal chain [rad/s], ascending."""
    found = identify_modes(frf, ModalSettings(band=wanted.band)).model
    chosen = np.arange(found.poles.size)
    if wanted.modes is not None:
        if found.poles.size < wanted.modes:
            raise BadData(
                f"the lowest level shows {found.poles.size} modes between "
                f"{wanted.band[0]:g} and {wanted.band[1]:g} Hz, {wanted.modes} are "
                "wanted; widen the band or ask for fewer"
            )
        chosen = np.sort(np.argsort(-found.significance)[: wanted.modes])
    return np.asarray(found.poles[chosen])


def start_modes(
    given: RecordSet, frf: Frf, poles: ComplexArray, above: float | None
) -> UnitModes:
    """Return modes of unit mass with real shapes, by linear least squares.

    Args:
        given: the set, with its points.
        frf: of the lowest level.
        poles: [rad/s], shape (n_modes,).
        above: frequency of a mode that stands for those above the band [Hz], or None.
    """
    omega = np.abs(poles)
    damping = np.clip(-poles.real / omega, 1e-5, 0.5)
    if above is not None:
        omega = np.append(omega, 2.0 * np.pi * above)
        damping = np.append(damping, 0.01)
    size = omega.size
    bare = UnitModes(
        omega / (2.0 * np.pi), damping, np.zeros((size, len(given.points)))
    )
    s = np.asarray(frf.added_decay_rate + 2j * np.pi * frf.frequency, complex)
    columns = modal_receptance(bare, s).T * s[:, None] ** int(given.output)
    constants = np.zeros((size, len(given.sensors), len(given.inputs)))
    for o in range(len(given.sensors)):
        for i in range(len(given.inputs)):
            weight = _weights(frf, o, i)
            design = columns * weight[:, None]
            values = frf.response[o, i] * weight
            constants[:, o, i] = np.linalg.lstsq(
                np.concatenate([design.real, design.imag]),
                np.concatenate([values.real, values.imag]),
                rcond=None,
            )[0]
    shapes = np.stack([_shape(given, c) for c in constants])
    return replace(bare, shapes=shapes)


def _weights(frf: Frf, output: int, column: int) -> FloatArray:
    """Return one over a level that a tenth of the FRF adds to: no line dominates."""
    size = np.abs(frf.response[output, column])
    return np.asarray(1.0 / (0.1 * size + 0.1 * float(np.median(size)) + 1e-300))


def _shape(given: RecordSet, constants: FloatArray) -> FloatArray:
    """Return the shape at all points of modal constants, (n_sensors, n_inputs)."""
    points, sensors = given.points, list(given.sensors)
    pairs = [(sensors.index(p), i) for i, p in enumerate(given.inputs) if p in sensors]
    shape = np.zeros(len(points))
    if pairs:
        o, i = max(pairs, key=lambda pair: abs(constants[pair]))
    else:
        o, i = divmod(int(np.argmax(np.abs(constants))), constants.shape[1])
    scale = float(np.sqrt(abs(constants[o, i]))) or 1e-12
    shape[: len(sensors)] = constants[:, i] / scale
    if pairs:
        shape[o] = scale
    _fill_inputs(given, shape, constants, o, i, scale)
    return shape


def _fill_inputs(
    given: RecordSet,
    shape: FloatArray,
    constants: FloatArray,
    output: int,
    column: int,
    scale: float,
) -> None:
    """Set the shape at inputs without a sensor, from the output that scales it."""
    points: Sequence[str] = given.points
    for i, point in enumerate(given.inputs):
        if point not in given.sensors:
            own = shape[output] if abs(shape[output]) > 0 else scale
            shape[points.index(point)] = constants[output, i] / own
