# SPDX-License-Identifier: MIT
"""What sensors follow and deliver, faults of place, direction and signal included."""

from collections.abc import Sequence

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.closed_structure import Coordinates
from jointbench.simulators.flexible.flexible_effects import FlexibleEffect
from jointbench.simulators.flexible.flexible_specimen import (
    BodyPlace,
    BoltedSpecimen,
    ElasticBody,
    Vector,
)
from jointbench.simulators.flexible.sensor_chain import FULL_SCALE, sensitivities
from jointbench.simulators.flexible.surface_nodes import along_side


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
                body = specimen.bodies[sensor.body]
                position, direction = _moved(body, sensor, direction, effect)
        rows.append(direction @ place.rows(sensor.body, position))
    return np.stack(rows)


def _moved(
    body: ElasticBody, sensor: BodyPlace, direction: FloatArray, effect: FlexibleEffect
) -> tuple[Vector, FloatArray]:
    """Return place and direction of a sensor with a fault."""
    p, normal = effect.parameters, np.asarray(sensor.direction)
    position = sensor.position
    plane = surface_axes(sensor)
    if effect.name == "wrong_position":
        return along_side(body, sensor, p["u"], p["v"]), direction
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
            limit = FULL_SCALE / float(sensitivities(2)[1]) * p["share"]
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
