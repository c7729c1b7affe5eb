# SPDX-License-Identifier: MIT
"""``jointbench example``: data sets to try the commands on."""

from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.examples.example_sets import EXAMPLES, write_example
from jointbench.station.screen.terminal import console, table


def run_example(name: str | None, folder: Path | None, *, overwrite: bool) -> None:
    """Write an example out and name its files; without a name list the examples.

    Raises:
        UsageError: no example of that name, its files cannot be written, or a folder
            is given without a name.
    """
    if name is None and folder is not None:
        names = ", ".join(one.name for one in EXAMPLES)
        raise UsageError(f"--out is '{folder}' without an example; name one of {names}")
    if name is None:
        _list_examples()
        return
    target = write_example(name, folder, overwrite=overwrite)
    screen = console()
    for path in sorted(target.rglob("*")):
        if path.is_file():
            screen.print(str(path), soft_wrap=True)
    screen.print(f"\nnext: the commands of {target / 'README.md'}", soft_wrap=True)


def _list_examples() -> None:
    """Print the examples, one a row."""
    rows = [(one.name, one.summary) for one in EXAMPLES]
    screen = console()
    screen.print(table("Examples", ("name", "content"), rows, words={0, 1}))
    screen.print("\nnext: jointbench example joint", soft_wrap=True)
