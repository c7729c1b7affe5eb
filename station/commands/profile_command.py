# SPDX-License-Identifier: MIT
"""``jointbench profile``: a roughness profile from a tester on a serial line."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.output_options import Debug, Force, Json


def profile_command(
    instrument: Annotated[
        str, typer.Argument(help="diavite, mitutoyo, or one that a package adds.")
    ],
    line: Annotated[
        str, typer.Argument(help="COM3, /dev/ttyUSB0, socket://host:port, sim:diavite.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="Table of x and z (.csv) to write.")
    ] = None,
    session: Annotated[
        Path | None, typer.Option(help="Session that the profile is added to.")
    ] = None,
    name: Annotated[str, typer.Option(help="Of the profile.")] = "profile",
    traverse: Annotated[
        str | None, typer.Option(help="DH-8: length that was traced, '4.8 mm'.")
    ] = None,
    baud: Annotated[
        int | None, typer.Option(help="Bits per second; the instrument's usual.")
    ] = None,
    filtered: Annotated[
        bool, typer.Option("--filtered", help="DH-8: the roughness profile.")
    ] = False,
    unsigned: Annotated[
        bool, typer.Option("--unsigned", help="DH-8: heights have no sign.")
    ] = False,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Fetch the profile that a roughness tester measured last.

    Example: jointbench profile diavite COM3 --traverse '4.8 mm' --name face-a --out
    face-a.csv --session visit.h5
    """
    from jointbench.station.sources.read_profile import ProfileRequest, run_profile

    wanted = ProfileRequest(
        instrument, line, name, traverse, baud, filtered, not unsigned
    )
    run_profile(wanted, out=out, session=session, overwrite=force, json_target=json)
