# SPDX-License-Identifier: MIT
"""Arrays that are computed once and kept on disk under a key of their input."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]


def write_arrays(
    folder: Path | None, key: str, arrays: Mapping[str, NDArray[Any]]
) -> None:
    """Write the arrays of a key; without a folder nothing is written."""
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / f"{key}.part.npz"
    np.savez(part, allow_pickle=False, **arrays)
    os.replace(part, folder / f"{key}.npz")  # noqa: PTH105 - replaces on Windows too


def read_arrays(folder: Path | None, key: str) -> Arrays | None:
    """Return the arrays of a file; None if there is none, or it is truncated."""
    if folder is None or not (folder / f"{key}.npz").is_file():
        return None
    try:
        with np.load(folder / f"{key}.npz", allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except (OSError, ValueError, KeyError, EOFError):
        return None
