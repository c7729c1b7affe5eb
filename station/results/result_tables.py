# SPDX-License-Identifier: MIT
"""What a results file holds, as tables for other programs: see `export_command`."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.file_access.hdf5_layout import (
    dimension_names,
    is_dimension_only,
)
from jointbench.acquisition.file_access.netcdf_read import (
    read_array,
    read_attribute,
    read_complex,
    read_flags,
    read_texts,
)
from jointbench.signal.frf.frf import Frf
from jointbench.station.files.table_files import ExportColumn, ExportTable
from jointbench.station.results.results_modes import stored_frf
from jointbench.station.results.results_read import open_result

JSON_GROUPS = ("recipe", "pages/contact", "pages/joint", "pages/gap")
"""Groups that hold JSON, which goes out as it is."""
FACTS = ("of", "name", "value")
"""Columns of the table of facts: name of the group, of the attribute, and value."""


@dataclass(frozen=True, slots=True, eq=False)
class ModeTables:
    """Modes of a results file, as far as a universal file takes them.

    Attributes:
        natural_frequency: [Hz], shape (n_modes,).
        poles: [rad/s], shape (n_modes,).
        shapes: largest component 1, shape (n_modes, n_outputs).
    """

    natural_frequency: FloatArray
    poles: ComplexArray
    shapes: ComplexArray


def result_tables(path: Path) -> list[ExportTable]:
    """Return every group of a results file as a table of its own, words as words.

    Raises:
        BadData: it is damaged, or asks for more than a result would.
    """
    with open_result(path) as file:
        groups = [file, *_groups_below(file)]
        tables = [table for group in groups if (table := _table(group)).columns]
        facts = _facts(groups)
    return [facts, *tables]


def result_texts(path: Path) -> dict[str, str]:
    """Return the recipe and the JSON documents of contact, joint and gap by name."""
    with open_result(path) as file:
        return {
            name.rpartition("/")[2]: "".join(read_texts(file[f"{name}/text"]))
            for name in JSON_GROUPS
            if name in file
        }


def result_modes(path: Path) -> list[tuple[str, Frf, ModeTables]]:
    """Return the FRFs and modes of a results file: name of the group, and both.

    Raises:
        BadData: it is damaged, or asks for more than a result would.
    """
    with open_result(path) as file:
        return [
            (_name(group), stored_frf(group["frf"]), _modes(group["modes"]))
            for group in [file, *_groups_below(file)]
            if "frf" in group and "modes" in group
        ]


def _groups_below(file: h5py.File) -> Iterator[h5py.Group]:
    names: list[str] = []
    file.visit(names.append)
    for name in names:
        if name not in JSON_GROUPS and isinstance(file[name], h5py.Group):
            yield file[name]


def _name(group: h5py.Group) -> str:
    return str(group.name).strip("/").replace("/", "-")


def _table(group: h5py.Group) -> ExportTable:
    columns = dict(_columns(group))
    labels = {
        name.removesuffix("_label"): tuple(np.asarray(column.values).tolist())
        for name, column in columns.items()
        if name.endswith("_label")
    }
    if "residue" in columns:
        shapes = shapes_of(np.asarray(columns["residue"].values))
        columns["shape"] = ExportColumn("1", shapes, ("mode", "output"))
    return ExportTable(_name(group), columns, labels)


def _columns(group: h5py.Group) -> Iterator[tuple[str, ExportColumn]]:
    for name, item in group.items():
        if not isinstance(item, h5py.Dataset) or is_dimension_only(item):
            continue
        unit, dims = str(read_attribute(item, "units") or ""), dimension_names(item)
        if item.dtype == np.dtype("S1"):
            yield name, ExportColumn("", np.array(read_texts(item), np.str_), dims[:1])
        elif read_attribute(item, "flag_meanings"):
            yield name, ExportColumn("", np.array(read_flags(item), np.str_), dims)
        elif name.endswith("_re") and f"{name[:-3]}_im" in group:
            yield name[:-3], ExportColumn(unit, read_complex(group, name[:-3]), dims)
        elif not name.endswith("_im"):
            yield name, ExportColumn(unit, read_array(item), dims)


def _facts(groups: list[h5py.Group]) -> ExportTable:
    """Return what is written beside the arrays: when, by what, windows, averages."""
    rows = [
        (_name(group), str(name), str(value))
        for group in groups
        for name in group.attrs
        if (value := read_attribute(group, name)) is not None
    ]
    columns = zip(FACTS, zip(*rows, strict=True), strict=True)
    return ExportTable(
        "facts",
        {
            name: ExportColumn("", np.array(texts, np.str_), ("fact",))
            for name, texts in columns
        },
    )


def shapes_of(residues: ComplexArray) -> ComplexArray:
    """Return mode shapes, largest component 1, from residues of rank one.

    Args:
        residues: shape (n_modes, n_outputs, n_inputs).

    Returns:
        Shape (n_modes, n_outputs).
    """
    found = np.empty(residues.shape[:2], dtype=np.complex128)
    for number, residue in enumerate(residues):
        row, column = np.unravel_index(np.argmax(np.abs(residue)), residue.shape)
        found[number] = residue[:, column] / residue[row, column]
        # A complex number over itself may differ from 1 by its rounding.
        found[number, row] = 1.0
    return found


def _modes(group: h5py.Group) -> ModeTables:
    frequency, ratio = (
        read_array(group[name]) for name in ("natural_frequency", "damping_ratio")
    )
    omega = 2.0 * np.pi * frequency
    poles = omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2))
    return ModeTables(frequency, poles, shapes_of(read_complex(group, "residue")))
