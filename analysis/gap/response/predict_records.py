# SPDX-License-Identifier: MIT
"""Response of lumped bodies to measured forces, from rest, over the whole record.

The linear part is evaluated on a line to the right of the imaginary axis of the
Laplace plane: multiply the force by exp(-a t), pad to 1.5 times the length, transform,
multiply by the transfer function at s = a + i omega, transform back, multiply by
exp(a t). For a band-limited force this is exact except for a wrap-around of exp(-16),
without discretisation error or leakage. The last fiftieth of the band is tapered: force
noise there, above the pass band of any filter, would ring before the hit, that is at
the end of the transform, where exp(a t) is largest.

Source:
    Wilcox 1978, Int. J. Elec. Eng. Educ. 15, 247 (numerical Laplace transform with
    damping); the choice a = 16 / (1.5 n dt) follows from the required wrap-around.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.response.dynamic_stiffness import (
    Action,
    dynamic_stiffness,
    invert,
)
from jointbench.analysis.gap.response.excitation import Excitation
from jointbench.analysis.gap.response.link_modes import LinearQuery, link_modes
from jointbench.analysis.gap.response.port_forces import (
    PortLaw,
    filled_lanes,
    need_velocity,
    port_forces,
)
from jointbench.analysis.gap.response.response_settings import RESPONSE
from jointbench.analysis.lumped.lumped_model import LumpedModel


def respond(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action] = (),
    *,
    oversampling: int = 4,
    measured: FloatArray | None = None,
) -> FloatArray:
    """Predict the channels.

    Args:
        model: bodies, links, channels.
        theta: base parameters [SI], shape (n_base,).
        excitation: prepared forces.
        actions: effects switched on.
        oversampling: steps of the time integration per sample.
        measured: needed by effects that fit their own phase (hum), shape as the
            result.

    Returns:
        Response in the model's output, shape (n_records, n_channels, n_samples).
    """
    x = motion(model, theta, excitation, actions, oversampling=oversampling)
    return _measured_motion(model, x, excitation, actions, measured)


def respond_tapered(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action],
    tapers: Sequence[FloatArray],
    *,
    oversampling: int = 4,
    measured: FloatArray | None = None,
) -> list[FloatArray]:
    """Predict the channels with several tapers of the nonlinear part.

    The forces are integrated once: they arise before the converter.

    Args:
        model: bodies, links, channels.
        theta: base parameters [SI], shape (n_base,).
        excitation: prepared forces; its taper is not used.
        actions: effects switched on.
        tapers: each of shape (n_lines,).
        oversampling: steps of the time integration per sample.
        measured: as in `respond`.

    Returns:
        A response as of `respond` for each taper.
    """
    parts = _parts(model, theta, excitation, actions, oversampling)
    return [
        _measured_motion(
            model, _summed(model, parts, taper), excitation, actions, measured
        )
        for taper in tapers
    ]


def _measured_motion(
    model: LumpedModel,
    x: Sequence[ComplexArray],
    excitation: Excitation,
    actions: Sequence[Action],
    measured: FloatArray | None,
) -> FloatArray:
    """Return what the channels show of the displacements of the bodies."""
    s = excitation.s
    power = _derivative(excitation, int(model.output))
    seen = [model.index(c.body) for c in model.channels]
    spectra = np.empty((len(x[0]), len(seen), s.size), dtype=np.complex128)
    for i, body in enumerate(seen):
        np.multiply(x[body], power, out=spectra[:, i])
    spectra = _channels(spectra, s, actions)
    response = undamped(spectra, excitation)
    return shaped(response, measured, actions, excitation.sample_rate)


def shaped(
    response: FloatArray,
    measured: FloatArray | None,
    actions: Sequence[Action],
    rate: float,
) -> FloatArray:
    """Return the response with what happens to its samples: clipping, hum.

    Args:
        response: shape (n_records, n_channels, n_samples).
        measured: needed by effects that fit their own phase, shape as the result.
        actions: all effects; those without a shape are ignored.
        rate: sample rate [Hz].
    """
    for action in actions:
        if action.entry.shape is not None:
            response = _shaped(response, measured, action, rate)
    return response


@lru_cache(maxsize=8)
def _derivative(excitation: Excitation, order: int) -> ComplexArray:
    """Return s^order, shape (n_lines,), read-only."""
    values = excitation.s**order
    values.flags.writeable = False
    return np.asarray(values)


def motion(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action],
    *,
    oversampling: int,
) -> list[ComplexArray]:
    """Return the displacement of each body, damped spectra (n_records, n_lines)."""
    parts = _parts(model, theta, excitation, actions, oversampling)
    return _summed(model, parts, excitation.taper)


class _Parts(NamedTuple):
    """Motion without nonlinear forces, these forces, and what they move.

    Attributes:
        linear: displacement of each body, damped spectra (n_records, n_lines).
        forces: of each nonlinear link, damped spectra of the same shape.
        receptance: [m/N], shape (n_bodies, n_bodies, 1 or n_records, n_lines).
    """

    linear: list[ComplexArray]
    forces: dict[int, ComplexArray]
    receptance: ComplexArray


def _parts(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action],
    oversampling: int,
) -> _Parts:
    query = LinearQuery(model, theta, excitation.conditions, (), actions)
    linear, h = _linear_motion(query, excitation)
    forces = _link_forces(query, excitation, actions, oversampling)
    return _Parts(linear, forces, h)


@lru_cache(maxsize=2)
def _linear_motion(
    query: LinearQuery, excitation: Excitation
) -> tuple[list[ComplexArray], ComplexArray]:
    """Return the motion of the bodies without nonlinear forces, and the receptance.

    Both are kept for calls in which the parameters of a law alone change; they are
    never written to.
    """
    z = dynamic_stiffness(
        query.model, query.theta, excitation.s, query.conditions, query.actions
    )
    h = invert(z)
    variant = np.arange(excitation.hit.size) if h.shape[2] > 1 else 0
    bodies = range(len(query.model.bodies))
    return [h[i, excitation.hit, variant] * excitation.spectrum for i in bodies], h


def _summed(model: LumpedModel, parts: _Parts, taper: FloatArray) -> list[ComplexArray]:
    """Return the displacement of each body with the forces tapered."""
    x = list(parts.linear)
    for link, force in parts.forces.items():
        tapered = force * taper
        for i in range(len(x)):
            x[i] = x[i] - _across(model, parts.receptance, i, link) * tapered
    return x


def undamped(spectra: ComplexArray, excitation: Excitation) -> FloatArray:
    """Transform damped spectra to time, shape (..., n_samples)."""
    n = excitation.growth.size
    x = scipy.fft.irfft(spectra, excitation.padded, axis=-1)
    return np.asarray(x[..., :n] * excitation.growth)


def _across(model: LumpedModel, h: ComplexArray, body: int, link: int) -> ComplexArray:
    """Return the motion of a body per unit force that contracts a link."""
    first, second = model.ends(link)
    value = h[body, second]
    if first >= 0:
        value = value - h[body, first]
    return np.asarray(value)


def _link_forces(
    query: LinearQuery,
    excitation: Excitation,
    actions: Sequence[Action],
    oversampling: int,
) -> dict[int, ComplexArray]:
    """Return the damped spectra of all nonlinear link forces, by link.

    The links are the ports of one coupled time integration.
    """
    nonlinear = [a for a in actions if a.entry.law is not None]
    links = sorted({a.index for a in nonlinear})
    if not links:
        return {}
    laws = [
        PortLaw(port, a.entry.law(a.values))
        for port, link in enumerate(links)
        for a in nonlinear
        if a.index == link and a.entry.law is not None
    ]
    modes = link_modes(query.model, query.theta, query.conditions, links, actions)
    fine = _between_samples(
        query, excitation, tuple(links), oversampling, need_velocity(laws)
    )
    dt = 1 / (excitation.sample_rate * oversampling)
    twice = oversampling >= RESPONSE.extrapolated_steps
    force, half = port_forces(fine, modes, dt, laws, extrapolated=twice)
    spectra = _spectra(excitation, force, oversampling)
    if half is not None:
        spectra = (4.0 * spectra - _spectra(excitation, half, oversampling // 2)) / 3.0
    return dict(zip(links, spectra, strict=True))


@lru_cache(maxsize=2)
def _between_samples(
    query: LinearQuery,
    excitation: Excitation,
    links: tuple[int, ...],
    oversampling: int,
    moving: bool,
) -> FloatArray:
    """Return motion and speed of ports, shape (2, n_ports, n_steps, n_columns).

    Only the motion is returned if no law depends on the speed. There is one column per
    record, and zero columns fill the lanes of the time integration. As the motion of
    the bodies, it is kept for calls in which the parameters of a law alone change.

    Args:
        query: the linear model.
        excitation: of the records.
        links: at the ports.
        oversampling: steps per sample.
        moving: whether a law depends on the speed.
    """
    linear, _ = _linear_motion(query, excitation)
    count = excitation.growth.size * oversampling
    long = excitation.padded * oversampling
    gain = oversampling * _growth(excitation, oversampling)[:, None]
    records = excitation.hit.size
    powers = (0, 1) if moving else (0,)
    out = np.empty((len(powers), len(links), count, filled_lanes(records)))
    out[..., records:] = 0.0
    for port, link in enumerate(links):
        first, second = query.model.ends(link)
        x = linear[second] - (linear[first] if first >= 0 else 0.0)
        for power in powers:
            y = x * excitation.s if power else x
            rows = scipy.fft.irfft(y, long, axis=1)[:, :count]
            np.multiply(rows.T, gain, out=out[power, port, :, :records])
    return out


def _growth(excitation: Excitation, oversampling: int) -> FloatArray:
    """Return exp(a t) at `oversampling` steps per sample."""
    count = excitation.growth.size * oversampling
    rate = excitation.sample_rate * oversampling
    return _exponential(count, excitation.damping / rate)


@lru_cache(maxsize=8)
def _decay(excitation: Excitation, oversampling: int) -> FloatArray:
    """Return exp(-a t) at `oversampling` steps per sample, read-only."""
    values = 1.0 / _growth(excitation, oversampling)
    values.flags.writeable = False
    return np.asarray(values)


@lru_cache(maxsize=8)
def _exponential(count: int, exponent: float) -> FloatArray:
    """Return exp(k exponent), k = 0, 1, ..., shape (count,), read-only."""
    values = np.exp(exponent * np.arange(count))
    values.flags.writeable = False
    return np.asarray(values)


def _spectra(
    excitation: Excitation, force: FloatArray, oversampling: int
) -> ComplexArray:
    """Return damped spectra of forces up to Nyquist, (n_ports, n_records, n_lines)."""
    records = excitation.hit.size
    damped = np.multiply(
        force.transpose(0, 2, 1)[:, :records],
        _decay(excitation, oversampling),
        order="C",
    )
    spectrum = scipy.fft.rfft(damped, excitation.padded * oversampling, axis=2)
    return np.asarray(spectrum[..., : excitation.taper.size] / oversampling)


def _channels(
    spectra: ComplexArray, s: ComplexArray, actions: Sequence[Action]
) -> ComplexArray:
    for action in actions:
        rows = (
            slice(None) if action.index < 0 else slice(action.index, action.index + 1)
        )
        if action.entry.mixing is not None:
            share = action.entry.mixing(action.values)
            other = spectra.sum(axis=1) - spectra[:, action.index]
            spectra[:, action.index] += share * other
        if action.entry.transfer is not None:
            spectra[:, rows] = spectra[:, rows] * action.entry.transfer(
                s, action.values
            )
    return spectra


def _shaped(
    response: FloatArray, measured: FloatArray | None, action: Action, rate: float
) -> FloatArray:
    if action.entry.shape is None:
        return response
    rows = slice(None) if action.index < 0 else slice(action.index, action.index + 1)
    seen = response if measured is None else measured
    out = response.copy()
    out[:, rows] = action.entry.shape(
        response[:, rows], seen[:, rows], action.values, rate
    )
    return out
