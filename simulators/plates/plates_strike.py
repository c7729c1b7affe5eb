# SPDX-License-Identifier: MIT
"""Force and accelerations of one hammer stroke, at any sample.

The specimen is linear: after the pulse it rings in its poles, which can be evaluated at
    any sample separately. So the signal depends on its sample indices alone, not on the
    blocks of the stream.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.simulators.measuring.hammer import Pulse, pulse_force
from jointbench.simulators.mechanics.modal_response import Poles

_FINE = 64  # steps per sample in which a pulse is integrated
_RINGING = 4.0  # [s] after which a stroke has decayed
_PASS_BAND = 0.45  # of the sample rate: cut-off of the converter's filter


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """One stroke, ready to be sampled.

    Attributes:
        first: index of its first sample.
        head: force, then accelerations, while the pulse lasts, shape (1 + n_out, n).
        poles: [1/s], shape (n_modes,).
        tail: accelerations after the pulse, each mode at its first sample [m/s^2],
            shape (n_modes, n_out).
        last: index one past its last sample.
    """

    first: int
    head: FloatArray
    poles: ComplexArray
    tail: ComplexArray
    last: int

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "head", "poles", "tail")


def stroke(poles: Poles, pulses: Sequence[Pulse], *, sample_rate: float) -> Stroke:
    """Prepare a stroke of one or more pulses.

    Args:
        poles: of the specimen, for the struck point.
        pulses: in order of time; a gap between them is part of the head.
        sample_rate: [Hz].
    """
    values = poles.poles
    audible = np.abs(values) < 2 * np.pi * _PASS_BAND * sample_rate
    gains = poles.gains * audible[:, None]
    first = int(np.floor(pulses[0].start * sample_rate))
    past = int(np.ceil((pulses[-1].start + pulses[-1].width) * sample_rate)) + 1
    count = past - first + 1
    step = 1 / (sample_rate * _FINE)
    fine: FloatArray = step * np.arange((count - 1) * _FINE + 1, dtype=np.float64)
    force = pulse_force(pulses, first / sample_rate + fine)
    state = _running_integral(values, force, fine, step)[:, ::_FINE]
    accelerations = poles.direct[:, None] * force[::_FINE] + 2 * (gains.T @ state).real
    head = np.vstack((force[::_FINE], accelerations))
    return Stroke(
        first=first,
        head=head[:, :-1],
        poles=values,
        tail=gains * state[:, -1:],
        last=first + round(_RINGING * sample_rate),
    )


def signal_piece(
    strokes: Sequence[Stroke], *, first: int, count: int, outputs: int, rate: float
) -> FloatArray:
    """Return force and accelerations of strokes over a range of samples.

    Args:
        strokes: in any order.
        first: index of the first sample.
        count: of samples.
        outputs: accelerations of every stroke.
        rate: of the samples [Hz].

    Returns:
        Force [N], then accelerations [m/s^2], shape (1 + outputs, count).
    """
    signal = np.zeros((1 + outputs, count))
    past = first + count
    ringing: dict[int, tuple[ComplexArray, ComplexArray]] = {}
    for each in strokes:
        stop = each.first + each.head.shape[1]
        low, high = max(each.first, first), min(stop, past)
        if low < high:
            part = each.head[:, low - each.first : high - each.first]
            signal[:, low - first : high - first] += part
        low, high = max(stop, first), min(each.last, past)
        if low < high:
            start = each.tail * np.exp(each.poles * (low - stop) / rate)[:, None]
            if (low, high) == (first, past):
                # All responses of the same poles are added.
                sums = ringing.setdefault(id(each.poles), (each.poles, 0 * start))
                ringing[id(each.poles)] = (each.poles, sums[1] + start)
            else:
                ring = _ring(each.poles, start, high - low, rate)
                signal[1:, low - first : high - first] += ring
    for poles, start in ringing.values():
        signal[1:] += _ring(poles, start, count, rate)
    return signal


def _ring(
    poles: ComplexArray, start: ComplexArray, count: int, rate: float
) -> FloatArray:
    """Return the free response of modes from a start, shape (n_out, count)."""
    return np.asarray(2 * (start.T @ _rise(poles.tobytes(), count, rate)).real)


@lru_cache(maxsize=16)
def _rise(poles: bytes, count: int, rate: float) -> ComplexArray:
    """Return the free response of poles, as bytes, from one, shape (n_modes, count)."""
    step = np.exp(np.frombuffer(poles, dtype=np.complex128) / rate)
    rise = np.empty((step.size, count), dtype=np.complex128)
    rise[:, 0] = 1.0
    # Doubling costs a few products where an exponential of every sample costs ten.
    filled = 1
    while filled < count:
        more = min(filled, count - filled)
        jump = (step**filled)[:, None]
        rise[:, filled : filled + more] = rise[:, :more] * jump
        filled += more
    return rise


def _running_integral(
    poles: ComplexArray, force: FloatArray, time: FloatArray, step: float
) -> ComplexArray:
    """Return the state of each mode under a force, shape (n_modes, n).

    Note:
        ``exp(p (t - s))`` is split into ``exp(p t) exp(-p s)``; a pulse with its bounce
        lasts tens of milliseconds, over which the factors stay near one.
    """
    weights = np.exp(-poles[:, None] * time) * force
    # Trapezoids: the force vanishes at both ends, and its kinks are resolved.
    sums = np.cumsum(weights, axis=1) - 0.5 * weights - 0.5 * weights[:, :1]
    return np.asarray(np.exp(poles[:, None] * time) * sums * step)
