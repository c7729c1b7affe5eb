# SPDX-License-Identifier: MIT
"""Commands with a screen in the browser: their names and options."""

import os
from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.output_options import (
    Debug,
    Force,
    Json,
    SessionOut,
)
from jointbench.station.screen.exit_codes import EXIT_QUALITY

ScreenPort = Annotated[
    int,
    typer.Option(
        "--port",
        metavar="N",
        help="TCP port on this computer, for example 8765; any free port by default.",
    ),
]
NoBrowser = Annotated[
    bool,
    typer.Option("--no-browser", help="Show the link only; open no browser."),
]


def bench_command(
    plan: Annotated[
        Path, typer.Argument(metavar="PLAN", help="Measurement plan (TOML).")
    ],
    out: SessionOut,
    source: Annotated[
        str | None,
        typer.Option(
            metavar="URL",
            help="Instrument: 'ni:', 'ni+grpc://HOST:PORT' or 'sim:plates'; from the "
            "plan by default.",
        ),
    ] = None,
    geometry: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="Positions of the points, to be drawn (TOML, .uff or .unv).",
        ),
    ] = None,
    port: ScreenPort = 0,
    no_browser: NoBrowser = False,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Measure hammer hits with a screen in the browser.

    The command measures as 'measure' does, and shows signals, verdicts and FRFs in a
    browser on this computer. Keys work in the browser and in the terminal. If browser
    or screen fail, the session continues. Install with
    pip install 'jointbench[screen]'.

    Examples:
        jointbench bench plan.toml --out session.h5 --source ni:
        jointbench bench examples/plates.toml --out plates.h5 --source
        'sim:plates?seed=1&speed=1'
    """
    # gRPC reports lost connections on standard error; the session reports them itself.
    os.environ.setdefault("GRPC_VERBOSITY", "NONE")
    from jointbench.station.browser.bench.run_bench import ScreenOptions, run_bench

    measured = run_bench(
        plan,
        out,
        source=source,
        overwrite=force,
        json_target=json,
        screen=ScreenOptions(port, not no_browser, geometry),
    )
    return 0 if measured.whole else EXIT_QUALITY
