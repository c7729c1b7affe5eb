# SPDX-License-Identifier: MIT
"""The options of ``jointbench pressure-map``, as one record."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

_Maps = Annotated[
    list[Path],
    typer.Argument(
        metavar="MAP", help="Measured map of one side, or of both sides in contact."
    ),
]
_Modulus = Annotated[
    str,
    typer.Option(metavar="QUANTITY", help="Composite modulus E*, as '115 GPa'."),
]
_Hardness = Annotated[
    str,
    typer.Option(
        metavar="QUANTITY", help="Hardness of the softer body, as '231 HB' or '2 GPa'."
    ),
]
_Pressure = Annotated[
    list[str],
    typer.Option(
        metavar="QUANTITY", help="Nominal pressure, as '2.5 MPa'; repeatable."
    ),
]
_Cutoff = Annotated[
    str,
    typer.Option(
        metavar="QUANTITY",
        help="Wavelength between roughness and waviness, as '0.8 mm'.",
    ),
]
_Turn = Annotated[
    int,
    typer.Option(
        metavar="ANGLE",
        help="Turn of the second map as measured [deg], anticlockwise, a multiple of "
        "90; it is then flipped onto the first one.",
    ),
]
_Points = Annotated[
    int,
    typer.Option(metavar="N", help="Most points of a side; larger maps are averaged."),
]
_Columns = Annotated[
    str | None,
    typer.Option(
        metavar="ROLE:UNIT,...",
        help="Columns of a plain table of heights, for example 'x:um,y:um,z:um'; "
        "'x:um,z:um' would be a profile.",
    ),
]
_Plot = Annotated[
    Path | None,
    typer.Option(metavar="PATH", help="HTML report with pictures of the pressures."),
]
_Json = Annotated[
    str | None,
    typer.Option(
        metavar="PATH", help="Write the results as JSON; '-' for standard output."
    ),
]
_Debug = Annotated[
    bool, typer.Option("--debug", help="Show the traceback of an error.")
]


@dataclass(frozen=True, slots=True, kw_only=True)
class PressureMapOptions:
    """The options of the command line by name, as typed, in the order of the help."""

    maps: _Maps
    modulus: _Modulus
    hardness: _Hardness
    pressure: _Pressure
    cutoff: _Cutoff = "0.8 mm"
    turn: _Turn = 0
    points: _Points = 512
    columns: _Columns = None
    plot: _Plot = None
    json: _Json = None
    debug: _Debug = False
