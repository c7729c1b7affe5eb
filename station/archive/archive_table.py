# SPDX-License-Identifier: MIT
"""All results of an archive as one table: a row a number, in four formats."""

import csv
import io
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, fields
from datetime import datetime
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.file_access.content_digest import new_signed_file
from jointbench.acquisition.file_access.netcdf_encodings import write_texts
from jointbench.acquisition.file_access.netcdf_write import write_variable
from jointbench.acquisition.file_access.quoting import named
from jointbench.station.files.output_paths import whole_file, write_text
from jointbench.station.files.spreadsheet_text import escaped
from jointbench.station.files.table_files import ExportColumn, ExportTable, write_mat
from jointbench.station.results.result_rows import OF_EACH_ROW
from jointbench.station.results.results_read import (
    StoredResult,
    read_result,
)

TABLE_SCHEMA = "jointbench-archive/1"
PARQUET = "pip install 'jointbench[archive]'"


@dataclass(frozen=True, slots=True)
class Row:
    """One number of one session, with all by which an archive is sorted.

    Numbers that are not known are NaN; `day` counts from 1970 [d].
    """

    file: str
    input_sha256: str
    session: str
    recorded: str
    day: float
    operator: str
    specimen: str
    torque: float
    preload: float
    recipe: str
    recipe_sha256: str
    software: str
    part: str
    item: str
    name: str
    unit: str
    value: float
    sd: float
    word: str


def table_rows(results: Sequence[StoredResult]) -> list[Row]:
    """Return one row for each number of each result."""
    return [
        Row(
            file=result.facts["input_file"],
            input_sha256=result.facts["input_sha256"],
            session=result.facts["session"],
            recorded=result.facts["recorded"],
            day=_day(result.facts["recorded"]),
            operator=result.facts["operator"],
            specimen=result.facts["specimen"],
            torque=math.nan if result.torque is None else result.torque,
            preload=one.preload
            if not math.isnan(one.preload) or result.preload is None
            else result.preload,
            recipe=result.facts["recipe_name"],
            recipe_sha256=_recipe_digest(result),
            software=result.facts["software"],
            part=one.part,
            item=one.item,
            name=one.name,
            unit=one.unit,
            value=one.value,
            sd=one.sd,
            word=one.word,
        )
        for result in results
        for one in result.quantities
    ]


def _recipe_digest(result: StoredResult) -> str:
    if not result.recipe:
        return ""
    text = json.dumps(result.recipe, sort_keys=True)
    return sha256(text.encode()).hexdigest()


def _day(text: str) -> float:
    try:
        return datetime.fromisoformat(text).timestamp() / 86_400
    except ValueError:
        return math.nan


def read_results(
    paths: Sequence[Path],
) -> tuple[list[StoredResult], list[tuple[Path, str]]]:
    """Read results files; return them, and those that cannot be read with reasons."""
    found: list[StoredResult] = []
    refused: list[tuple[Path, str]] = []
    for path in paths:
        try:
            found.append(read_result(path))
        except BadData as error:
            refused.append((path, str(error)))
    return found, refused


def left_out_words(path: Path, reason: str) -> str:
    """Say of a results file why it is left out; the reason may begin with its name."""
    return f"left out: {reason if named(path) in reason else f'{path}: {reason}'}"


def write_table(path: Path, rows: Sequence[Row]) -> None:
    """Write the table as its name says: .csv, .mat, .nc or .parquet.

    Raises:
        UsageError: another ending, or Parquet without its library.
    """
    writer_of(path)(path, rows)


def writer_of(path: Path) -> Callable[[Path, Sequence[Row]], None]:
    """Return what writes a table of this name.

    Raises:
        UsageError: no table ends like that.
    """
    writers: dict[str, Callable[[Path, Sequence[Row]], None]] = {
        ".csv": _write_csv,
        ".nc": _write_netcdf,
        ".parquet": _write_parquet,
        ".mat": _write_mat,
    }
    writer = writers.get(path.suffix.lower())
    if writer is None:
        raise UsageError(f"--out is '{path}'; name it *.csv, *.mat, *.nc or *.parquet")
    return writer


def _columns(rows: Sequence[Row]) -> dict[str, list[Any]]:
    names = [field.name for field in fields(Row)]
    return {name: [getattr(row, name) for row in rows] for name in names}


def _write_csv(path: Path, rows: Sequence[Row]) -> None:
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow([field.name for field in fields(Row)])
    for row in rows:
        cells = (
            escaped(cell) if isinstance(cell, str) else _number(cell)
            for cell in astuple(row)
        )
        writer.writerow(list(cells))
    write_text(path, buffer.getvalue())


def _number(value: float) -> str:
    return "" if math.isnan(value) else repr(value)


def _write_netcdf(path: Path, rows: Sequence[Row]) -> None:
    title = "jointbench: all results of an archive, one row a number"
    units = {"torque": "N m", "preload": "N", "day": "days since 1970-01-01"}
    with new_signed_file(path, schema=TABLE_SCHEMA, title=title) as file:
        for name, values in _columns(rows).items():
            if isinstance(values[0], str):
                write_texts(file, name, values, "row", long_name=name)
            else:
                own = units.get(name, OF_EACH_ROW)
                write_variable(file, name, values, ("row",), units=own, long_name=name)


def _write_mat(path: Path, rows: Sequence[Row]) -> None:
    columns = {
        name: ExportColumn("", np.array(values), ("row",))
        for name, values in _columns(rows).items()
    }
    write_mat(path, [ExportTable("archive", columns)])


def _write_parquet(path: Path, rows: Sequence[Row]) -> None:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise UsageError(
            f"Parquet needs pyarrow; type {PARQUET}, or name the table *.nc or *.csv"
        ) from error
    with whole_file(path) as part:
        parquet.write_table(pyarrow.table(_columns(rows)), part)
