# SPDX-License-Identifier: MIT
"""Faults of the measuring chain of a campaign: errors of the accelerometers.

Everything linear happens before the anti-alias filter, at the steps of the plant;
clipping happens at the converter, after it.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.simulators.hidden.campaign_design import CampaignCondition

Parameters = Mapping[str, float]
ALL_CHANNELS = -1.0
"""The `dof` of a fault that all channels share."""
_Fault = Callable[[FloatArray, Parameters, float, CampaignCondition], FloatArray]


def distort_signals(
    acceleration: FloatArray,
    effects: Sequence[tuple[str, Parameters]],
    *,
    rate: float,
    condition: CampaignCondition,
) -> FloatArray:
    """Pass accelerations through the faults of their sensors.

    Args:
        acceleration: true ones [m/s^2], shape (2, n).
        effects: names and parameters; those that are no sensor fault are ignored.
        rate: samples per second of `acceleration` [Hz].
        condition: of the record.

    Returns:
        Output of the sensors [m/s^2], shape (2, n).
    """
    for name, parameters in effects:
        if name not in ANALOGUE_FAULTS:
            continue
        for own in _each_channel(parameters, len(acceleration)):
            acceleration = ANALOGUE_FAULTS[name](acceleration, own, rate, condition)
    return acceleration


def _each_channel(parameters: Parameters, channels: int) -> list[Parameters]:
    """Return the parameters of a fault for each channel that has it."""
    if parameters.get("dof") != ALL_CHANNELS:
        return [parameters]
    return [{**parameters, "dof": float(dof)} for dof in range(channels)]


def clip_samples(
    samples: FloatArray, effects: Sequence[tuple[str, Parameters]]
) -> FloatArray:
    """Clip samples as a converter with too small a range does, shape unchanged."""
    for name, parameters in effects:
        if name == "saturation":
            samples = np.clip(samples, -parameters["amax"], parameters["amax"])
    return samples


def _through(
    signal: FloatArray, rate: float, response: Callable[[FloatArray], ComplexArray]
) -> FloatArray:
    """Filter a signal that is zero before its start; the padding contains its decay."""
    size = scipy.fft.next_fast_len(signal.size + signal.size // 4, real=True)
    frequency = scipy.fft.rfftfreq(size, 1 / rate)
    spectrum = scipy.fft.rfft(signal, size) * response(frequency)
    return np.asarray(scipy.fft.irfft(spectrum, size)[: signal.size], dtype=float)


def _on_channel(
    acceleration: FloatArray, parameters: Parameters, row: FloatArray
) -> FloatArray:
    changed = acceleration.copy()
    changed[int(parameters["dof"])] = row
    return changed


def _row(acceleration: FloatArray, parameters: Parameters) -> FloatArray:
    return np.asarray(acceleration[int(parameters["dof"])], dtype=float)


def _delay(
    a: FloatArray, p: Parameters, rate: float, _: CampaignCondition
) -> FloatArray:
    def response(frequency: FloatArray) -> ComplexArray:
        return np.asarray(np.exp(-2j * np.pi * frequency * p["tau"]))

    return _on_channel(a, p, _through(_row(a, p), rate, response))


def _low_pass(
    a: FloatArray, p: Parameters, rate: float, _: CampaignCondition
) -> FloatArray:
    def response(frequency: FloatArray) -> ComplexArray:
        return np.asarray(1 / (1 + 1j * frequency / p["fc"]))

    return _on_channel(a, p, _through(_row(a, p), rate, response))


def _resonance(
    a: FloatArray, p: Parameters, rate: float, _: CampaignCondition
) -> FloatArray:
    def response(frequency: FloatArray) -> ComplexArray:
        ratio = frequency / p["f0"]
        return np.asarray(1 / (1 - ratio**2 + 2j * p["zeta"] * ratio))

    return _on_channel(a, p, _through(_row(a, p), rate, response))


def _gain(a: FloatArray, p: Parameters, _: float, __: CampaignCondition) -> FloatArray:
    return _on_channel(a, p, (1 + p["frac"]) * _row(a, p))


def _polarity(
    a: FloatArray, p: Parameters, _: float, __: CampaignCondition
) -> FloatArray:
    return _on_channel(a, p, -_row(a, p))


def _cross_talk(
    a: FloatArray, p: Parameters, _: float, __: CampaignCondition
) -> FloatArray:
    changed = a.copy()
    changed[0] += p["frac"] * a[1]
    return changed


def _hum(
    a: FloatArray, p: Parameters, rate: float, condition: CampaignCondition
) -> FloatArray:
    angle = 2 * np.pi * p["freq"] * np.arange(a.shape[1]) / rate + condition.phase
    return _on_channel(a, p, _row(a, p) + p["amp"] * np.sin(angle))


def _clock_drift(
    a: FloatArray, p: Parameters, rate: float, _: CampaignCondition
) -> FloatArray:
    """Sample both accelerations with a clock faster than that of the force."""
    from scipy.interpolate import CubicSpline  # slow to import, rarely needed

    index = np.arange(a.shape[1], dtype=float)
    late = np.minimum(index * (1 + p["rate"]), index[-1])
    return np.asarray(CubicSpline(index, a, axis=1)(late), dtype=float)


def _bias_step(
    a: FloatArray, p: Parameters, rate: float, condition: CampaignCondition
) -> FloatArray:
    """Shift the zero at the hit, in proportion to it, and let it decay."""
    time = np.arange(a.shape[1]) / rate - condition.pulse.start
    decay = np.where(time > 0, np.exp(-np.maximum(time, 0) / p["tau"]), 0.0)
    peak = np.abs(_row(a, p)).max()
    return _on_channel(a, p, _row(a, p) + p["frac"] * peak * decay)


ANALOGUE_FAULTS: Mapping[str, _Fault] = {
    "delay": _delay,
    "sensor_lowpass": _low_pass,
    "gain_error": _gain,
    "polarity": _polarity,
    "cross_talk": _cross_talk,
    "hum": _hum,
    "sensor_resonance": _resonance,
    "clock_drift": _clock_drift,
    "zero_shift": _bias_step,
}
SENSOR_FAULTS = frozenset((*ANALOGUE_FAULTS, "saturation"))
