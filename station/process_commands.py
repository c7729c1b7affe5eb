# SPDX-License-Identifier: MIT
"""The commands of offline work: their names and options; the work is done elsewhere."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.exit_codes import EXIT_QUALITY
from jointbench.station.options import Debug, Json

RecipeFile = Annotated[
    Path | None,
    typer.Option("--recipe", help="Recipe (TOML); chosen by the data when left out."),
]
Stages = Annotated[
    Path | None,
    typer.Option(help="Folder of kept stages; .jointbench-stages beside the results."),
]
Again = Annotated[bool, typer.Option("--again", help="Work again, whatever is there.")]


def process_command(
    session: Annotated[Path, typer.Argument(help="Session file; it is only read.")],
    recipe: RecipeFile = None,
    out: Annotated[
        Path | None, typer.Option(help="Results file; beside the session by default.")
    ] = None,
    stages: Stages = None,
    again: Again = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Read a recorded session again under a recipe: hits, FRFs, modes, surfaces, joint.

    Example: jointbench process session.h5 --recipe narrow.toml
    """
    from jointbench.station.process import run_process

    run_process(
        session, recipe=recipe, out=out, stages=stages, again=again, json_target=json
    )
