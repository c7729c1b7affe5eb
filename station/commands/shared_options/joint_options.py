# SPDX-License-Identifier: MIT
"""Arguments and options that name a joint and its model."""

from pathlib import Path
from typing import Annotated

import typer

GapSources = Annotated[
    list[str],
    typer.Argument(
        metavar="SOURCE",
        help="Sessions or a campaign (.h5), record (.mat), model with data (.toml), "
        "measured surface, or URL of a simulator (sim:).",
        show_default=False,
    ),
]
Model = Annotated[
    Path | None,
    typer.Option(metavar="PATH", help="Bench model (TOML): parameters and priors."),
]
Cache = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Folder that keeps reduced structures."),
]
ContactSurfaces = Annotated[
    list[Path] | None,
    typer.Option(
        "--surface",
        metavar="PATH",
        help="Measured contact surface for the table [contact]; give one or both.",
    ),
]
ChainSurfaces = Annotated[
    list[Path] | None,
    typer.Option(
        "--surface",
        metavar="PATH",
        help="Measured contact surface of the joint: diagnose the whole chain; the "
        "model needs a table [bolted_joint]. Give one or both.",
    ),
]
