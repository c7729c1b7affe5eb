# SPDX-License-Identifier: MIT
"""Arguments and options that say which joint and which model of it."""

from pathlib import Path
from typing import Annotated

import typer

GAP_HELP = "Sessions or campaign (.h5), record (.mat), model with data (.toml), URL."
Model = Annotated[Path | None, typer.Option(help="Bench model (TOML), with priors.")]
Cache = Annotated[Path | None, typer.Option(help="Folder of reduced structures.")]
Faces = Annotated[
    list[Path] | None,
    typer.Option("--surface", help="Face of the joint, for [contact]; once or twice."),
]
