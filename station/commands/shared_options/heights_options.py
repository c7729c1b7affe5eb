# SPDX-License-Identifier: MIT
"""Options of the fit of surfaces: form, outliers, filter, directions, pooling."""

from pathlib import Path
from typing import Annotated

import typer

Form = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        help="Remove a polynomial form of degree N, 1 to 8, before the fit.",
    ),
]
Outliers = Annotated[
    float | None,
    typer.Option(
        metavar="LIMIT",
        help="Mask points that deviate from their neighbours by more than LIMIT "
        "robust standard deviations [-], for example 6.",
    ),
]
Filter = Annotated[
    str | None,
    typer.Option(
        "--filter",
        metavar="LOW:HIGH",
        help="Gaussian filter before the fit: cut-offs lambda_s and lambda_c [m or "
        "with a unit], for example '2.5 um:0.8 mm', '2.5 um:' or ':0.8 mm'.",
    ),
]
Direction = Annotated[
    float | None,
    typer.Option(
        metavar="ANGLE",
        help="Maps: fit the lines in this direction [deg], from the rows (0) to the "
        "columns (90), for example 45.",
    ),
]
Directions = Annotated[
    bool,
    typer.Option("--directions", help="Maps: compare all directions and report a lay."),
]
Pool = Annotated[
    bool,
    typer.Option("--pool", help="Profiles of one surface: fit them together as well."),
]
StructureMapFile = Annotated[
    Path | None,
    typer.Option(
        "--structure-map",
        metavar="PATH",
        help="CSV file to write: the structure function of one surface at all lags up "
        "to a tenth of its sides.",
    ),
]
WaveRatio = Annotated[
    float | None,
    typer.Option(
        "--weierstrass",
        metavar="GAMMA",
        help="Profiles: fit a Weierstrass-Mandelbrot profile of this frequency ratio "
        "[-] as well, for example 1.5.",
    ),
]
