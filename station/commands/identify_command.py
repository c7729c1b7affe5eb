# SPDX-License-Identifier: MIT
"""The options of ``jointbench identify``; the work is done elsewhere, when it runs."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.input_options import Sessions
from jointbench.station.commands.shared_options.joint_options import Cache, Faces
from jointbench.station.commands.shared_options.mode_fit_options import Band
from jointbench.station.commands.shared_options.output_options import Debug, Json, Page
from jointbench.station.screen.exit_codes import EXIT_QUALITY


def identify_command(
    model: Annotated[Path, typer.Argument(help="Bench or structure model, TOML.")],
    sessions: Sessions = None,
    band: Band = None,
    cache: Cache = None,
    surface: Faces = None,
    report: Page = None,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Identify joints: of a lumped bench [links], or of meshed bodies [joints].

    Example: jointbench identify bench.toml session.h5 --json joint.json
    """
    from jointbench.station.commands.identify_links_command import identify_any

    fits = identify_any(
        model,
        sessions or [],
        band=band,
        cache=cache,
        report=report,
        json_target=json,
        surfaces=surface or [],
    )
    return 0 if fits else EXIT_QUALITY
