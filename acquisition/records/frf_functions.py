# SPDX-License-Identifier: MIT
"""Frequency response functions as a file of another program holds them, one by one."""

from dataclasses import dataclass, field

from jointbench.acquisition.basics.array_checks import (
    require_ascending,
    require_finite,
    require_shape,
)
from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import ShapeError
from jointbench.acquisition.records.provenance import Provenance
from jointbench.acquisition.records.recordings import Quantity


@dataclass(frozen=True, slots=True, eq=False)
class FrfFunction:
    """One FRF: one output, one input.

    Attributes:
        frequency: of the lines [Hz], shape (n_lines,), ascending.
        response: complex FRF [SI unit of `quantity` per N], shape (n_lines,).
        quantity: what the response measures: displacement, velocity, acceleration.
        output: label of the response degree of freedom; empty if not stated.
        input: label of the reference degree of freedom; empty if not stated.
        coherence: ordinary coherence [-], same shape, or None.
        variance: E|error|^2 [unit of the response squared], same shape, or None.
        innovation_noise: variance of white noise of the channel [unit of the response
            squared], same shape, or None; for weights only.
        force_noise: variance due to the noise of the force, likewise.
        force_width: of the force window [s], 0 for none.
        averages: number of averages; 0 if not stated.
        added_decay_rate: of an exponential window [1/s], 0 for none.
        usable_band: lowest and highest excited frequency [Hz], or None.
        provenance: file and format.
    """

    frequency: FloatArray
    response: ComplexArray
    quantity: Quantity
    output: str = ""
    input: str = ""
    coherence: FloatArray | None = None
    variance: FloatArray | None = None
    innovation_noise: FloatArray | None = None
    force_noise: FloatArray | None = None
    force_width: float = 0.0
    averages: int = 0
    added_decay_rate: float = 0.0
    usable_band: tuple[float, float] | None = None
    provenance: Provenance = field(default=())

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        if self.quantity is Quantity.FORCE:
            raise ShapeError("the response of an FRF is a motion, not a force")
        require_ascending("frequency", self.frequency)
        for name in NOISE_ARRAYS:
            array = getattr(self, name)
            if array is not None:
                require_shape(name, array, self.frequency.shape)
                require_finite(name, array)
        for name in ("frequency", "response"):
            require_shape(name, getattr(self, name), self.frequency.shape)
            require_finite(name, getattr(self, name))
        freeze(self, "frequency", "response", *NOISE_ARRAYS)


NOISE_ARRAYS = ("coherence", "variance", "innovation_noise", "force_noise")
"""Attributes that state how noisy each line is."""
