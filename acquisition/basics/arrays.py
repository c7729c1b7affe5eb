# SPDX-License-Identifier: MIT
"""Array types, and read-only arrays."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]


def freeze(record: object, *names: str) -> None:
    """Replace the named array fields of a frozen record by read-only arrays.

    Arrays that can be written to are copied, so that no caller can change a record
    afterwards; `None` fields stay `None`.
    """
    for name in names:
        value = getattr(record, name)
        if value is not None:
            object.__setattr__(record, name, read_only(value))


def read_only(values: Any) -> NDArray[Any]:
    """Return `values` as a read-only array, copied if it could be written to."""
    array = np.asarray(values)
    if array.flags.writeable:
        array = array.copy()
        array.flags.writeable = False
    return array


def squared_size(values: ComplexArray) -> FloatArray:
    """Return |values|^2, four times faster than by real and imaginary part."""
    parts = np.square(np.ascontiguousarray(values).view(np.float64))
    return np.asarray(parts[..., ::2] + parts[..., 1::2])
