# SPDX-License-Identifier: MIT
"""Arguments and options that say what is read, and what is known of it."""

from pathlib import Path
from typing import Annotated

import typer

_COLUMNS_HELP = (
    "Roles and units of a plain table's columns, for example "
    "'time:s,force:N,acceleration:m/s^2' or 'x:um,z:um'."
)
Files = Annotated[list[Path], typer.Argument(help="Files to read.", show_default=False)]
Columns = Annotated[str | None, typer.Option("--columns", help=_COLUMNS_HELP)]
Point = Annotated[str, typer.Option(help="Where the hammer struck.")]
Preload = Annotated[
    str | None, typer.Option(help="On the joint, '4 kN', where no session says.")
]
Sessions = Annotated[list[Path] | None, typer.Argument(help="Session files.")]
FullScale = Annotated[
    float | None,
    typer.Option(help="WAV: what its largest number stands for, in the columns' unit."),
]
