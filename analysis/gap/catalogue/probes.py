# SPDX-License-Identifier: MIT
"""Elementary shapes of laws, for directed tests of the residual of a named effect.

A wrong law at the right site explains most of a residual, and its own residual may
resemble no other effect of the catalogue. It does resemble an elementary shape: an even
or odd power of the motion, a drag, a lag of a channel. These probes are such first
terms of a power series; they are tested in addition to the catalogue, but never fitted
and never named.

Source:
    Powers of motion and of speed: the restoring-force surface of Masri and Caughey
    1979, J. Appl. Mech. 46, 433, eq. (9). Powers of s of a channel: the Taylor series
    of any transfer function about 1. A delay that grows within the record: the Taylor
    series of the time that a second clock shows.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.catalogue.catalogue_settings import CATALOGUE_SETTINGS
from jointbench.analysis.gap.catalogue.linear_effects import MAXWELL
from jointbench.analysis.gap.model.effect import PROBE_FAMILY, Effect
from jointbench.analysis.gap.model.effect_parameter import Parameter, Transform
from jointbench.analysis.gap.response.curve_integration import Curve
from jointbench.analysis.gap.response.curve_law import curve_law
from jointbench.analysis.gap.response.effect_hooks import (
    ElementState,
    Law,
    LumpedEffect,
)

SOURCE = "Masri and Caughey 1979, J. Appl. Mech. 46, 433, eq. (9)"
SERIES = "Taylor series of a transfer function about 1"
CLOCKS = "Taylor series about 0 of the time that a second clock shows"
RELAXATION = CATALOGUE_SETTINGS.relaxation_times


def _effect(name: str, unit: str, scale: str, source: str) -> Effect:
    return Effect(name, PROBE_FAMILY, (Parameter("size", unit, scale),), source)


def _spring(name: str, power: int, curve: Curve) -> LumpedEffect:
    """Return a force that depends on the motion r across a link."""

    def law(v: FloatArray) -> Law:
        return curve_law(spring=lambda r: v[0] * curve(r))

    scale = f"stiffness/travel^{power - 1}" if power > 1 else "stiffness"
    unit = f"N/m^{power}"
    return LumpedEffect(_effect(name, unit, scale, SOURCE), ("link",), law=law)


def _damping(name: str, power: int, curve: Curve) -> LumpedEffect:
    """Return a damping that depends on the motion r across a link."""

    def law(v: FloatArray) -> Law:
        return curve_law(damping=lambda r: v[0] * curve(r))

    effect = _effect(name, f"N s/m^{power + 1}", f"damping/travel^{power}", SOURCE)
    return LumpedEffect(effect, ("link",), law=law)


def _drag(name: str, power: int, curve: Curve) -> LumpedEffect:
    """Return a force that depends on the speed v across a link."""

    def law(v: FloatArray) -> Law:
        return curve_law(drag=lambda speed: v[0] * curve(speed))

    effect = _effect(
        name, f"N s^{power}/m^{power}", f"damping/speed^{power - 1}", SOURCE
    )
    return LumpedEffect(effect, ("link",), law=law)


def _series(name: str, power: int) -> LumpedEffect:
    """Return a term of a channel's transfer function, s over the highest line."""

    def transfer(s: ComplexArray, v: FloatArray) -> ComplexArray:
        return np.asarray(1.0 + v[0] * (s / np.abs(s[-1])) ** power)

    effect = _effect(name, "-", "one", SERIES)
    return LumpedEffect(effect, ("channel",), transfer=transfer, every_channel=True)


def _bend(name: str, power: int) -> LumpedEffect:
    """Return a channel with an error proportional to a power of the signal."""

    def shape(
        model: FloatArray, measured: FloatArray, v: FloatArray, rate: float
    ) -> FloatArray:
        return np.asarray(model + v[0] * model**power)

    effect = _effect(name, "1/unit of the channel", f"1/peak^{power - 1}", SERIES)
    return LumpedEffect(effect, ("channel",), shape=shape, every_channel=True)


def _late(name: str) -> LumpedEffect:
    """Return a channel whose delay grows within the record, from 0 to the size."""

    def shape(
        model: FloatArray, measured: FloatArray, v: FloatArray, rate: float
    ) -> FloatArray:
        ramp = np.linspace(0.0, 1.0, model.shape[-1])
        return np.asarray(model - v[0] * rate * ramp * _slope(model))

    effect = _effect(name, "s", "sample", CLOCKS)
    return LumpedEffect(effect, ("channel",), shape=shape, every_channel=True)


def _slope(signal: FloatArray) -> FloatArray:
    """Return differences of sixth order along the last axis, per sample.

    Simple differences are wrong by a third at a quarter of the sample rate.
    """
    ends = [(0, 0)] * (signal.ndim - 1) + [(3, 3)]
    wide, n = np.pad(signal, ends, mode="edge"), signal.shape[-1]
    apart = [
        wide[..., 3 + k : 3 + k + n] - wide[..., 3 - k : 3 - k + n] for k in (1, 2, 3)
    ]
    return np.asarray((45.0 * apart[0] - 9.0 * apart[1] + apart[2]) / 60.0)


def _relaxation() -> LumpedEffect:
    """Return a spring of a link that relaxes in time."""
    parameters = (
        Parameter("size", "N/m", "stiffness"),
        Parameter("tau", "s", "period", 1e-3, 1e2, RELAXATION, Transform.LOG),
    )
    effect = Effect("relaxation", PROBE_FAMILY, parameters, MAXWELL.effect.source)
    return LumpedEffect(
        effect, ("link",), stiffness=MAXWELL.stiffness, poles=MAXWELL.poles
    )


def _link_inertia(state: ElementState, v: FloatArray) -> ComplexArray:
    return np.asarray((v[0] * state.s * state.s)[None, :])


CLOCK_DRIFT = _late("delay that grows within the record")
"""What a clock of the responses that drifts against that of the force does."""
LIKE_A_CLOCK = frozenset({"delay", "sensor_lowpass"})
"""Effects that such a clock imitates if all channels have them."""
SPRINGS: tuple[LumpedEffect, ...] = (
    _spring("square of the motion", 2, lambda r: r**2),
    _spring("cube of the motion", 3, lambda r: r**3),
    _spring("fourth power of the motion", 4, lambda r: r**4),
    _spring("fifth power of the motion", 5, lambda r: r**5),
    _spring("magnitude of the motion", 1, np.abs),
)
"""Shapes of a force that depends on the motion alone."""
PROBES: tuple[LumpedEffect, ...] = (
    *SPRINGS,
    _damping("damping proportional to the motion", 1, lambda r: r),
    _damping("damping proportional to the square of the motion", 2, lambda r: r**2),
    _drag("square of the speed", 2, lambda v: v * np.abs(v)),
    _drag("cube of the speed", 3, lambda v: v**3),
    _relaxation(),
    LumpedEffect(
        _effect("inertia across the link", "kg", "mass", SERIES),
        ("link",),
        stiffness=_link_inertia,
    ),
    _series("lag", 1),
    _series("loss towards high frequency", 2),
    _series("curvature of the phase", 3),
    _bend("square of the signal", 2),
    _bend("cube of the signal", 3),
    CLOCK_DRIFT,
)
"""Shapes that are tested in addition to the catalogue."""
