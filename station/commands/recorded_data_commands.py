# SPDX-License-Identifier: MIT
"""Commands on recorded data, one session at a time: their names and options."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.heights_options import (
    Direction,
    Directions,
    Filter,
    Form,
    Outliers,
    Pool,
    StructureMapFile,
    WaveRatio,
)
from jointbench.station.commands.shared_options.input_options import (
    Averages,
    Columns,
    Files,
    FullScale,
    Guess,
    HitFiles,
    Picture,
    Point,
    Preload,
    Rate,
    SurfaceFiles,
    Yes,
)
from jointbench.station.commands.shared_options.joint_options import Model
from jointbench.station.commands.shared_options.mode_fit_options import (
    Band,
    Drop,
    EstimatorName,
    GeometryFile,
    Keep,
    KeepSines,
    Order,
    OutputOnly,
)
from jointbench.station.commands.shared_options.output_options import (
    Debug,
    Force,
    HtmlReport,
    Json,
    Results,
    SessionOut,
    Universal,
)
from jointbench.station.commands.shared_options.texture_options import (
    Iso,
    Robust,
    ScaleErrors,
    SettingClassName,
)


def import_command(
    files: Files,
    out: SessionOut,
    columns: Columns = None,
    point: Point = "1",
    rate: Rate = None,
    preload: Preload = None,
    full_scale: FullScale = None,
    guess: Guess = False,
    yes: Yes = False,
    picture: Picture = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Import hits and surfaces from foreign files into a session.

    Plain tables (.csv, .txt, .npy) need --columns, samples without times --rate. A
    file without units is refused. --guess proposes columns, units and rate, shows
    the first hit, and writes only with --yes or on confirmation.

    Examples:
        jointbench import hit1.csv hit2.csv hit3.csv --out session.h5 --columns
        'time:s,force:N,acceleration:m/s^2'
        jointbench import hits.csv --out session.h5 --guess --picture hits.html
        jointbench import trace.txt --out session.h5 --columns 'x:um,z:um'
        --preload '4 kN'
    """
    from jointbench.acquisition.formats.samples.sample_format import SampleOptions
    from jointbench.station.commands.import_command import ImportRequest, run_import
    from jointbench.station.files.typed_values import parse_point, parse_rate

    options = SampleOptions(columns, parse_point(point), full_scale, parse_rate(rate))
    if guess:
        from jointbench.station.guess.run_guess import GuessRequest, run_guess

        asked = GuessRequest(yes=yes, picture=picture)
        confirmed = run_guess(files, out, options, asked, json)
        if confirmed is None:
            return
        options = confirmed
    elif yes or picture is not None:
        from jointbench.acquisition.basics.errors import UsageError

        raise UsageError("--yes and --picture belong to --guess; add it")
    request = ImportRequest(options, preload, overwrite=force, json_target=json)
    run_import(files, out, request)


def modal_command(
    files: HitFiles,
    columns: Columns = None,
    point: Point = "1",
    rate: Rate = None,
    band: Band = None,
    order: Order = None,
    estimator: EstimatorName = "H1",
    keep: Keep = None,
    drop: Drop = None,
    out: Results = None,
    uff: Universal = None,
    averages: Averages = None,
    output_only: OutputOnly = False,
    keep_sines: KeepSines = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Estimate modes from a session, hit files or FRF files.

    Natural frequencies [Hz] and damping ratios [%] have standard deviations. Each
    preload has its own modes. FRFs are recognised by their content; --columns names
    their units where the file does not.

    Examples:
        jointbench modal session.h5 --json modes.json
        jointbench modal session.h5 --band 50:5000 --keep 5031 --drop 3007
        jointbench modal frf.txt --columns 'frequency:Hz,real:m/N,imaginary:m/N'
        jointbench modal spindle.h5 --output-only --band 30:500 --keep-sines
    """
    from jointbench.station.files.typed_values import parse_point, parse_rate

    point = parse_point(point)
    if output_only:
        from jointbench.station.commands.output_only_command import run_output_only
        from jointbench.station.pipeline.modal_options import parse_band

        run_output_only(
            files,
            columns=columns,
            rate=parse_rate(rate),
            band=parse_band(band),
            order=order,
            keep_sines=keep_sines,
            json_target=json,
        )
        return
    if keep_sines:
        from jointbench.acquisition.basics.errors import UsageError

        raise UsageError(
            "--keep-sines is for responses without a force; add --output-only, or "
            "leave it out"
        )
    from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
    from jointbench.acquisition.formats.samples.sample_format import SampleOptions
    from jointbench.station.commands.modal_command import run_frfs, run_modal
    from jointbench.station.pipeline.modal_options import modal_settings

    settings = modal_settings(band, order, estimator, keep or (), drop or ())
    options = FrfOptions(columns, point, averages or 0)
    if run_frfs(files, options, settings, (out, uff, json)):
        return
    run_modal(
        files,
        settings,
        samples=SampleOptions(columns, point, rate=parse_rate(rate)),
        out=out,
        universal=uff,
        json_target=json,
    )


def surface_command(
    files: SurfaceFiles,
    columns: Columns = None,
    form: Form = None,
    outliers: Outliers = None,
    waves: Filter = None,
    direction: Direction = None,
    directions: Directions = False,
    pool: Pool = False,
    weierstrass: WaveRatio = None,
    structure_map: StructureMapFile = None,
    report: HtmlReport = None,
    iso: Iso = False,
    setting_class: SettingClassName = None,
    robust: Robust = False,
    scale_errors: ScaleErrors = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Fit the fractal parameters D and G of measured surfaces.

    D [-] and G [m] come from the structure function. A surface without a scaling
    range has no D and G. The band-limited surface has an H, a roll-off and rms height,
    slope and curvature; a map with a lay has both directions.
    With --iso: the roughness parameters of ISO 21920 and ISO 25178 as well.

    Examples:
        jointbench surface face-a.csv face-b.csv --json surfaces.json
        jointbench surface trace.txt --columns 'x:um,z:um' --form 2 --outliers 6
        jointbench surface a.csv b.csv c.csv --filter '2.5 um:0.8 mm' --pool
        jointbench surface map.sur --report map.html
        jointbench surface trace.csv --iso --scale-errors '1 %:0.5 %'
    """
    from jointbench.station.commands.surface_command import run_surface
    from jointbench.station.pipeline.surface_options import (
        surface_options,
        surface_treatment,
    )
    from jointbench.station.roughness.texture_request import requested_texture

    options = surface_options(
        surface_treatment(form, outliers, waves, direction),
        pool=pool,
        directions=directions,
        weierstrass=weierstrass,
        structure_map=structure_map,
        texture=requested_texture(
            (setting_class, waves, scale_errors), iso=iso, form=form, robust=robust
        ),
    )
    run_surface(
        files, columns=columns, json_target=json, options=options, report=report
    )


def report_command(
    session: Annotated[
        Path,
        typer.Argument(
            metavar="SESSION",
            help="Session file (.h5), file of FRFs, or results of FRFs.",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH", help="HTML file to write; next to the session by default."
        ),
    ] = None,
    model: Model = None,
    geometry: GeometryFile = None,
    results: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="Results to show; by default those of 'modal' next to the session.",
        ),
    ] = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Write an HTML report on a session and its results.

    The report is one file that needs no network.

    Examples:
        jointbench report session.h5 --out report.html
        jointbench report session.h5 --model bench.toml --geometry plate.toml
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
