# SPDX-License-Identifier: MIT
"""``jointbench pressure``: a joint by the pressure of its bolts and weight."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.output_options import Debug, Json


def pressure_command(
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL",
            help="Model (TOML): meshed bodies with [joints], [pressure].",
        ),
    ],
    report: Annotated[
        Path | None,
        typer.Option(metavar="PATH", help="Report with the pressure map (.html)."),
    ] = None,
    points: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="Pressure, stiffness and damping at each point (.csv): a model takes "
            "it as a joint's pattern.",
        ),
    ] = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Compute the pressure over a joint and its stiffness.

    Bolts and weight press two meshed bodies together, and the surface opens where
    nothing presses it. A contact law at the local pressure gives stiffness and damping,
    beside those of an even pressure.

    Examples:
        jointbench pressure pressed-plates.toml --report pressure.html
        jointbench pressure pressed-plates.toml --points points.csv
    """
    from jointbench.station.pressure.run_pressure import run_pressure

    run_pressure(model, report=report, points=points, json_target=json)
