# SPDX-License-Identifier: MIT
"""Commands on files: their names and options; other modules do the work."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.output_options import Debug, Force, Json
from jointbench.station.screen.exit_codes import EXIT_QUALITY


def example_command(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]", help="Example to write; without it they are listed."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Folder to write to; the name by default."),
    ] = None,
    force: Force = False,
    debug: Debug = False,
) -> None:
    """Write example data with the commands to try on them.

    Examples:
        jointbench example joint
        jointbench example archive --out year
    """
    from jointbench.station.examples.example_command import run_example

    run_example(name, out, overwrite=force)


def inspect_command(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Session or results file (.h5).")
    ],
    json: Json = None,
    debug: Debug = False,
) -> None:
    """List channels, hits, surfaces and provenance of a file.

    Examples:
        jointbench inspect session.h5
        jointbench inspect session.results.h5 --json -
    """
    from jointbench.station.commands.inspect_command import run_inspect

    run_inspect(file, json_target=json)


def provenance_command(
    result: Annotated[
        Path, typer.Argument(metavar="RESULT", help="Results file (.h5).")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER", help="Folder for all that is needed to run it again."
        ),
    ] = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Show where a result comes from; write all to run it again.

    Inputs, recipe, build, versions, kind of computer, calibration of the sensors and
    the contributions to each standard deviation. No host names, no users, no paths.

    Examples:
        jointbench provenance session.narrow.results.h5 --out again
        jointbench provenance session.results.h5 --json provenance.json
    """
    from jointbench.station.provenance.provenance_command import run_provenance

    run_provenance(result, folder=out, overwrite=force, json_target=json)


def verify_command(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE", help="Sessions, results, folders, quoted patterns."
        ),
    ],
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Check sessions and results: checksums, gaps, digests.

    Examples:
        jointbench verify session.h5
        jointbench verify archive/ --json verified.json
    """
    from jointbench.station.commands.verify_archive import verify_all

    return 0 if verify_all(files, json_target=json) else EXIT_QUALITY


def recover_command(
    file: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="File of the interrupted recording."),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH", help="Session file to write; *.recovered.h5 by default."
        ),
    ] = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Recover a session from an interrupted recording.

    The file of the recording is not changed.

    Examples:
        jointbench recover session.h5 --out recovered.h5
    """
    from jointbench.station.commands.verify_command import run_recover

    run_recover(file, out=out, overwrite=force, json_target=json)


def export_command(
    file: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="Session, results or universal file."),
    ],
    to: Annotated[
        str, typer.Option(metavar="csv|mat|netcdf|uff", help="Format.")
    ] = "csv",
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER", help="Folder to write to; that of the file by default."
        ),
    ] = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Export samples, FRFs, modes and other results with units.

    Examples:
        jointbench export session.results.h5 --to mat
        jointbench export session.h5 --to uff --out exported/
        jointbench export session.h5 --to netcdf --out exported/
    """
    from jointbench.station.commands.export_command import run_export

    run_export(file, kind=to, folder=out, json_target=json)
