# SPDX-License-Identifier: MIT
"""Measured modes with their uncertainty, the input of an identification."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredModes:
    """Modes of a bench, by ascending frequency.

    Attributes:
        natural_frequency: [Hz], shape (n_modes,).
        frequency_sd: [Hz], shape (n_modes,).
        damping_ratio: [-], shape (n_modes,), or None if not measured.
        damping_ratio_sd: [-], shape (n_modes,), or None.
        shapes: response at each output, of any scale for each mode, shape (n_modes,
            n_outputs), or None if not measured.
        shape_sd: of the real and of the imaginary part of `shapes`, in their scale,
            shape (n_modes, n_outputs), or None.
        outputs: the body of each output.
    """

    natural_frequency: FloatArray
    frequency_sd: FloatArray
    damping_ratio: FloatArray | None = None
    damping_ratio_sd: FloatArray | None = None
    shapes: ComplexArray | None = None
    shape_sd: FloatArray | None = None
    outputs: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check shapes and signs once and make the arrays read-only."""
        require_shape("natural_frequency", self.natural_frequency, (None,))
        n_modes, n_outputs = self.natural_frequency.size, len(self.outputs)
        _require(self, "natural_frequency", (n_modes,), above=0.0)
        _require(self, "frequency_sd", (n_modes,), above=0.0)
        if n_modes == 0 or np.any(np.diff(self.natural_frequency) <= 0):
            raise BadData(
                f"natural frequencies are {self.natural_frequency.tolist()} Hz; give "
                "at least one, in ascending order"
            )
        _require_pair(self, "damping_ratio", "damping_ratio_sd")
        _require_pair(self, "shapes", "shape_sd")
        _require(self, "damping_ratio", (n_modes,))
        _require(self, "damping_ratio_sd", (n_modes,), above=0.0)
        _require(self, "shapes", (n_modes, n_outputs))
        _require(self, "shape_sd", (n_modes, n_outputs), above=0.0)
        freeze(self, *(name for name in self.__slots__ if name != "outputs"))


def _require_pair(modes: MeasuredModes, name: str, sd: str) -> None:
    """Raise where a measured quantity lacks its uncertainty."""
    if (getattr(modes, name) is None) != (getattr(modes, sd) is None):
        raise BadData(f"{name} and {sd} belong together; give both or neither")


def _require(
    modes: MeasuredModes,
    name: str,
    shape: tuple[int, ...],
    *,
    above: float | None = None,
) -> None:
    """Raise unless an array has its shape and holds finite values above a bound."""
    values: NDArray[Any] | None = getattr(modes, name)
    if values is None:
        return
    require_shape(name, values, shape)
    if not np.all(np.isfinite(values)):
        raise BadData(f"{name} holds values that are not finite; leave that mode out")
    if above is not None and np.any(values <= above):
        raise BadData(
            f"{name} is {np.min(values):g} at least once, it must exceed {above:g}; "
            "an uncertainty of zero would make one number outweigh all others"
        )
