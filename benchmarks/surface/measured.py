# SPDX-License-Identifier: MIT
"""What the band-limited fit says of the measured surfaces in a folder.

python -m benchmarks.surface.measured ../shared/data/surfaces prints a table. Plain
tables are read with the columns given by --columns NAME=COLUMNS, which may be repeated.
"""

import argparse
from pathlib import Path

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.station.files.input_files import read_surfaces
from jointbench.station.screen.band_limited_words import band_rows
from jointbench.station.screen.value_text import engineering

NO_SURFACES = {".tx3"}
HEAD = ("surface", "result (95 %)", "waves", "longest waves")


def row(path: Path, columns: str | None) -> tuple[str, ...]:
    """Return the row of a file, or the line that refuses it."""
    try:
        ((_, surface),) = read_surfaces([path], columns=columns)
        fit = fit_band_limited([surface])
    except JointbenchError as error:
        reason = str(error).replace(str(path), path.name)
        return (path.name, "-", "-", reason)
    moments = fit.moments
    waves = "-"
    if moments is not None:
        ends = (moments.shortest, moments.longest)
        waves = " to ".join(engineering(end, "m") for end in ends)
    said = fit.verdict.value
    if fit.tolerance > 0:
        said += f" (within {100 * fit.tolerance:.0f} %)"
    parts = [f"{name} {value} ({ends})" for _, name, value, ends in band_rows("", fit)]
    return (path.name, "; ".join(parts), waves, said)


def main() -> None:
    """Fit every file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--columns", action="append", default=[])
    asked = parser.parse_args()
    columns = dict(one.split("=", 1) for one in asked.columns)
    print(f"| {' | '.join(HEAD)} |\n{'|---' * len(HEAD)}|")
    for path in sorted(asked.folder.rglob("*")):
        skipped = path.suffix in NO_SURFACES or path.name.startswith("SYNTHETIC")
        if path.is_file() and not skipped:
            cells = row(path, columns.get(path.name))
            print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
