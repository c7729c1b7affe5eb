# SPDX-License-Identifier: MIT
"""Time integration of laws at all ports in complex modes of the closed structure.

Only the deviation d of a law from its linear spring acts as a force, so the linear
response stays exact. Within a step the hammer force changes linearly, and d follows the
parabola through its last three values: straight lines would reduce a harmonic by
(omega h)^2 / 12, a parabola changes its phase by (omega h)^3 / 24. The ports of one
step are coupled by their instantaneous receptance, and their laws are corrected
together.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.structure_response.acting_laws import ActingLaws
from jointbench.analysis.gap.structure_response.closed_modes import ClosedModes
from jointbench.analysis.gap.structure_response.common_filter import CommonFilter
from jointbench.analysis.gap.structure_response.port_law_settings import PORT_LAWS
from jointbench.analysis.gap.structure_response.port_steps import integrate_hits


@dataclass(frozen=True, slots=True, eq=False)
class _ModeSteps:
    """One step of all modes, as arrays for the compiled integration.

    Attributes:
        grow: factor of each mode over a step, shape (2, n_poles).
        early: modal coordinates by a modal force at the begin of a step, same shape.
        late: likewise by one at its end, both with straight lines between them.
        curved: likewise by one at its end, with a parabola.
        rest: likewise by a constant one, after all motion has decayed.
        drive: modal coordinates by the forces of the ports at the begin of a step and
            one step before, real and imaginary parts below each other, shape
            (2 n_poles, 2 n_ports).
        shown: motion of the ports by modal coordinates, shape (n_ports, 2 n_poles).
        speeds: velocity of the ports likewise.
        push: modal force by a force at each port, shape (2, n_ports, n_poles).
        instant: motion and velocity of the ports by their forces at the end of the
            step, shape (2, n_ports, n_ports).
    """

    grow: FloatArray
    early: FloatArray
    late: FloatArray
    curved: FloatArray
    rest: FloatArray
    drive: FloatArray
    shown: FloatArray
    speeds: FloatArray
    push: FloatArray
    instant: FloatArray


def integrate_laws(
    modes: ClosedModes,
    laws: ActingLaws,
    columns: FloatArray,
    force: FloatArray,
    steps: tuple[int, CommonFilter, float],
    preload: FloatArray,
) -> FloatArray:
    """Return the filtered forces of laws beyond the linear springs of their ports.

    Hits are integrated side by side, hard ones together, since soft ones rest sooner.

    Args:
        modes: of the closed structure.
        laws: at its ports.
        columns: force row of each record in free modes, shape (n_records, n_modes).
        force: [N], shape (n_records, n_samples).
        steps: steps per sample, the filter of the campaign, and the rate of the
            samples before it [Hz].
        preload: torque of each record over the reference [-], shape (n_records,).

    Returns:
        Force across each port [N], averaged about each sample as `averaging` states
        and filtered, shape (n_records, n_ports, n_kept).
    """
    parts, common, rate = steps
    one = _steps(modes, laws.rows, 1.0 / (parts * rate))
    struck = _parts_of(modes.inputs @ columns.T)
    sharp = np.ascontiguousarray(_sharpened(force).T)
    scale = np.ascontiguousarray((preload[:, None] ** laws.preload).T)
    corrections = PORT_LAWS.slider_corrections
    if not laws.slides:
        corrections = PORT_LAWS.law_corrections
    kept = -(-force.shape[1] // common.step)
    found = np.empty((len(force), len(laws.rows), kept))
    for block in _side_by_side(force):
        out = np.zeros((force.shape[1], len(laws.rows), block.size))
        integrate_hits(
            (one.grow, one.early, one.late, one.curved, one.rest),
            (one.drive, one.shown, one.speeds, one.push, one.instant),
            (
                *(laws.kinds, laws.sizes, laws.gaps),
                *(laws.slips, laws.weights, laws.sharp),
            ),
            np.ascontiguousarray(scale[:, block]),
            (
                np.ascontiguousarray(struck[:, :, block]),
                np.ascontiguousarray(sharp[:, block]),
            ),
            (parts, corrections, PORT_LAWS.rest_steps if laws.rests else 0),
            out,
        )
        filtered = common.in_time(out.reshape(len(out), -1))
        found[block] = filtered.reshape(kept, *out.shape[1:]).transpose(2, 1, 0)
    return found


def _side_by_side(force: FloatArray) -> list[IntArray]:
    """Return the records in blocks, by their largest forces."""
    order = np.argsort(-np.abs(force).max(axis=1), kind="stable")
    count = -(-order.size // PORT_LAWS.hits_at_once)
    return list(np.array_split(order, count))


def _steps(modes: ClosedModes, rows: FloatArray, h: float) -> _ModeSteps:
    """Return one step of length h [s] of all modes, with ports at rows."""
    z = modes.poles * h
    grow, whole = np.exp(z), np.expm1(z) / modes.poles
    late = (np.expm1(z) - z) / (modes.poles * z)
    square = 2.0 * late / z - 1.0 / modes.poles
    curved = 0.5 * (square + late)
    across = rows @ modes.outputs
    push = -(modes.inputs @ rows.T)
    # The end of one step is the begin of the next: both in one product.
    now, before = grow * curved + whole - square, 0.5 * (square - late)
    drive = np.concatenate([now[:, None] * push, before[:, None] * push], axis=1)
    fast = across * modes.poles
    instant = [np.real((seen * curved) @ push) for seen in (across, fast)]
    return _ModeSteps(
        grow=_parts_of(grow),
        early=_parts_of(whole - late),
        late=_parts_of(late),
        curved=_parts_of(curved),
        rest=_parts_of(-1.0 / modes.poles),
        drive=np.concatenate([drive.real, drive.imag]),
        shown=np.concatenate([across.real, -across.imag], axis=1),
        speeds=np.concatenate([fast.real, -fast.imag], axis=1),
        push=_parts_of(push.T),
        instant=np.ascontiguousarray(instant),
    )


def averaging(s: ComplexArray, sample_rate: float, parts: int) -> ComplexArray:
    """Return the factor by which the average about a sample changes each line.

    A force with kinks has a spectrum far beyond the sample rate, which would fold back.
    Its average over the steps from one sample before to one after, with weights of a
    triangle, is reduced by 40 dB about the sample rate; the factor restores the rest.

    Args:
        s: Laplace variable of each line [rad/s], shape (n_lines,).
        sample_rate: [Hz].
        parts: steps per sample.
    """
    at = np.arange(1 - parts, parts)
    weights = (1.0 - np.abs(at) / parts) / parts
    return np.asarray(np.exp(-s[:, None] * at / (parts * sample_rate)) @ weights)


def _parts_of(values: ComplexArray) -> FloatArray:
    """Return real and imaginary parts, shape (2, ...)."""
    return np.ascontiguousarray(np.stack([values.real, values.imag]))


def _sharpened(force: FloatArray) -> FloatArray:
    """Return forces whose straight lines have the spectrum of the forces themselves.

    Straight lines between samples reduce a harmonic by 1 - (omega h)^2 / 12, which a
    second difference restores; without it a pulse of 1 ms is wrong by 0.05 %.
    """
    found = force.copy()
    found[:, 1:-1] -= np.diff(force, 2, axis=1) / 12.0
    return found
