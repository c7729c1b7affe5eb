# SPDX-License-Identifier: MIT
"""Response of a linear specimen to a force, by its poles."""

from dataclasses import dataclass

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class Poles:
    """Poles and gains for a force at one point; complex conjugates left out.

    Attributes:
        poles: [1/s], shape (n_modes,), the imaginary part positive.
        gains: acceleration at each output for a unit impulse [1/(kg s)], shape
            (n_modes, n_outputs); the response is twice the real part.
        direct: acceleration during the force [1/kg], shape (n_outputs,).
    """

    poles: ComplexArray
    gains: ComplexArray
    direct: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "poles", "gains", "direct")
