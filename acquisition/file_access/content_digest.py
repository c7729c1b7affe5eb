# SPDX-License-Identifier: MIT
"""A digest of the content of an HDF5 file, stored in it, against accidental changes.

The digest is over names, types, shapes, values, dimensions and attributes, not over the
bytes of the file: copying or repacking keeps it, a changed number does not. It contains
    no secret, so a deliberate change can include a new digest.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from hashlib import sha256
from operator import itemgetter
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from h5py import h5a

from jointbench.acquisition.basics.errors import CorruptedFile
from jointbench.acquisition.basics.steady_memory import return_freed_memory
from jointbench.acquisition.file_access.create_netcdf import new_file
from jointbench.acquisition.file_access.hdf5_layout import dimension_names
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.file_access.netcdf_write import write_attributes
from jointbench.acquisition.file_access.quoting import named

DIGEST = "content_sha256"
"""Attribute of the root that holds the digest."""
_NOT_CONTENT = {DIGEST, "DIMENSION_LIST", "REFERENCE_LIST"}
"""Left out: the digest itself, and scales, which are included by name."""
_PIECE = 2**22
"""Values are read in pieces of about this size [bytes]."""
_DAMAGE = (KeyError, ValueError, TypeError, OSError, RuntimeError)


class Seal(StrEnum):
    """Result of the comparison of a file with its digest."""

    WHOLE = "whole"
    UNSIGNED = "unsigned"
    CORRUPTED = "rotten"  # word in files


@contextmanager
def new_signed_file(
    path: Path | str, *, schema: str, title: str
) -> Iterator[h5py.File]:
    """Write a file as `new_file` does, replacing an earlier one, with its digest.

    Args:
        path: of the new file.
        schema: name and version of the layout.
        title: one line for readers in other programs.

    Yields:
        The open file.

    Raises:
        UsageError: it cannot be written there.
    """
    return_freed_memory()  # the file is made in memory, and copied once
    with new_file(path, schema=schema, title=title, overwrite=True) as file:
        yield file
        write_attributes(file, {DIGEST: content_digest(file)})


def seal_of(file: h5py.File) -> Seal:
    """Compare the content of a file with its digest; a file without one is not read.

    Args:
        file: opened by `hdf5_guards.open_guarded`, as all of it is read.
    """
    stored = read_attribute(file, DIGEST)
    if stored is None:
        return Seal.UNSIGNED
    try:
        same = content_digest(file) == stored
    except _DAMAGE:  # a checksum of HDF5 itself, for example
        return Seal.CORRUPTED
    return Seal.WHOLE if same else Seal.CORRUPTED


def require_whole(file: h5py.File, path: Path | str) -> None:
    """Raise `CorruptedFile` if the content of a file does not match its digest."""
    if seal_of(file) is Seal.CORRUPTED:
        raise CorruptedFile(
            f"{named(path)} is corrupted: its content does not match its digest; "
            "make it again from the session, or use another copy"
        )


def content_digest(file: h5py.File) -> str:
    """Return the SHA-256 of the content of a file, as hexadecimal text."""
    digest = sha256()
    waiting: list[tuple[str, h5py.Group | h5py.Dataset]] = [("/", file)]
    scales: dict[int, str] = {}
    while waiting:
        path, item = waiting.pop()
        digest.update(f"{path}\n".encode("utf-8", "surrogateescape"))
        for text in _attributes(item):
            digest.update(text)
        if isinstance(item, h5py.Dataset):
            digest.update(_kind(item, scales))
            for piece in _pieces(item):
                digest.update(piece)
        else:
            # Asking HDF5 for the path of each object takes longer than its values.
            above = path.rstrip("/")
            waiting += [(f"{above}/{k}", item[k]) for k in sorted(item, reverse=True)]
    return digest.hexdigest()


def _attributes(item: h5py.Group | h5py.Dataset) -> Iterator[bytes]:
    each = (h5a.open(item.id, index=i) for i in range(h5a.get_num_attrs(item.id)))
    found = [(one.name.decode("utf-8", "surrogateescape"), one) for one in each]
    for name, attribute in sorted(found, key=itemgetter(0)):
        if name in _NOT_CONTENT:
            continue
        values: np.ndarray[Any, Any] = np.empty(attribute.shape, attribute.dtype)
        attribute.read(values)
        data = values.tobytes()
        if values.dtype.hasobject:  # a text of variable length: of another program
            data = repr(values.tolist()).encode("utf-8", "surrogateescape")
        yield f"{name} {values.dtype.str} {values.shape}\n".encode() + data


def _kind(dataset: h5py.Dataset, scales: dict[int, str]) -> bytes:
    names = " ".join(dimension_names(dataset, scales))
    return f"{dataset.dtype.str} {dataset.shape} {names}\n".encode()


def _pieces(dataset: h5py.Dataset) -> Iterator[bytes]:
    if dataset.ndim == 0 or dataset.nbytes <= _PIECE:
        yield np.asarray(dataset[()]).tobytes()
        return
    rows = max(1, _PIECE * dataset.shape[0] // dataset.nbytes)
    for first in range(0, dataset.shape[0], rows):
        yield np.asarray(dataset[first : first + rows]).tobytes()
