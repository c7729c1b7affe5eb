# SPDX-License-Identifier: MIT
"""Types that netCDF-4 lacks: words as flags, texts, complex numbers."""

from collections.abc import Sequence
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.acquisition.file_access.netcdf_write import (
    encode_text,
    write_attributes,
    write_variable,
)


def write_flags(
    group: h5py.Group,
    name: str,
    codes: Any,
    dims: Sequence[str],
    *,
    meanings: Sequence[str],
    long_name: str,
) -> h5py.Dataset:
    """Write words as small integers (CF flags).

    Args:
        group: where.
        name: of the variable.
        codes: index into `meanings`, any shape.
        dims: one name for each axis.
        meanings: words without blanks, by code.
        long_name: description.
    """
    values = np.asarray(codes, dtype=np.int8)
    dataset = write_variable(group, name, values, dims, long_name=long_name)
    dataset.attrs.create("flag_values", np.arange(len(meanings), dtype=np.int8))
    write_attributes(dataset, {"flag_meanings": " ".join(meanings)})
    return dataset


def write_texts(
    group: h5py.Group, name: str, texts: Sequence[str], dim: str, *, long_name: str
) -> h5py.Dataset:
    """Write one text for each index of a dimension, as UTF-8 characters.

    Raises:
        BadData: a text cannot be stored without loss.
        ShapeError: there are no texts.
    """
    coded = [encode_text(text, name) for text in texts]
    width = max([1, *map(len, coded)])
    table = np.array(coded, dtype=f"S{width}").view("S1").reshape(len(coded), width)
    return write_variable(
        group,
        name,
        table,
        (dim, f"{name}_length"),
        long_name=long_name,
        attributes={"_Encoding": "utf-8"},
    )


def write_labels(
    group: h5py.Group, name: str, texts: Sequence[str], *, long_name: str
) -> h5py.Dataset:
    """Write the coordinate of a dimension whose places have names.

    Texts of a fixed length, one a place: a coordinate has the one dimension of its
    name, which a table of characters has not. Readers of netCDF-4 take it as strings.

    Raises:
        BadData: a text cannot be stored without loss.
    """
    coded = [encode_text(text, name) for text in texts]
    # One byte wide, it would be read as a table of characters.
    kind = h5py.string_dtype("utf-8", max([2, *map(len, coded)]))
    dataset = group.create_dataset(name, data=np.array(coded, dtype=kind), dtype=kind)
    dataset.make_scale(name)
    write_attributes(dataset, {"long_name": long_name})
    return dataset


def units_of_rows(units: Sequence[str]) -> str:
    """Return the unit of a variable whose rows have their own: one, or one a row."""
    return units[0] if len(set(units)) == 1 else ", ".join(units)


def write_complex(
    group: h5py.Group,
    name: str,
    values: ComplexArray,
    dims: Sequence[str],
    *,
    units: str | None = None,
    long_name: str = "",
) -> None:
    """Write complex numbers as two variables, `name`_re and `name`_im."""
    for suffix, part in (("re", np.real(values)), ("im", np.imag(values))):
        words = (
            f"{'real' if suffix == 're' else 'imaginary'} part of {long_name or name}"
        )
        write_variable(
            group, f"{name}_{suffix}", part, dims, units=units, long_name=words
        )
