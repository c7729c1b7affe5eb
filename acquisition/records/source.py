# SPDX-License-Identifier: MIT
"""Interface of every source of samples: channels, sample rate and blocks."""

from collections.abc import Iterator
from typing import Protocol

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel


class Source(Protocol):
    """A chassis, a simulated bench or a replayed file; opened by a context manager."""

    @property
    def name(self) -> str:
        """Name in the session file, for example ``"sim:two-body?seed=1"``."""
        ...

    @property
    def simulated(self) -> bool:
        """True for simulated hardware."""
        ...

    @property
    def channels(self) -> tuple[Channel, ...]:
        """The channels, in the order of the rows of every block."""
        ...

    @property
    def sample_rate(self) -> float:
        """Samples per second and channel [Hz]."""
        ...

    def blocks(self) -> Iterator[FloatArray]:
        """Yield successive samples in SI units, shape (n_channels, block)."""
        ...


class Run(Source, Protocol):
    """One run of a measurement, recorded under one setting of the joint."""

    @property
    def preload(self) -> float | None:
        """Preload on the joint during the run [N]; None if not given."""
        ...

    @property
    def start_time(self) -> float:
        """Time of the first sample since the start of the measurement [s]."""
        ...
