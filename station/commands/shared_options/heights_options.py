# SPDX-License-Identifier: MIT
"""Options of the fit of surfaces: form, outliers, directions, profiles as one."""

from typing import Annotated

import typer

Form = Annotated[
    int | None,
    typer.Option(metavar="N", help="Remove a polynomial form of degree N (1 to 8)."),
]
Outliers = Annotated[
    float | None,
    typer.Option(
        metavar="LIMIT",
        help="Mask points this far off their neighbours, in robust standard "
        "deviations; 6 is usual.",
    ),
]
Direction = Annotated[
    float | None,
    typer.Option(
        metavar="DEG",
        help="Maps: fit the lines in this direction, from the rows (0) towards the "
        "columns (90).",
    ),
]
Directions = Annotated[
    bool,
    typer.Option("--directions", help="Maps: compare directions, is there a lay?"),
]
Pool = Annotated[
    bool,
    typer.Option("--pool", help="Profiles of one surface: all of them as one, too."),
]
WaveRatio = Annotated[
    float | None,
    typer.Option(
        "--weierstrass",
        metavar="GAMMA",
        help="Profiles: fit a Weierstrass-Mandelbrot profile of this frequency ratio, "
        "too; 1.5 in the papers.",
    ),
]
