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

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.response.dynamic_stiffness import (
    Action,
    dynamic_stiffness,
    invert,
)
from jointbench.analysis.gap.response.excitation import Excitation
from jointbench.analysis.gap.response.link_modes import link_modes
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
    s = excitation.s
    power = s ** int(model.output) if model.output else np.ones_like(s)
    spectra = np.stack([x[model.index(c.body)] * power for c in model.channels], axis=1)
    spectra = _channels(spectra, s, actions)
    response = undamped(spectra, excitation)
    for action in actions:
        if action.entry.shape is not None:
            response = _shaped(response, measured, action, excitation.sample_rate)
    return response


def motion(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action],
    *,
    oversampling: int,
) -> list[ComplexArray]:
    """Return the displacement of each body, damped spectra (n_records, n_lines)."""
    z = dynamic_stiffness(model, theta, excitation.s, excitation.conditions, actions)
    h = invert(z)
    bodies = range(len(model.bodies))
    variant = np.arange(excitation.hit.size) if h.shape[2] > 1 else 0
    linear = [h[i, excitation.hit, variant] * excitation.spectrum for i in bodies]
    forces = _link_forces(model, theta, excitation, actions, linear, oversampling)
    for link, link_force in forces.items():
        for i in bodies:
            linear[i] = linear[i] - _across(model, h, i, link) * link_force
    return linear


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
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action],
    linear: Sequence[ComplexArray],
    oversampling: int,
) -> dict[int, ComplexArray]:
    """Return the damped spectra of all nonlinear link forces, anti-aliased, by link.

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
    motions = []
    for link in links:
        first, second = model.ends(link)
        motions.append(linear[second] - (linear[first] if first >= 0 else 0.0))
    modes = link_modes(model, theta, excitation.conditions, links, actions)
    fine = _between_samples(excitation, motions, laws, oversampling)
    dt = 1 / (excitation.sample_rate * oversampling)
    twice = oversampling >= RESPONSE.extrapolated_steps
    force, half = port_forces(fine, modes, dt, laws, extrapolated=twice)
    spectra = _spectra(excitation, force, oversampling)
    if half is not None:
        spectra = (4.0 * spectra - _spectra(excitation, half, oversampling // 2)) / 3.0
    return dict(zip(links, spectra * excitation.taper, strict=True))


def _between_samples(
    excitation: Excitation,
    motions: Sequence[ComplexArray],
    laws: Sequence[PortLaw],
    oversampling: int,
) -> FloatArray:
    """Return motion and speed of ports, shape (2, n_ports, n_steps, n_columns).

    Only the motion is returned if no law depends on the speed. There is one column per
    record, and zero columns fill the lanes of the time integration.

    Args:
        excitation: of the records.
        motions: damped spectra of each port, shape (n_records, n_lines).
        laws: at the ports.
        oversampling: steps per sample.
    """
    count = excitation.growth.size * oversampling
    long = excitation.padded * oversampling
    gain = oversampling * _growth(excitation, oversampling)
    records = excitation.hit.size
    powers = (0, 1) if need_velocity(laws) else (0,)
    out = np.zeros((len(powers), len(motions), count, filled_lanes(records)))
    for power in powers:
        for port, x in enumerate(motions):
            y = x * excitation.s if power else x
            rows = scipy.fft.irfft(y, long, axis=1)[:, :count] * gain
            out[power, port, :, :records] = rows.T
    return out


def _growth(excitation: Excitation, oversampling: int) -> FloatArray:
    """Return exp(a t) at `oversampling` steps per sample."""
    count = excitation.growth.size * oversampling
    dt = 1 / (excitation.sample_rate * oversampling)
    return np.asarray(np.exp(excitation.damping * dt * np.arange(count)))


def _spectra(
    excitation: Excitation, force: FloatArray, oversampling: int
) -> ComplexArray:
    """Return damped spectra of forces up to Nyquist, (n_ports, n_records, n_lines)."""
    records = excitation.hit.size
    damped = np.moveaxis(force, 1, 2)[:, :records] / _growth(excitation, oversampling)
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
