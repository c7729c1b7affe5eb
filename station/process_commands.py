# SPDX-License-Identifier: MIT
"""The commands of offline work: their names and options; the work is done elsewhere."""

import os
from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.exit_codes import EXIT_QUALITY
from jointbench.station.options import Debug, Json

RecipeFile = Annotated[
    Path | None,
    typer.Option("--recipe", help="Recipe (TOML); chosen by the data when left out."),
]
Stages = Annotated[
    Path | None,
    typer.Option(help="Folder of kept stages; .jointbench-stages beside the results."),
]
Again = Annotated[bool, typer.Option("--again", help="Work again, whatever is there.")]


def process_command(
    session: Annotated[Path, typer.Argument(help="Session file; it is only read.")],
    recipe: RecipeFile = None,
    out: Annotated[
        Path | None, typer.Option(help="Results file; beside the session by default.")
    ] = None,
    stages: Stages = None,
    again: Again = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Read a recorded session again under a recipe: hits, FRFs, modes, surfaces, joint.

    Example: jointbench process session.h5 --recipe narrow.toml
    """
    from jointbench.station.process import run_process

    run_process(
        session, recipe=recipe, out=out, stages=stages, again=again, json_target=json
    )


def reprocess_command(
    sessions: Annotated[
        list[str], typer.Argument(help="Files, folders or quoted patterns.")
    ],
    recipe: RecipeFile = None,
    jobs: Annotated[
        int | None, typer.Option(help="Worker processes; one a core.", min=1, max=256)
    ] = None,
    results: Annotated[
        Path | None, typer.Option(help="Folder of results; else beside the sessions.")
    ] = None,
    ledger: Annotated[
        Path | None, typer.Option(help="Ledger; RECIPE.ledger.jsonl by default.")
    ] = None,
    stages: Stages = None,
    stages_limit: Annotated[
        float, typer.Option(help="Space for kept stages [GB]; 0 keeps none.", min=0)
    ] = 10.0,
    retries: Annotated[
        int, typer.Option(help="Tries after a system's fault.", min=0, max=100)
    ] = 2,
    time_limit: Annotated[
        float, typer.Option(help="Longest time for a file [s].", min=1)
    ] = 1800.0,
    scheduler: Annotated[
        str | None,
        typer.Option(help="Dask scheduler in place of --jobs: tcp://127.0.0.1:8786."),
    ] = None,
    batch: Annotated[
        int, typer.Option(help="Files a task of the scheduler.", min=1, max=1000)
    ] = 16,
    tls_ca: Annotated[Path | None, typer.Option(help="Authority, PEM.")] = None,
    tls_cert: Annotated[Path | None, typer.Option(help="Our certificate, PEM.")] = None,
    tls_key: Annotated[Path | None, typer.Option(help="Our key, PEM.")] = None,
    again: Again = False,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Read an archive again under a recipe; resumable: the same command goes on.

    Example: jointbench reprocess 'archive/**/*.h5' --recipe narrow.toml --jobs 2
    """
    from jointbench.station.cluster import ClusterSettings
    from jointbench.station.reprocess import (
        cluster_backend,
        default_places,
        pool_backend,
        run_reprocess,
    )
    from jointbench.station.worker_pool import PoolSettings

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
        list[str], typer.Argument(help="Results files, folders or quoted patterns.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="Table to write: .csv, .nc or .parquet.")
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
    from jointbench.station.archive_table import run_archive

    left_out = run_archive(results, out=out, trend=trend, json_target=json)
    return EXIT_QUALITY if left_out else 0


def compare_command(
    before: Annotated[str, typer.Argument(help="Results file, folder or pattern.")],
    after: Annotated[str, typer.Argument(help="Likewise, of the same sessions.")],
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Lay two recipes or versions side by side: what moved beyond its uncertainty.

    Example: jointbench compare 'a/**/*.old.results.h5' 'a/**/*.new.results.h5'
    """
    from jointbench.station.compare_results import run_compare

    run_compare(before, after, json_target=json)


def export_command(
    file: Annotated[Path, typer.Argument(help="Session or results file.")],
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
    from jointbench.station.export_files import run_export

    run_export(file, kind=to, folder=out, json_target=json)
