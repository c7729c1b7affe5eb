# SPDX-License-Identifier: MIT
"""The commands of offline work: their names and options; the work is done elsewhere."""

import os
from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.output_options import Debug, Json
from jointbench.station.screen.exit_codes import EXIT_QUALITY

_RecipeFile = Annotated[
    Path | None,
    typer.Option("--recipe", help="Recipe (TOML); chosen by the data when left out."),
]
_Stages = Annotated[
    Path | None,
    typer.Option(help="Folder of kept stages; .jointbench-stages beside the results."),
]
_Again = Annotated[bool, typer.Option("--again", help="Work again, whatever is there.")]


_Sessions = Annotated[list[str], typer.Argument(help="Files, folders or patterns.")]
_Jobs = Annotated[
    int | None, typer.Option(help="Worker processes; one a core.", min=1, max=256)
]
_ResultsFolder = Annotated[
    Path | None, typer.Option(help="Folder of results; else beside the sessions.")
]
_LedgerFile = Annotated[
    Path | None, typer.Option(help="Ledger; RECIPE.ledger.jsonl by default.")
]
_StagesLimit = Annotated[
    float, typer.Option(help="Space for kept stages [GB]; 0 keeps none.", min=0)
]
_Retries = Annotated[
    int, typer.Option(help="Tries after a system's fault.", min=0, max=100)
]
_TimeLimit = Annotated[float, typer.Option(help="Longest time for a file [s].", min=1)]
_Scheduler = Annotated[
    str | None,
    typer.Option(help="Dask scheduler in place of --jobs: tcp://127.0.0.1:8786."),
]
_Batch = Annotated[
    int, typer.Option(help="Files a task of the scheduler.", min=1, max=1000)
]
_Authority = Annotated[Path | None, typer.Option(help="Authority, PEM.")]
_Certificate = Annotated[Path | None, typer.Option(help="Our certificate, PEM.")]
_PrivateKey = Annotated[Path | None, typer.Option(help="Our key, PEM.")]


def mount(app: typer.Typer) -> None:
    """Add the commands of offline work to the command line."""
    app.command(name="process")(_process_command)
    app.command(name="reprocess")(_reprocess_command)
    app.command(name="archive")(_archive_command)
    app.command(name="compare")(_compare_command)
    app.command(name="export")(_export_command)


def _process_command(
    session: Annotated[Path, typer.Argument(help="Session file; it is only read.")],
    recipe: _RecipeFile = None,
    out: Annotated[
        Path | None, typer.Option(help="Results file; beside the session by default.")
    ] = None,
    stages: _Stages = None,
    again: _Again = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Read a recorded session again under a recipe: hits, FRFs, modes, surfaces, joint.

    Example: jointbench process session.h5 --recipe narrow.toml
    """
    from jointbench.station.commands.process_command import run_process

    run_process(
        session, recipe=recipe, out=out, stages=stages, again=again, json_target=json
    )


def _reprocess_command(
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
    """Read an archive again under a recipe; resumable: the same command goes on.

    Example: jointbench reprocess 'archive/**/*.h5' --recipe narrow.toml --jobs 2
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


def _archive_command(
    results: Annotated[
        list[str], typer.Argument(help="Results files, folders or quoted patterns.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="Table to write: .csv, .mat, .nc or .parquet.")
    ] = None,
    trend: Annotated[
        str,
        typer.Option(
            metavar="torque|preload|day|specimen", help="What trends go over."
        ),
    ] = "torque",
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Collect all results of an archive into one table, and show trends.

    Example: jointbench archive 'archive/**/*.narrow.results.h5' --out all.nc
    """
    from jointbench.station.commands.archive_command import run_archive

    left_out = run_archive(results, out=out, trend=trend, json_target=json)
    return EXIT_QUALITY if left_out else 0


def _compare_command(
    before: Annotated[str, typer.Argument(help="Results file, folder or pattern.")],
    after: Annotated[str, typer.Argument(help="Likewise, of the same sessions.")],
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Lay two recipes or versions side by side: what moved beyond its uncertainty.

    Example: jointbench compare 'a/**/*.old.results.h5' 'a/**/*.new.results.h5'
    """
    from jointbench.station.commands.compare_command import run_compare

    _, left_out = run_compare(before, after, json_target=json)
    return EXIT_QUALITY if left_out else 0


def _export_command(
    file: Annotated[
        Path, typer.Argument(help="Session, results, or universal file of others.")
    ],
    to: Annotated[str, typer.Option(metavar="csv|mat|uff", help="Format.")] = "csv",
    out: Annotated[
        Path | None, typer.Option(help="Folder to write to; beside the file.")
    ] = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Write samples, FRFs, modes and quantities for other programs, units included.

    Example: jointbench export session.results.h5 --to mat
    """
    from jointbench.station.commands.export_command import run_export

    run_export(file, kind=to, folder=out, json_target=json)
