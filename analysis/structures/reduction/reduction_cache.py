# SPDX-License-Identifier: MIT
"""Reduced models on disk, named by a hash of their input."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

# Incremented when the reduction changes, so that old files are not used.
_VERSION = 3
_ARRAYS = ("stiffness", "spread", "loss", "basis", "riesz", "scale", "strains")


def content_key(structure: Structure, *options: object) -> str:
    """Return the SHA-256 of the matrices of a structure and of options."""
    digest = hashlib.sha256(repr((_VERSION, structure.joints, options)).encode())
    for matrix in (
        structure.stiffness,
        structure.mass,
        structure.loss,
        structure.glue,
        *structure.spread,
    ):
        for part in (matrix.indptr, matrix.indices, matrix.data):
            digest.update(np.ascontiguousarray(part).tobytes())
    return digest.hexdigest()


def cached(
    folder: Path | None, key: str, make: Callable[[], ReducedModel]
) -> ReducedModel:
    """Return the reduced model of a key from disk, or create and store it.

    Args:
        folder: of the cache; None stores nothing.
        key: of `content_key`.
        make: creates the model if it is not stored.

    Returns:
        The reduced model.
    """
    if folder is None:
        return make()
    path = folder / f"{key}.npz"
    if path.is_file():
        found = _read(path)
        if found is not None:
            return found
    model = make()
    folder.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part.npz")
    np.savez(
        part,
        shift=model.shift,
        box=np.array(model.box),
        modes=model.modes,
        names=np.array(model.names),
        **{name: getattr(model, name) for name in _ARRAYS},
    )
    os.replace(part, path)  # noqa: PTH105 - replaces on Windows too
    return model


def _read(path: Path) -> ReducedModel | None:
    """Return the model of a file; None if the file is truncated."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in _ARRAYS}
            low, high = file["box"].tolist()
            return ReducedModel(
                **arrays,
                shift=float(file["shift"]),
                box=(low, high),
                modes=int(file["modes"]),
                names=tuple(str(name) for name in file["names"]),
            )
    except (OSError, ValueError, KeyError, EOFError):
        return None
