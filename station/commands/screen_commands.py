# SPDX-License-Identifier: MIT
"""Commands with a screen in the browser: their names and options."""

import os
from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.input_options import (
    Averages,
    Columns,
    HitFiles,
    Point,
    Rate,
)
from jointbench.station.commands.shared_options.mode_fit_options import (
    Band,
    Drop,
    EstimatorName,
    GeometryFile,
    Keep,
    Order,
)
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


def desk_command(
    files: HitFiles,
    columns: Columns = None,
    point: Point = "1",
    rate: Rate = None,
    band: Band = None,
    order: Order = None,
    estimator: EstimatorName = "H1",
    keep: Keep = None,
    drop: Drop = None,
    averages: Averages = None,
    geometry: GeometryFile = None,
    who: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Who chooses, stored with each choice; by default the user of this "
            "computer.",
        ),
    ] = None,
    port: ScreenPort = 0,
    no_browser: NoBrowser = False,
    debug: Debug = False,
) -> None:
    """Choose poles in the browser, with live refits and shapes.

    Click a pole to choose it, draw a box to clear, pin or merge; the fit follows at
    once. Each choice is written to the results beside the session, with who and when;
    'report', 'export' and 'identify' use them. Reads what 'modal' reads. Install with
    pip install 'jointbench[screen]'.

    Examples:
        jointbench desk session.h5
        jointbench desk session.h5 --geometry plates.toml --who 'A. Person'
        jointbench desk frf.txt --columns 'frequency:Hz,real:m/N,imaginary:m/N'
    """
    from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
    from jointbench.acquisition.formats.samples.sample_format import SampleOptions
    from jointbench.station.browser.desk.run_desk import DeskScreen, run_desk
    from jointbench.station.desk.desk_subject import DeskRequest
    from jointbench.station.files.typed_values import parse_rate
    from jointbench.station.pipeline.modal_options import modal_settings

    request = DeskRequest(
        modal_settings(band, order, estimator, keep or (), drop or ()),
        FrfOptions(columns, point, averages or 0),
        SampleOptions(columns, point, rate=parse_rate(rate)),
        geometry,
    )
    run_desk(files, request, DeskScreen(port, not no_browser, who))
