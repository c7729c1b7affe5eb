# SPDX-License-Identifier: MIT
"""What a MAT file holds, of any version from 5 on: structs, texts, arrays."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.formats.mat5_structs import read_mat5
from jointbench.acquisition.formats.mat73_structs import read_mat73
from jointbench.acquisition.formats.tables import read_head

_HDF5 = (b"\x89HDF", b"MATLAB 7.3")
_DEEPEST = 4


def read_mat(path: Path) -> dict[str, Any]:
    """Return the variables of a MAT file of any version from 5 on.

    Raises:
        FormatError: it is damaged.
        HostileFile: it asks for more than a measurement would.
    """
    head = read_head(path, 16)
    return read_mat73(path) if head.startswith(_HDF5) else read_mat5(path)


def plain_arrays(
    content: Mapping[str, Any], prefix: str = "", depth: int = 0
) -> dict[str, NDArray[Any]]:
    """Return all arrays of a file by name, those in structs as ``"struct.field"``."""
    found: dict[str, NDArray[Any]] = {}
    for name, value in content.items():
        for number, one in enumerate(value if isinstance(value, list) else [value], 1):
            own = f"{prefix}{name}" + (f"({number})" if isinstance(value, list) else "")
            if isinstance(one, np.ndarray):
                found[own] = one
            elif isinstance(one, Mapping) and depth < _DEEPEST:
                found |= plain_arrays(one, f"{own}.", depth + 1)
    return found
