# SPDX-License-Identifier: MIT
"""Sessions processed by a recipe, and the results of many in one table."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING

from jointbench.acquisition.basics.errors import BadData
from jointbench.station.archive.archive_table import (
    Row,
    read_results,
    table_rows,
    write_table,
)
from jointbench.station.archive.process_file import State, Task, process_task
from jointbench.station.archive.process_outcome import (
    quantity_cells,
    recipe_or_default,
    stages_folder,
)
from jointbench.station.files.archive_patterns import result_files
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.library.argument_checks import one_path, require_lists
from jointbench.station.library.labelled_arrays import dataset
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.results.processed_file import processed_path
from jointbench.station.results.results_read import (
    StoredResult,
    read_result,
    without_copies,
)

if TYPE_CHECKING:
    from xarray import Dataset

_SHOWN = 20
"""Rows of an archive that are displayed."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ProcessedResult(Shown):
    """What a recipe made of a session.

    Attributes:
        stored: quantities with standard deviations, and facts of the session.
    """

    stored: StoredResult

    @property
    def view(self) -> ResultView:
        """One row a quantity."""
        rows = tuple(quantity_cells(one) for one in self.stored.quantities)
        columns = ("part", "quantity", "value ± sd", "unit")
        title = f"{self.stored.path.name}: recipe {self.stored.facts['recipe_name']!r}"
        return ResultView(title, columns, rows, tuple(self.stored.remarks))


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ResultArchive(Shown):
    """The numbers of many results, one row each.

    Attributes:
        rows: session, specimen, torque, preload, recipe, quantity, value and sd.
        left_out: results that could not be read, with the reason.
    """

    rows: tuple[Row, ...]
    left_out: tuple[tuple[Path, str], ...] = ()

    def write(self, path: str | Path) -> Path:
        """Write the table: .csv, .mat, .nc or .parquet.

        Raises:
            UsageError: another ending, or Parquet without its library.
        """
        write_table(Path(path), self.rows)
        return Path(path)

    def to_xarray(self) -> "Dataset":
        """Return every column over the rows; torque, preload and day have units."""
        units = {"torque": "N m", "preload": "N", "day": "d"}
        columns = {
            one.name: (
                ("row",),
                [getattr(row, one.name) for row in self.rows],
                units.get(one.name, "1"),
                one.name.replace("_", " "),
            )
            for one in fields(Row)
        }
        return dataset(columns, {}, {})

    @property
    def view(self) -> ResultView:
        """The first rows, and what was left out."""
        rows = [
            (
                row.file,
                row.part,
                f"{row.name} {row.item}".strip(),
                f"{row.value:.6g}",
                f"{row.sd:.2g}",
                row.unit,
            )
            for row in self.rows[:_SHOWN]
        ]
        said = [f"left out: {path}: {reason}" for path, reason in self.left_out]
        rest = len(self.rows) - len(rows)
        said += [f"and {rest} more rows"] if rest > 0 else []
        columns = ("file", "part", "quantity", "value", "sd", "unit")
        return ResultView(
            f"{len(self.rows)} numbers", columns, tuple(rows), tuple(said)
        )


def process(
    session: str | Path,
    recipe: str | Path | None = None,
    *,
    out: str | Path | None = None,
) -> ProcessedResult:
    """Process a session by a recipe and write the result next to it.

    Args:
        session: is only read.
        recipe: TOML; None for the defaults.
        out: results file; None for next to the session.

    Returns:
        The quantities with their standard deviations.

    Raises:
        BadData: the session or the recipe cannot be used.
    """
    file = one_path(session, "a session")
    made = recipe_or_default(None if recipe is None else one_path(recipe, "a recipe"))
    target = processed_path(file, made) if out is None else one_path(out, "results")
    check_outputs([file], [target])
    outcome = process_task(Task(file, target, stages_folder(target)), made)
    if outcome.unwritable or outcome.state is State.FAILED:
        raise BadData(outcome.reason)
    return ProcessedResult(read_result(target))


def archive(results: str | Path | Sequence[str | Path]) -> ResultArchive:
    """Collect the results of many sessions in one table.

    Args:
        results: results files, folders or patterns, ``"archive/**/*.results.h5"``.

    Returns:
        One row a number; copies of a result count once.

    Raises:
        BadData: there is no result with a quantity.
    """
    if not isinstance(results, str | Path):
        require_lists("['archive/**/*.results.h5']", results=results)
    given = [results] if isinstance(results, str | Path) else results
    names = [str(one_path(one, "results, a folder or a pattern")) for one in given]
    found, refused = read_results(result_files(names))
    kept, _ = without_copies(found)
    rows = table_rows(kept)
    if not rows:
        raise BadData(f"none of {len(found) + len(refused)} results has a quantity")
    return ResultArchive(tuple(rows), tuple(refused))
