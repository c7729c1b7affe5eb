# SPDX-License-Identifier: MIT
"""Checks of arrays and numbers at the creation of records."""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.errors import ShapeError


class Shaped(Protocol):
    """An array, or what stands for one."""

    @property
    def ndim(self) -> int:
        """Number of axes."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Length of each axis."""


def require_shape(name: str, array: Shaped, shape: Sequence[int | None]) -> None:
    """Raise `ShapeError` unless `array` has `shape`; `None` means any length."""
    if len(shape) != array.ndim or any(
        want is not None and want != got
        for want, got in zip(shape, array.shape, strict=False)
    ):
        wanted = ", ".join("any" if n is None else str(n) for n in shape)
        raise ShapeError(f"{name!r} has shape {array.shape}, expected ({wanted})")


def require_finite(name: str, array: NDArray[Any]) -> None:
    """Raise `ShapeError` if a value of `array` is NaN or infinite."""
    bad = np.flatnonzero(~np.isfinite(array).ravel())
    if bad.size:
        raise ShapeError(
            f"{name!r} holds {bad.size} values that are not finite, "
            f"the first at index {bad[0]}"
        )


def require_ascending(name: str, array: NDArray[Any]) -> None:
    """Raise `ShapeError` unless `array` rises strictly."""
    if array.ndim != 1 or (array.size > 1 and not np.all(np.diff(array) > 0)):
        raise ShapeError(f"{name!r} must be one-dimensional and rise strictly")


def require_positive(name: str, value: float) -> None:
    """Raise `ShapeError` unless `value` is finite and above zero."""
    if not (np.isfinite(value) and value > 0):
        raise ShapeError(f"{name!r} is {value!r}, it must be finite and positive")
