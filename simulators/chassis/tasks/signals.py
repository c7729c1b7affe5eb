# SPDX-License-Identifier: MIT
"""Signals at the inputs of a task: of a specimen, or a sine in the limits."""

import threading
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.chassis.specimen import Specimen
from jointbench.simulators.chassis.tasks.virtual_channels import VirtualChannel
from jointbench.simulators.measuring.converter import Digitiser

# Samples in one period of the sine; its share of the range, and that of the noise.
_PERIOD = 100
_SINE = 0.7
_NOISE = 0.03


class Signals(Protocol):
    """Volts at the inputs of channels."""

    def begin(self, sample_rate: float) -> None:
        """Start a new stream at a rate [Hz]."""
        ...

    def volts(
        self, first: int, count: int, channels: Sequence[VirtualChannel]
    ) -> FloatArray:
        """Return samples [V], shape (n_channels, count)."""
        ...


class SpecimenSignals:
    """Signals of a specimen; calls of several tasks are serialised."""

    def __init__(self, specimen: Specimen) -> None:
        self._specimen = specimen
        self._lock = threading.Lock()

    def begin(self, sample_rate: float) -> None:
        """Start a new stream."""
        with self._lock:
            self._specimen.begin(sample_rate)

    def volts(
        self, first: int, count: int, channels: Sequence[VirtualChannel]
    ) -> FloatArray:
        """Return samples [V], shape (n_channels, count)."""
        with self._lock:
            numbers = [channel.input.number for channel in channels]
            return self._specimen.volts(first, count, numbers)


class SineSignals:
    """A noisy sine within the limits of each channel, as NI's simulated devices give.

    Source:
        NI-DAQmx help, NI-DAQmx Simulated Device Considerations.
    """

    def begin(self, sample_rate: float) -> None:
        """Nothing to start."""

    def volts(
        self, first: int, count: int, channels: Sequence[VirtualChannel]
    ) -> FloatArray:
        """Return samples [V], shape (n_channels, count)."""
        at = np.arange(first, first + count)
        wave = _SINE * np.sin(2 * np.pi * at / _PERIOD)
        made = []
        for channel in channels:
            # A number by sample, so that a sample does not depend on the reads.
            noise = np.modf(np.sin(12.9898 * at + channel.input.number) * 43758.5453)[0]
            low, high = (channel.values.number(name) for name in ("AI_MIN", "AI_MAX"))
            middle, half = 0.5 * (low + high), 0.5 * (high - low)
            made.append(
                channel.volts_per_unit * (middle + half * (wave + _NOISE * noise))
            )
        return np.array(made)


def digitised(
    volts: FloatArray, channels: Sequence[VirtualChannel], overloaded: set[str]
) -> FloatArray:
    """Return what the converters make of signals [V]; note who is overloaded."""
    made = np.empty_like(volts)
    for row, channel in enumerate(channels):
        module = channel.input.device.type
        half = channel.range or max(module.ranges)
        made[row] = Digitiser(half, 0.0, module.bits).round(volts[row])
        top = half * (1 - 2.0 ** (2 - module.bits))
        if float(np.abs(made[row]).max(initial=0.0)) >= top:
            overloaded.add(channel.name)
    return made
