# SPDX-License-Identifier: MIT
"""Arguments and options that several commands share, and the words of the long ones."""

from pathlib import Path
from typing import Annotated

import typer

_COLUMNS_HELP = (
    "Roles and units of a plain table's columns, for example "
    "'time:s,force:N,acceleration:m/s^2' or 'x:um,z:um'."
)
GAP_HELP = "Sessions or campaign (.h5), record (.mat), model with data (.toml), URL."
Files = Annotated[list[Path], typer.Argument(help="Files to read.", show_default=False)]
Columns = Annotated[str | None, typer.Option("--columns", help=_COLUMNS_HELP)]
Json = Annotated[
    str | None,
    typer.Option("--json", metavar="PATH", help="Write results as JSON; '-' = stdout."),
]
Model = Annotated[Path | None, typer.Option(help="Bench model (TOML), with priors.")]
Point = Annotated[str, typer.Option(help="Where the hammer struck.")]
Preload = Annotated[
    str | None, typer.Option(help="On the joint, '4 kN', where no session says.")
]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]
Force = Annotated[bool, typer.Option("--force", help="Overwrite existing output.")]
Band = Annotated[
    str | None, typer.Option(help="Band to fit, for example '50:5000' [Hz].")
]
Order = Annotated[
    int | None, typer.Option(help="Highest model order; chosen when left out.")
]
Results = Annotated[
    Path | None, typer.Option(help="Results file; beside a session by default.")
]
OutputOnly = Annotated[
    bool,
    typer.Option("--output-only", help="No force channel: from responses alone."),
]
Keep = Annotated[
    list[float] | None,
    typer.Option(help="Frequency [Hz] that is a mode, whatever is chosen; repeatable."),
]
Drop = Annotated[
    list[float] | None,
    typer.Option(help="Frequency [Hz] that is none, whatever is chosen; repeatable."),
]
EstimatorName = Annotated[
    str,
    typer.Option(
        "--estimator",
        metavar="H1|H2|Hv",
        help="H1 reads low where the force is noisy, H2 high where the response is.",
    ),
]
Universal = Annotated[
    Path | None,
    typer.Option(help="Universal file for FRFs (58) and mode shapes (55)."),
]
GeometryFile = Annotated[
    Path | None,
    typer.Option("--geometry", help="Points and lines to draw shapes on (TOML)."),
]
Page = Annotated[Path | None, typer.Option(help="HTML page to write.")]
Cache = Annotated[Path | None, typer.Option(help="Folder of reduced structures.")]
Sessions = Annotated[list[Path] | None, typer.Argument(help="Session files.")]
FullScale = Annotated[
    float | None,
    typer.Option(help="WAV: what its largest number stands for, in the columns' unit."),
]
Faces = Annotated[
    list[Path] | None,
    typer.Option("--surface", help="Face of the joint, for [contact]; once or twice."),
]
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
