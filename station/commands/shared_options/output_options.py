# SPDX-License-Identifier: MIT
"""Options of the output: files to write, and their format."""

from pathlib import Path
from typing import Annotated

import typer

Json = Annotated[
    str | None,
    typer.Option(
        "--json",
        metavar="PATH",
        help="Write the results as JSON; '-' for standard output.",
    ),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]
Force = Annotated[bool, typer.Option("--force", help="Overwrite existing output.")]
SessionOut = Annotated[
    Path, typer.Option("--out", metavar="PATH", help="Session file to write (.h5).")
]
Results = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="Results file to write (.h5); next to a session by default.",
    ),
]
Universal = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="Universal file to write: FRFs (data set 58) and mode shapes (55).",
    ),
]
HtmlReport = Annotated[
    Path | None, typer.Option(metavar="PATH", help="HTML report to write.")
]
