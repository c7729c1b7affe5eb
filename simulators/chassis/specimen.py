# SPDX-License-Identifier: MIT
"""Specimen at the inputs of the simulated chassis."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel
from jointbench.acquisition.records.source import Source
from jointbench.simulators.machines.running_machine import RunningMachine
from jointbench.simulators.plates.plates_bench import PluggedSensor

INPUT_RANGE = 5.0  # [V]
_KEPT = 4  # earlier blocks kept for late reads
_NO_SENSITIVITY = 1e-3  # [V per SI unit] for a source without one
_NO_RANGE = 0.25  # range for a source without one


class Specimen(Protocol):
    """Volts at inputs, by sample of a stream that begins with each start of a task."""

    def begin(self, sample_rate: float) -> None:
        """Start a new stream from rest at a rate [Hz]."""
        ...

    def volts(self, first: int, count: int, inputs: Sequence[int]) -> FloatArray:
        """Return samples of some inputs [V], shape (n_inputs, count)."""
        ...


class StreamedSpecimen:
    """A source of samples at the inputs: its channels are connected in order.

    After the last sample of the source the inputs are silent.
    """

    def __init__(self, source: Source) -> None:
        self._source = source
        self.sensors = tuple(plugged(channel) for channel in source.channels)
        self._gains = np.array([[sensor.sensitivity] for sensor in self.sensors])
        self._blocks: Iterator[FloatArray] = iter(())
        self._data = np.zeros((len(self.sensors), 0))
        self._from = 0

    def begin(self, sample_rate: float) -> None:
        """Restart the source from its first sample; the rate is that of the source."""
        self._blocks = self._source.blocks()
        self._data, self._from = np.zeros((len(self.sensors), 0)), 0

    def volts(self, first: int, count: int, inputs: Sequence[int]) -> FloatArray:
        """Return samples of some inputs [V], shape (n_inputs, count)."""
        while self._from + self._data.shape[1] < first + count:
            block = next(self._blocks, None)
            if block is None:
                missing = first + count - self._from - self._data.shape[1]
                block = np.zeros((len(self.sensors), missing))
            self._data = np.hstack((self._data, self._gains * block))
        self._forget(first - _KEPT * count)
        begin = first - self._from
        return self._data[list(inputs), begin : begin + count]

    def _forget(self, first: int) -> None:
        drop = max(0, first - self._from)
        self._data = self._data[:, drop:]
        self._from += drop


class MachineSpecimen(StreamedSpecimen):
    """A machine at the inputs, at any sample rate."""

    def __init__(self, machine: RunningMachine) -> None:
        super().__init__(machine)
        self._machine = machine

    def begin(self, sample_rate: float) -> None:
        """Start the machine from rest at a rate [Hz]."""
        self._source = replace(self._machine, sample_rate=sample_rate)
        super().begin(sample_rate)


def plugged(channel: Channel) -> PluggedSensor:
    """Return a sensor whose range is within that of an input."""
    sensitivity = channel.sensitivity or _NO_SENSITIVITY
    if channel.range is None:
        sensitivity *= _NO_RANGE
    else:
        sensitivity = min(sensitivity, INPUT_RANGE / channel.range)
    return PluggedSensor(channel.point, sensitivity, noise=0.0, serial=0)
