# SPDX-License-Identifier: MIT
"""Closed modes whose frequencies an uncertain modal table leaves open."""

from dataclasses import dataclass

from jointbench.acquisition.basics.arrays import FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class TunedModes:
    """Closed modes whose frequencies an uncertain modal table leaves open.

    Attributes:
        rows: modal force on the free modes by each, shape (n_tuned, n_modes).
        omega: nominal natural angular frequencies [rad/s], shape (n_tuned,).
        sd: of the logarithms of their frequencies [-], shape (n_tuned,).
    """

    rows: FloatArray
    omega: FloatArray
    sd: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "rows", "omega", "sd")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of their coordinates."""
        return tuple(tuned_name(k + 1) for k in range(self.omega.size))


def tuned_name(number: int) -> str:
    """Return the name of the frequency coordinate of a closed mode."""
    return f"frequency of mode {number}"
