# SPDX-License-Identifier: MIT
"""Commands on whole archives of recorded data: their names and options."""

import os
from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.output_options import Debug, Json
from jointbench.station.screen.exit_codes import EXIT_QUALITY

_RecipeFile = Annotated[
    Path | None,
    typer.Option(
        "--recipe", metavar="PATH", help="Recipe (TOML); default settings without one."
    ),
]
_Stages = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER",
        help="Folder of intermediate results; .jointbench-stages next to the results "
        "by default.",
    ),
]
_Again = Annotated[
    bool,
    typer.Option("--again", help="Compute everything again and use no stored stage."),
]
_Sessions = Annotated[
    list[str],
    typer.Argument(metavar="SESSION", help="Session files, folders, quoted patterns."),
]
_Jobs = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        help="Number of worker processes; one per core by default.",
        min=1,
        max=256,
    ),
]
_ResultsFolder = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER", help="Folder of results; next to each session by default."
    ),
]
_LedgerFile = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="Ledger of finished files; RECIPE.ledger.jsonl by default.",
    ),
]
_StagesLimit = Annotated[
    float,
    typer.Option(
        metavar="NUMBER",
        help="Largest size of the stored stages [GB]; 0 stores none.",
        min=0,
    ),
]
_Retries = Annotated[
    int,
    typer.Option(
        metavar="N", help="Retries after a fault of the system.", min=0, max=100
    ),
]
_TimeLimit = Annotated[
    float,
    typer.Option(metavar="NUMBER", help="Longest time for one file [s].", min=1),
]
_CLUSTER = "Cluster options"
_Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="URL",
        help="Dask scheduler in place of --jobs, for example tcp://127.0.0.1:8786.",
        rich_help_panel=_CLUSTER,
    ),
]
_Batch = Annotated[
    int,
    typer.Option(
        metavar="N",
        help="Files per task of the scheduler.",
        min=1,
        max=1000,
        rich_help_panel=_CLUSTER,
    ),
]
_Authority = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="TLS certificate authority (PEM).",
        rich_help_panel=_CLUSTER,
    ),
]
_Certificate = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="TLS certificate of this client (PEM).",
        rich_help_panel=_CLUSTER,
    ),
]
_PrivateKey = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="TLS private key of this client (PEM).",
        rich_help_panel=_CLUSTER,
    ),
]


def process_command(
    session: Annotated[
        Path,
        typer.Argument(metavar="SESSION", help="Session file (.h5); only read."),
    ],
    recipe: _RecipeFile = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="Results file to write (.h5); next to the session by default.",
        ),
    ] = None,
    stages: _Stages = None,
    again: _Again = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Process a session with a recipe: from hits to joint.

    A recipe sets hit limits, windows, estimator, modal extraction, surfaces and
    contact model. Stages with unchanged settings are taken from the store.

    Examples:
        jointbench process session.h5 --recipe narrow.toml
    """
    from jointbench.station.commands.process_command import run_process

    run_process(
        session, recipe=recipe, out=out, stages=stages, again=again, json_target=json
    )


def reprocess_command(
    sessions: _Sessions,
    recipe: _RecipeFile = None,
    jobs: _Jobs = None,
    results: _ResultsFolder = None,
    ledger: _LedgerFile = None,
    stages: _Stages = None,
    stages_limit: _StagesLimit = 10.0,
    retries: _Retries = 2,
    time_limit: _TimeLimit = 1800.0,
    scheduler: _Scheduler = None,
    batch: _Batch = 16,
    tls_ca: _Authority = None,
    tls_cert: _Certificate = None,
    tls_key: _PrivateKey = None,
    again: _Again = False,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Process an archive of sessions with a recipe, in parallel.

    A run can be stopped at any time. The same command resumes it.

    Examples:
        jointbench reprocess 'archive/**/*.h5' --recipe archive/narrow.toml --jobs 2
        jointbench reprocess archive/ --scheduler tcp://127.0.0.1:8786
    """
    from jointbench.station.archive.cluster import ClusterSettings
    from jointbench.station.archive.reprocess import (
        cluster_backend,
        default_places,
        pool_backend,
        run_reprocess,
    )
    from jointbench.station.archive.worker_pool import PoolSettings

    workers = jobs or os.cpu_count() or 1
    backend = pool_backend(PoolSettings(workers, retries, time_limit=time_limit))
    if scheduler is not None:
        tls = {"authority": tls_ca, "certificate": tls_cert, "private_key": tls_key}
        backend = cluster_backend(ClusterSettings(scheduler, batch, retries, **tls))
    summary = run_reprocess(
        sessions,
        recipe=recipe,
        places=default_places(
            results,
            ledger,
            stages,
            keep_stages=stages_limit > 0,
            stages_bytes=round(stages_limit * 1e9),
        ),
        backend=backend,
        again=again,
        json_target=json,
    )
    return EXIT_QUALITY if summary.failed else 0


def archive_command(
    results: Annotated[
        list[str],
        typer.Argument(
            metavar="RESULTS", help="Results files, folders, quoted patterns."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH", help="Table to write: .csv, .mat, .nc or .parquet."
        ),
    ] = None,
    trend: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Independent variable of the trends: torque, preload, day or "
            "specimen.",
        ),
    ] = "torque",
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Collect results of many sessions in one table, with trends.

    Examples:
        jointbench archive 'archive/**/*.narrow.results.h5' --out all.nc
        jointbench archive archive/ --trend day
    """
    from jointbench.station.commands.archive_command import run_archive

    left_out = run_archive(results, out=out, trend=trend, json_target=json)
    return EXIT_QUALITY if left_out else 0


def compare_command(
    before: Annotated[
        str,
        typer.Argument(metavar="BEFORE", help="Results file, folder or pattern."),
    ],
    after: Annotated[
        str,
        typer.Argument(metavar="AFTER", help="Other results of the same sessions."),
    ],
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Compare results of two recipes or software versions.

    The table lists each quantity whose change exceeds its uncertainty.

    Examples:
        jointbench compare 'archive/**/*.wide.results.h5'
        'archive/**/*.narrow.results.h5'
    """
    from jointbench.station.commands.compare_command import run_compare

    _, left_out = run_compare(before, after, json_target=json)
    return EXIT_QUALITY if left_out else 0
