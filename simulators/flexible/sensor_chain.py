# SPDX-License-Identifier: MIT
"""From accelerations to counts: faults of sensors, filter, noise, mains, range."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.simulators.flexible.closed_structure import Coordinates
from jointbench.simulators.flexible.flexible_effects import FlexibleEffect
from jointbench.simulators.flexible.flexible_specimen import (
    BodyPlace,
    BoltedSpecimen,
    Vector,
)
from jointbench.simulators.flexible.hit_plan import SAMPLE_RATE, SAMPLES
from jointbench.simulators.measuring.converter import AntiAlias

OVERSAMPLING = 8
CONVERTER = AntiAlias(
    oversampling=OVERSAMPLING, pass_band=0.43, stop_band=0.5, attenuation=100.0
)
FULL_SCALE, BITS = 10.0, 24
"""Range of every input [V], and bits of the converter, sign included."""
HAMMER_SENSITIVITY = 2.25e-3  # [V/N]
ACCELEROMETER_SENSITIVITY = 0.1 / 9.80665  # [V s^2/m]
_MAINS = 50.0  # [Hz]
_HARMONICS = (1.0, 0.3)  # first and third, over the first


@dataclass(frozen=True, slots=True)
class InputNoise:
    """Noise of all inputs in one campaign.

    Attributes:
        force: white noise of the hammer [N].
        acceleration: white noise of each accelerometer [m/s^2].
        mains: amplitude over the white noise [-].
        mains_frequency: [Hz].
        offset: standard deviation of the offsets [V].
    """

    force: float
    acceleration: float
    mains: float
    mains_frequency: float
    offset: float


def draw_noise(
    force: float, acceleration: float, rng: np.random.Generator
) -> InputNoise:
    """Draw mains and offset beside given white noise [N], [m/s^2]."""
    return InputNoise(
        force=force,
        acceleration=acceleration,
        mains=float(rng.uniform(0.3, 1.5)),
        mains_frequency=_MAINS + float(rng.uniform(-0.1, 0.1)),
        offset=float(rng.uniform(1e-4, 1e-3)),
    )


def sensor_rows(
    place: Coordinates, specimen: BoltedSpecimen, effects: Sequence[FlexibleEffect]
) -> FloatArray:
    """Return what the sensors follow, faults of place and direction included.

    Returns:
        Shape (n_sensors, n_coordinates).
    """
    rows = []
    for sensor in specimen.sensors:
        position, direction = sensor.position, np.asarray(sensor.direction)
        for effect in effects:
            if effect.where.get("channel") == sensor.name:
                position, direction = _moved(sensor, position, direction, effect)
        rows.append(direction @ place.rows(sensor.body, position))
    return np.stack(rows)


def _moved(
    sensor: BodyPlace, position: Vector, direction: FloatArray, effect: FlexibleEffect
) -> tuple[Vector, FloatArray]:
    """Return place and direction of a sensor with a fault."""
    p, normal = effect.parameters, np.asarray(sensor.direction)
    plane = surface_axes(sensor)
    if effect.name == "wrong_position":
        return shifted(sensor, p["u"], p["v"]), direction
    if effect.name == "wrong_direction":
        return position, np.cos(p["angle"]) * normal + np.sin(p["angle"]) * plane[0]
    if effect.name == "cross_axis":
        return position, direction + p["share"] * plane[1]
    return position, direction


def surface_axes(place: BodyPlace) -> tuple[FloatArray, FloatArray]:
    """Return the two axes normal to the direction of a place."""
    first, second = (
        axis for axis in np.eye(3) if abs(axis @ np.asarray(place.direction)) < 0.5
    )
    return first, second


def shifted(place: BodyPlace, u: float, v: float) -> Vector:
    """Return a place moved by u and v [m] along the axes normal to its direction."""
    first, second = surface_axes(place)
    x, y, z = np.asarray(place.position) + u * first + v * second
    return float(x), float(y), float(z)


def faulty_signals(
    signals: FloatArray,
    specimen: BoltedSpecimen,
    effects: Sequence[FlexibleEffect],
    *,
    rate: float,
) -> FloatArray:
    """Return signals with the faults of their sensors.

    Args:
        signals: accelerations [m/s^2], shape (..., n_sensors, n).
        specimen: with the names of the sensors.
        effects: hidden ones.
        rate: of the samples [Hz].
    """
    names = [sensor.name for sensor in specimen.sensors]
    found = signals.copy()
    for effect in effects:
        if effect.where.get("channel") in names:
            row = names.index(str(effect.where["channel"]))
            found[..., row, :] = _fault(found[..., row, :], effect, rate)
    return found


def _fault(signal: FloatArray, effect: FlexibleEffect, rate: float) -> FloatArray:
    p = effect.parameters
    match effect.name:
        case "gain_error":
            return np.asarray((1 + p["g"]) * signal)
        case "polarity":
            return -signal
        case "soft_clipping":
            limit = FULL_SCALE / ACCELEROMETER_SENSITIVITY * p["share"]
            return np.asarray(limit * np.tanh(signal / limit))
        case "delay" | "cable_resonance":
            return _filtered(signal, effect, rate)
    return signal


def _filtered(signal: FloatArray, effect: FlexibleEffect, rate: float) -> FloatArray:
    """Return a signal through a delay or through the resonance of its cable."""
    p = effect.parameters
    size = scipy.fft.next_fast_len(signal.shape[-1] + round(0.02 * rate), real=True)
    s = 2j * np.pi * scipy.fft.rfftfreq(size, 1 / rate)
    if effect.name == "delay":
        factor = np.asarray(np.exp(-s * p["tau"]))
    else:
        own = 2 * np.pi * p["frequency"]
        factor = own**2 / (s**2 + 2 * p["damping_ratio"] * own * s + own**2)
    spectrum = scipy.fft.rfft(signal, size) * factor
    return np.asarray(scipy.fft.irfft(spectrum, size)[..., : signal.shape[-1]])


def sampled(force: FloatArray, signals: FloatArray) -> FloatArray:
    """Return force and signals of one hit through the anti-alias filter.

    Args:
        force: at every step [N], shape (n,).
        signals: at every step [m/s^2], shape (n_sensors, n).

    Returns:
        Shape (1 + n_sensors, SAMPLES); the filter is centred.
    """
    both = np.vstack((force, signals))
    half = CONVERTER.half_length
    size = scipy.fft.next_fast_len(both.shape[1] + 2 * half, real=True)
    spectrum = scipy.fft.rfft(both, size) * scipy.fft.rfft(CONVERTER.taps(), size)
    whole = scipy.fft.irfft(spectrum, size)[:, half:]
    return np.asarray(whole[:, : SAMPLES * OVERSAMPLING : OVERSAMPLING])


def digitised(
    physical: FloatArray, noise: InputNoise, time: float, rng: np.random.Generator
) -> IntArray:
    """Return the counts of one record.

    Args:
        physical: force [N] and accelerations [m/s^2], shape (n_channels, n).
        noise: of the inputs.
        time: of the record [s], to which the phase of the mains refers.
        rng: source of the noise.
    """
    scale = sensitivities(physical.shape[0])
    white = np.full(physical.shape[0], noise.acceleration)
    white[0] = noise.force
    moments = time + np.arange(physical.shape[1]) / SAMPLE_RATE
    turn = 2 * np.pi * noise.mains_frequency * moments
    first, third = _HARMONICS
    hum = first * np.sin(turn) + third * np.sin(3 * turn)
    values = physical + white[:, None] * rng.standard_normal(physical.shape)
    values += noise.mains * white[:, None] * hum
    offset = noise.offset * (1 + 0.02 * rng.standard_normal(white.size))
    volts = values * scale[:, None] + offset[:, None]
    top = 2 ** (BITS - 1)
    counts = np.clip(np.round(volts / FULL_SCALE * top), -top, top - 1)
    return np.asarray(counts, dtype=np.int32)


def sensitivities(channels: int) -> FloatArray:
    """Return the sensitivity of the hammer [V/N] and of accelerometers [V s^2/m]."""
    found = np.full(channels, ACCELEROMETER_SENSITIVITY)
    found[0] = HAMMER_SENSITIVITY
    return found
