# SPDX-License-Identifier: MIT
"""Options of the fit of modes: band, order, estimator, choices by hand."""

from pathlib import Path
from typing import Annotated

import typer

Band = Annotated[
    str | None, typer.Option(help="Band to fit, for example '50:5000' [Hz].")
]
Order = Annotated[
    int | None, typer.Option(help="Highest model order; chosen when left out.")
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
GeometryFile = Annotated[
    Path | None,
    typer.Option("--geometry", help="Points and lines to draw shapes on (TOML)."),
]
