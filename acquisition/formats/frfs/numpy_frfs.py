# SPDX-License-Identifier: MIT
"""FRFs from NumPy files: .npz archives of named arrays, and complex .npy arrays.

An archive that SDynPy saved names its functions itself; see `nodal_arrays`.
"""

from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, UnitError
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.column_roles import (
    QUANTITY_NAMES,
    roles_named,
)
from jointbench.acquisition.formats.frfs.frf_arrays import (
    frfs_of_arrays,
    no_units_words,
)
from jointbench.acquisition.formats.frfs.frf_columns import names_frequency, names_frfs
from jointbench.acquisition.formats.frfs.frf_format import FrfFormat, FrfOptions
from jointbench.acquisition.formats.frfs.nodal_arrays import nodal_arrays, nodal_frfs
from jointbench.acquisition.formats.numpy_archives import (
    NPY_MAGIC,
    ZIP_MAGIC,
    is_numpy_archive,
    read_numpy_archive,
    read_numpy_array,
)
from jointbench.acquisition.formats.tables import read_head
from jointbench.acquisition.records.frf_functions import FrfFunction

_COMPLEX_IN_HEADER = (b"<c", b">c")


def recognise_numpy_frfs(path: Path, options: FrfOptions) -> bool:
    """Return whether a file holds FRFs: complex arrays, or by what --columns names."""
    try:
        if is_numpy_archive(path):
            return _archive_of_frfs(path, options)
        head = read_head(path, 200)
    except BadData:
        return False
    # A type of complex numbers in the header: hits and heights are real.
    objects = (b"|O",) if names_frfs(options.columns) else ()
    kinds = (*_COMPLEX_IN_HEADER, *objects)
    return head.startswith(NPY_MAGIC) and any(kind in head for kind in kinds)


def _archive_of_frfs(path: Path, options: FrfOptions) -> bool:
    if names_frfs(options.columns):
        return True
    if roles_named(options.columns) & {"time", *QUANTITY_NAMES}:
        return False
    arrays = read_numpy_archive(path)
    kinds = {array.dtype.kind for array in arrays.values()}
    return "c" in kinds or nodal_arrays(arrays) is not None


def read_numpy_frfs(path: Path, options: FrfOptions) -> tuple[FrfFunction, ...]:
    """Read the FRFs of a NumPy file; see `frfs_of_arrays` and `nodal_frfs`.

    Raises:
        UnitError: `columns` is missing; the message lists the arrays.
        FormatError: it is damaged, or holds objects.
        HostileFile: it claims more than a measurement would hold.
        BadData: see `frfs_of_arrays`.
    """
    file_size(path)
    archive = read_head(path, 4) == ZIP_MAGIC
    arrays = read_numpy_archive(path) if archive else {"frf": read_numpy_array(path)}
    nodal = None if names_frequency(options.columns) else nodal_arrays(arrays)
    if nodal is not None:
        return nodal_frfs(path, nodal, options, "npz of SDynPy")
    if not names_frfs(options.columns):
        raise UnitError(no_units_words(path, list(arrays)))
    return frfs_of_arrays(path, arrays, options, "npz" if archive else "npy")


FORMAT = FrfFormat("numpy_frfs", recognise_numpy_frfs, read_numpy_frfs)
