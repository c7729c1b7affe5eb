# SPDX-License-Identifier: MIT
"""The command line: names and options; the work is done elsewhere.

Every command imports what it needs when it runs, so that ``--help`` stays instant.
"""

import sys
from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.bench_commands import (
    calibrate_command,
    measure_command,
    simulate_command,
)
from jointbench.station.commands.contact_command import contact_command
from jointbench.station.commands.identify_command import identify_command
from jointbench.station.commands.process_commands import mount
from jointbench.station.commands.profile_command import profile_command
from jointbench.station.commands.shared_options.heights_options import (
    Direction,
    Directions,
    Form,
    Outliers,
    Pool,
    WaveRatio,
)
from jointbench.station.commands.shared_options.input_options import (
    Columns,
    Files,
    FullScale,
    Point,
    Preload,
)
from jointbench.station.commands.shared_options.joint_options import GAP_HELP, Model
from jointbench.station.commands.shared_options.mode_fit_options import (
    Band,
    Drop,
    EstimatorName,
    GeometryFile,
    Keep,
    Order,
    OutputOnly,
)
from jointbench.station.commands.shared_options.output_options import (
    Debug,
    Force,
    Json,
    Page,
    Results,
    Universal,
)
from jointbench.station.commands.shared_options.registered_names import (
    added_effects,
    command_with_names,
    contact_models,
)
from jointbench.station.screen.exit_codes import EXIT_QUALITY, exit_code, show_traceback

__all__ = ["app", "exit_code", "run"]

app = typer.Typer(
    name="jointbench",
    help="Measure, identify and explain the joints of machines.",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def run() -> None:
    """Run the command line and leave with its exit code."""
    if len(sys.argv) == 1:
        sys.argv.append("--help")
    sys.excepthook = show_traceback
    sys.exit(exit_code(app, debug="--debug" in sys.argv[1:]))


@app.command(name="demo")
def demo_command(
    out: Annotated[Path, typer.Option(help="Folder for all results.")] = Path(
        "demo-out"
    ),
    seed: Annotated[int, typer.Option(help="Seed of the simulated bench.", min=0)] = 1,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Measure and identify a joint on the embedded simulated bench.

    Example: jointbench demo --out demo-out
    """
    from jointbench.station.demo.demo import run_demo

    return run_demo(out, seed=seed, json_target=json)


@app.command(name="record")
def record_command(
    source: Annotated[str, typer.Argument(help="URL of the bench.", metavar="URL")],
    out: Annotated[Path, typer.Option(help="Session file to write.")],
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Record everything a bench delivers into a session file; hits are judged.

    Example: jointbench record 'sim:two-body-campaign?seed=3&hide=jenkins' --out s.h5
    """
    from jointbench.station.commands.record_command import run_record

    written = run_record(source, out, overwrite=force, json_target=json)
    return 0 if written.whole else EXIT_QUALITY


@app.command(name="import")
def import_command(
    files: Files,
    out: Annotated[Path, typer.Option(help="Session file to write.")],
    columns: Columns = None,
    point: Point = "1",
    preload: Preload = None,
    full_scale: FullScale = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Bring hits and surface heights from foreign files into one session file.

    Example: jointbench import hit1.npy hit2.npy --out session.h5 --columns
    'time:s,force:N,acceleration:m/s^2'
    """
    from jointbench.station.commands.import_command import run_import

    run_import(
        files,
        out,
        columns=columns,
        point=point,
        preload=preload,
        full_scale=full_scale,
        overwrite=force,
        json_target=json,
    )


@app.command(name="modal")
def modal_command(
    files: Files,
    columns: Columns = None,
    point: Point = "1",
    band: Band = None,
    order: Order = None,
    estimator: EstimatorName = "H1",
    keep: Keep = None,
    drop: Drop = None,
    out: Results = None,
    uff: Universal = None,
    output_only: OutputOnly = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Estimate the FRFs and the modes of a session or of hit files.

    Example: jointbench modal session.h5 --json modes.json
    """
    if output_only:
        from jointbench.station.commands.output_only_command import run_output_only
        from jointbench.station.pipeline.modal_options import parse_band

        run_output_only(
            files,
            columns=columns,
            band=parse_band(band),
            order=order,
            json_target=json,
        )
        return
    from jointbench.station.commands.modal_command import run_modal
    from jointbench.station.pipeline.modal_options import modal_settings

    run_modal(
        files,
        modal_settings(band, order, estimator, keep or (), drop or ()),
        columns=columns,
        point=point,
        out=out,
        universal=uff,
        json_target=json,
    )


@app.command(name="surface")
def surface_command(
    files: Files,
    columns: Columns = None,
    form: Form = None,
    outliers: Outliers = None,
    direction: Direction = None,
    directions: Directions = False,
    pool: Pool = False,
    weierstrass: WaveRatio = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Fit the fractal parameters D and G of measured surfaces.

    Example: jointbench surface face-a.csv face-b.csv --json surfaces.json
    """
    from jointbench.station.commands.surface_command import run_surface
    from jointbench.station.pipeline.surface_options import surface_options

    options = surface_options(
        (form, outliers, direction),
        pool=pool,
        directions=directions,
        weierstrass=weierstrass,
    )
    run_surface(files, columns=columns, json_target=json, options=options)


app.command(name="measure")(measure_command)
app.command(name="calibrate")(calibrate_command)
app.command(name="profile")(profile_command)
app.command(name="simulate")(simulate_command)
app.command(
    name="contact", cls=command_with_names({"model": ("One of", contact_models)})
)(contact_command)


app.command(name="identify")(identify_command)


@app.command(
    name="gap",
    cls=command_with_names(
        {"without": ("Other packages add", added_effects)},
    ),
)
def gap_command(
    sources: Annotated[list[str], typer.Argument(help=GAP_HELP, metavar="SOURCE")],
    model: Model = None,
    preload: Preload = None,
    without: Annotated[
        str | None,
        typer.Option(metavar="NAME,...", help="Effects to leave out of the catalogue."),
    ] = None,
    effects: Annotated[
        list[Path] | None,
        typer.Option(help="Python file of your own effects, which is run."),
    ] = None,
    report: Page = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Find where model and measurement disagree, and name what is missing.

    Example: jointbench gap session.h5 --model bench.toml --report gap.html, or
    jointbench gap 'sim:two-body-campaign?seed=3&hide=cubic_stiffness'
    """
    from jointbench.station.commands.gap_command import run_gap

    run_gap(
        sources[0],
        more=sources[1:],
        model=model,
        preload=preload,
        without=without,
        effects=effects or [],
        report=report,
        json_target=json,
    )


mount(app)


@app.command(name="report")
def report_command(
    session: Annotated[Path, typer.Argument(help="Session file.")],
    out: Annotated[
        Path | None, typer.Option(help="HTML file; beside the session by default.")
    ] = None,
    model: Model = None,
    geometry: GeometryFile = None,
    results: Annotated[
        Path | None,
        typer.Option(help="Results to show; those of `modal` beside the session."),
    ] = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Write one offline HTML page about a session, with the results that exist.

    Example: jointbench report session.h5 --out report.html
    """
    from jointbench.station.report.session_report import run_report

    run_report(
        session,
        out=out,
        model=model,
        geometry=geometry,
        results=results,
        json_target=json,
    )


@app.command(name="inspect")
def inspect_command(
    file: Annotated[Path, typer.Argument(help="Session or results file.")],
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Say what is in a file: channels, hits and verdicts, surfaces, provenance.

    Example: jointbench inspect session.h5
    """
    from jointbench.station.commands.inspect_command import run_inspect

    run_inspect(file, json_target=json)


@app.command(name="verify")
def verify_command(
    files: Annotated[
        list[str], typer.Argument(help="Sessions, results, folders, quoted patterns.")
    ],
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Read sessions and results through: checksums, continuity, digests of content.

    Example: jointbench verify session.h5, or jointbench verify archive/
    """
    from jointbench.station.commands.verify_archive import verify_all

    return 0 if verify_all(files, json_target=json) else EXIT_QUALITY


@app.command(name="recover")
def recover_command(
    file: Annotated[Path, typer.Argument(help="File of a recording that was cut off.")],
    out: Annotated[
        Path | None, typer.Option(help="Session file; *.recovered.h5 by default.")
    ] = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Save what is left of a recording that was killed; the file itself stays.

    Example: jointbench recover session.h5
    """
    from jointbench.station.commands.verify_command import run_recover

    run_recover(file, out=out, overwrite=force, json_target=json)
