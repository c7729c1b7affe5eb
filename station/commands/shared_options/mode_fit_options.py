# SPDX-License-Identifier: MIT
"""Options of modal extraction: band, order, estimator, manual selection."""

from pathlib import Path
from typing import Annotated

import typer

Band = Annotated[
    str | None,
    typer.Option(
        metavar="LOW:HIGH", help="Frequency band to fit [Hz], for example 50:5000."
    ),
]
Order = Annotated[
    int | None,
    typer.Option(
        metavar="N", help="Highest model order; chosen from the data by default."
    ),
]
OutputOnly = Annotated[
    bool,
    typer.Option(
        "--output-only", help="Operational modal analysis: no force channel is used."
    ),
]
KeepSines = Annotated[
    bool,
    typer.Option(
        "--keep-sines",
        help="With --output-only: leave steady sines, such as those of a spindle, in "
        "the record.",
    ),
]
Keep = Annotated[
    list[float] | None,
    typer.Option(
        metavar="FREQUENCY",
        help="Keep the pole nearest this frequency [Hz] as a mode, for example 5031.",
    ),
]
Drop = Annotated[
    list[float] | None,
    typer.Option(
        metavar="FREQUENCY",
        help="Drop the mode nearest this frequency [Hz], for example 3007.",
    ),
]
EstimatorName = Annotated[
    str,
    typer.Option(
        "--estimator",
        metavar="H1|H2|Hv",
        help="FRF estimator: H1 is biased low by noise in the force, H2 is biased "
        "high by noise in the response, Hv lies between.",
    ),
]
GeometryFile = Annotated[
    Path | None,
    typer.Option(
        "--geometry",
        metavar="PATH",
        help="Points and lines (TOML or universal file) to draw mode shapes on.",
    ),
]
