# SPDX-License-Identifier: MIT
"""Options that say what is written, where, and whether over what is there."""

from pathlib import Path
from typing import Annotated

import typer

Json = Annotated[
    str | None,
    typer.Option("--json", metavar="PATH", help="Write results as JSON; '-' = stdout."),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]
Force = Annotated[bool, typer.Option("--force", help="Overwrite existing output.")]
Results = Annotated[
    Path | None, typer.Option(help="Results file; beside a session by default.")
]
Universal = Annotated[
    Path | None,
    typer.Option(help="Universal file for FRFs (58) and mode shapes (55)."),
]
Page = Annotated[Path | None, typer.Option(help="HTML page to write.")]
