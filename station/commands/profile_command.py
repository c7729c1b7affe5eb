# SPDX-License-Identifier: MIT
"""``jointbench profile``: a roughness profile from a tester on a serial line."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.output_options import Debug, Force, Json


def profile_command(
    instrument: Annotated[
        str,
        typer.Argument(
            metavar="INSTRUMENT",
            help="diavite, mitutoyo, or a tester that a package adds.",
        ),
    ],
    line: Annotated[
        str,
        typer.Argument(
            metavar="LINE",
            help="Serial line: COM3, /dev/ttyUSB0, socket://HOST:PORT or sim:diavite.",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(metavar="PATH", help="Table of x and z to write (.csv)."),
    ] = None,
    session: Annotated[
        Path | None,
        typer.Option(metavar="PATH", help="Session to add the profile to (.h5)."),
    ] = None,
    name: Annotated[
        str, typer.Option(metavar="NAME", help="Name of the profile.")
    ] = "profile",
    traverse: Annotated[
        str | None,
        typer.Option(
            metavar="QUANTITY",
            help="Diavite DH-8: traverse length, for example '4.8 mm'.",
        ),
    ] = None,
    baud: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Baud rate [bit/s], for example 9600; 115200 for diavite "
            "and 9600 for mitutoyo by default.",
        ),
    ] = None,
    filtered: Annotated[
        bool,
        typer.Option(
            "--filtered", help="Diavite DH-8: read the filtered roughness profile."
        ),
    ] = False,
    unsigned: Annotated[
        bool,
        typer.Option("--unsigned", help="Diavite DH-8: heights are unsigned numbers."),
    ] = False,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Read the last profile of a roughness tester.

    Examples:
        jointbench profile diavite COM3 --traverse '4.8 mm' --out face-a.csv
        jointbench profile mitutoyo /dev/ttyUSB0 --name surface-b --session session.h5
    """
    from jointbench.station.sources.read_profile import ProfileRequest, run_profile

    wanted = ProfileRequest(
        instrument, line, name, traverse, baud, filtered, not unsigned
    )
    run_profile(wanted, out=out, session=session, overwrite=force, json_target=json)
