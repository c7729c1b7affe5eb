# SPDX-License-Identifier: MIT
"""Response of lumped bodies to measured forces, from rest, over the whole record.

The linear part is evaluated on a line to the right of the imaginary axis of the
Laplace plane: multiply the force by exp(-a t), pad to twice the length, transform,
multiply by the transfer function at s = a + i omega, transform back, multiply by
exp(a t). For a force that is band-limited between samples this is exact but for a
wrap-around of exp(-18), with no step and no leakage.

Source:
    Wilcox 1978, Int. J. Elec. Eng. Educ. 15, 247 (numerical Laplace transform with
    damping); the choice a = 18 / (2 n dt) follows from the wrap-around wanted.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.assembly import Action, dynamic_stiffness, invert
from jointbench.analysis.gap.link_modes import link_modes
from jointbench.analysis.gap.march import (
    COULOMB,
    CURVES,
    QUADRATIC_DAMPING,
    MarchLaw,
    march,
)
from jointbench.analysis.gap.model import LumpedModel
from jointbench.analysis.gap.physics import Conditions, Law

DAMPING_EXPONENT = 18.0
PASS_BAND = 0.42
MOVING = (COULOMB, QUADRATIC_DAMPING, CURVES)
"""Laws that look at the velocity."""
EXTRAPOLATED = 4
"""Steps a sample from which on the march is extrapolated to a step of nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Excitation:
    """Forces made ready once: transformed, with the time axis of the response.

    Attributes:
        spectrum: damped transform of the gated force, shape (n_records, n_lines).
        s: Laplace variable of the lines [rad/s], shape (n_lines,).
        growth: exp(a t), shape (n_samples,).
        hit: body that was hit, shape (n_records,).
        sample_rate: [Hz].
        damping: a [1/s].
        conditions: of each record.
        taper: of the nonlinear part near the Nyquist frequency, shape (n_lines,).
    """

    spectrum: ComplexArray
    s: ComplexArray
    growth: FloatArray
    hit: IntArray
    sample_rate: float
    damping: float
    conditions: Conditions
    taper: FloatArray


def prepare_excitation(
    force: FloatArray, hit: IntArray, sample_rate: float, conditions: Conditions
) -> Excitation:
    """Transform the forces once.

    Args:
        force: [N], zero before the hit, shape (n_records, n_samples).
        hit: body that was hit, shape (n_records,).
        sample_rate: [Hz].
        conditions: of each record.
    """
    n = force.shape[1]
    damping = DAMPING_EXPONENT * sample_rate / (2 * n)
    time = np.arange(n) / sample_rate
    spectrum = scipy.fft.rfft(force * np.exp(-damping * time), 2 * n, axis=1)
    frequency = np.asarray(np.fft.rfftfreq(2 * n, 1 / sample_rate), dtype=float)
    return Excitation(
        spectrum=spectrum,
        s=damping + 2j * np.pi * frequency,
        growth=np.exp(damping * time),
        hit=hit,
        sample_rate=sample_rate,
        damping=damping,
        conditions=conditions,
        taper=pass_band_end(frequency / sample_rate),
    )


def pass_band_end(frequency: FloatArray) -> FloatArray:
    """Return an anti-alias filter that is known by its pass band alone.

    Args:
        frequency: over the sample rate [-].
    """
    edge = (0.5 - frequency) / (0.5 - PASS_BAND)
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.clip(edge, 0, 1)))


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
        oversampling: steps of the nonlinear march per sample.
        measured: needed by effects that carry a phase of their own (hum), shape
            as the result.

    Returns:
        Response in the model's output, shape (n_records, n_channels, n_samples).
    """
    x = motion(model, theta, excitation, actions, oversampling=oversampling)
    s = excitation.s
    power = s ** int(model.output) if model.output else np.ones_like(s)
    spectra = np.stack([x[c.body] * power for c in model.channels], axis=1)
    spectra = _channels(spectra, s, actions)
    n = excitation.growth.size
    response = scipy.fft.irfft(spectra, 2 * n, axis=-1)[..., :n] * excitation.growth
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
    linear = []
    for i in bodies:
        rows = [
            h[i, hit, k if h.shape[2] > 1 else 0]
            for k, hit in enumerate(excitation.hit)
        ]
        linear.append(np.stack(rows) * excitation.spectrum)
    bent = [a for a in actions if a.entry.law is not None]
    for link in sorted({a.index for a in bent}):
        laws = [a.entry.law(a.values) for a in bent if a.index == link if a.entry.law]
        pull = _link_force(
            model, theta, excitation, actions, linear, link, laws, oversampling
        )
        for i in bodies:
            linear[i] = linear[i] - _across(model, h, i, link) * pull
    return linear


def _across(model: LumpedModel, h: ComplexArray, body: int, link: int) -> ComplexArray:
    """Motion of a body per force pulling the ends of a link together."""
    ends = model.links[link]
    value = h[body, ends.second]
    if ends.first >= 0:
        value = value - h[body, ends.first]
    return np.asarray(value)


def _link_force(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action],
    linear: Sequence[ComplexArray],
    link: int,
    laws: Sequence[Law],
    oversampling: int,
) -> ComplexArray:
    """Damped spectrum of the nonlinear force across a link, anti-aliased.

    The march errs with the square of its step, so that half as many steps tell what
    is left of the error; friction at a standstill is too sharp for that.
    """
    ends = model.links[link]
    x = linear[ends.second]
    if ends.first >= 0:
        x = x - linear[ends.first]
    modes = link_modes(model, theta, excitation.conditions, link, actions)
    force = _marched(excitation, x, modes, laws, oversampling)
    if oversampling >= EXTRAPOLATED and all(law.kind != COULOMB for law in laws):
        half = _marched(excitation, x, modes, laws, oversampling // 2)
        force = (4.0 * force - half) / 3.0
    return np.asarray(force * excitation.taper)


def _marched(
    excitation: Excitation,
    x: ComplexArray,
    modes: tuple[ComplexArray, ComplexArray],
    laws: Sequence[Law],
    oversampling: int,
) -> ComplexArray:
    """Damped spectrum of the link force at one step size, up to Nyquist."""
    n = excitation.growth.size
    long = 2 * n * oversampling
    dt = 1 / (excitation.sample_rate * oversampling)
    growth = np.exp(excitation.damping * dt * np.arange(n * oversampling))
    gain = growth * oversampling
    r = scipy.fft.irfft(x, long, axis=1)[:, : n * oversampling] * gain
    r = np.ascontiguousarray(r.T)
    v, moving = r, any(law.kind in MOVING for law in laws)
    if moving:
        v = scipy.fft.irfft(x * excitation.s, long, axis=1)[:, : n * oversampling]
        v = np.ascontiguousarray((v * gain).T)
    force = march(r, v, *modes, dt, tuple(_march_law(law) for law in laws), moving)
    spectrum = scipy.fft.rfft(force.T / growth, long, axis=1)[:, : n + 1]
    return np.asarray(spectrum / oversampling)


def _march_law(law: Law) -> MarchLaw:
    return MarchLaw(
        law.kind, law.parameters, law.slips, law.weights, law.tables, law.tops
    )


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
