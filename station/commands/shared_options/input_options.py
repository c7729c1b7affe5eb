# SPDX-License-Identifier: MIT
"""Arguments and options that name the input and describe it."""

from pathlib import Path
from typing import Annotated

import typer

_COLUMNS_HELP = (
    "Quantity and unit of each column of a plain table, for example "
    "'time:s,force:N,acceleration:m/s^2' or 'x:um,z:um'."
)
Files = Annotated[
    list[Path],
    typer.Argument(metavar="FILE", help="Files to read.", show_default=False),
]
HitFiles = Annotated[
    list[Path],
    typer.Argument(
        metavar="FILE",
        help="Session (.h5), files of hits (.csv, .npy, .mat, .uff, .tdms, .wav), or "
        "files of FRFs (.uff, .txt, .csv, .mat, .npz, .npy).",
        show_default=False,
    ),
]
SurfaceFiles = Annotated[
    list[Path],
    typer.Argument(
        metavar="FILE",
        help="Session (.h5), table of heights, or file of a surface instrument.",
        show_default=False,
    ),
]
Columns = Annotated[
    str | None, typer.Option("--columns", metavar="ROLE:UNIT,...", help=_COLUMNS_HELP)
]
Averages = Annotated[
    int | None,
    typer.Option(
        min=2,
        metavar="N",
        help="Number of averages of FRFs, where their file gives none, for example 10.",
    ),
]
Point = Annotated[
    str,
    typer.Option(metavar="NAME", help="Hit point, for files that do not name one."),
]
Preload = Annotated[
    str | None,
    typer.Option(
        metavar="QUANTITY",
        help="Preload on the joint, where the file gives none, for example '4 kN'.",
    ),
]
Sessions = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="SESSION", help="Sessions (.h5), files of hits or files of FRFs."
    ),
]
Rate = Annotated[
    str | None,
    typer.Option(
        metavar="QUANTITY",
        help="Sample rate of files without times, for example '25.6 kHz'.",
    ),
]
Guess = Annotated[
    bool,
    typer.Option(
        "--guess", help="Propose columns, units and rate, and show the first hit."
    ),
]
Yes = Annotated[bool, typer.Option("--yes", help="With --guess: write without asking.")]
Picture = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH", help="With --guess: HTML file with a plot of the first hit."
    ),
]
FullScale = Annotated[
    float | None,
    typer.Option(
        metavar="NUMBER",
        help="WAV: full scale [unit of --columns], for example 500.",
    ),
]
