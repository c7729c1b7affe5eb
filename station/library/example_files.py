# SPDX-License-Identifier: MIT
"""Example data sets for scripts and notebooks."""

from pathlib import Path

from jointbench.station.examples.example_sets import write_example


def example(
    name: str, folder: str | Path | None = None, *, overwrite: bool = True
) -> Path:
    """Write example data to a folder.

    Args:
        name: of the example; a wrong one lists them all.
        folder: to write to; None for a folder of that name.
        overwrite: replace files of an earlier call.

    Returns:
        The folder, so that ``jb.example("joint") / "session.h5"`` is a file.

    Raises:
        UsageError: there is no such example, or its files cannot be written.
    """
    target = None if folder is None else Path(folder)
    return write_example(name, target, overwrite=overwrite)
