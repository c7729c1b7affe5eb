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
    HitFiles,
    Point,
    Preload,
    SurfaceFiles,
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
    preload: Preload = None,
    full_scale: FullScale = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Import hits and surfaces from foreign files into a session.

    Plain tables (.csv, .txt, .npy) need --columns. A file without units is refused.

    Examples:
        jointbench import hit1.csv hit2.csv hit3.csv --out session.h5 --columns
        'time:s,force:N,acceleration:m/s^2'
        jointbench import trace.txt --out session.h5 --columns 'x:um,z:um'
        --preload '4 kN'
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


def modal_command(
    files: HitFiles,
    columns: Columns = None,
    point: Point = "1",
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
    if output_only:
        from jointbench.station.commands.output_only_command import run_output_only
        from jointbench.station.pipeline.modal_options import parse_band

        run_output_only(
            files,
            columns=columns,
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
    from jointbench.station.commands.modal_command import run_frfs, run_modal
    from jointbench.station.pipeline.modal_options import modal_settings

    settings = modal_settings(band, order, estimator, keep or (), drop or ())
    options = FrfOptions(columns, point, averages or 0)
    if run_frfs(files, options, settings, (out, uff, json)):
        return
    run_modal(
        files,
        settings,
        columns=columns,
        point=point,
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
