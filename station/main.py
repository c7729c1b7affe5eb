# SPDX-License-Identifier: MIT
"""The command line: names, options and exit codes; the work is done elsewhere.

Every command imports what it needs when it runs, so that ``--help`` stays instant.
"""

import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from typer.exceptions import TyperException

from jointbench.acquisition.errors import InstrumentError, JointbenchError, UsageError
from jointbench.station.contact_command import contact_command

EXIT_INTERNAL = 1
EXIT_USAGE = 2
EXIT_BAD_DATA = 3
EXIT_INSTRUMENT = 4
EXIT_QUALITY = 5
EXIT_INTERRUPTED = 130
COLUMNS_HELP = (
    "Roles and units of a plain table's columns, for example "
    "'time:s,force:N,acceleration:m/s^2' or 'x:um,z:um'."
)
GAP_HELP = "Sessions or campaign (.h5), record (.mat), model with data (.toml), URL."
Files = Annotated[list[Path], typer.Argument(help="Files to read.", show_default=False)]
Columns = Annotated[str | None, typer.Option("--columns", help=COLUMNS_HELP)]
Json = Annotated[
    str | None,
    typer.Option("--json", metavar="PATH", help="Write results as JSON; '-' = stdout."),
]
Model = Annotated[Path | None, typer.Option(help="Bench model (TOML), with priors.")]
Point = Annotated[str, typer.Option(help="Where the hammer struck.")]
Preload = Annotated[str | None, typer.Option(help="'4 kN', where no session says.")]
Page = Annotated[Path | None, typer.Option(help="HTML page to write.")]
Cache = Annotated[Path | None, typer.Option(help="Folder of reduced structures.")]
Sessions = Annotated[list[Path] | None, typer.Argument(help="Session files.")]
Band = Annotated[str | None, typer.Option(help="Band of modes, '50:900' [Hz].")]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]
Force = Annotated[bool, typer.Option("--force", help="Overwrite existing output.")]

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
    sys.exit(exit_code(app, debug="--debug" in sys.argv[1:]))


def exit_code(command: Callable[..., object], *, debug: bool) -> int:
    """Call `command` and turn what it raises into the contract's exit code."""
    if debug:
        result = command(standalone_mode=False)
        return result if isinstance(result, int) else 0
    with warnings.catch_warnings():
        # What a warning of a library means to the user is said by our own checks.
        warnings.simplefilter("ignore")
        return _quiet_exit_code(command)


def _quiet_exit_code(command: Callable[..., object]) -> int:
    try:
        result = command(standalone_mode=False)
    except TyperException as error:
        return _fail(error.format_message(), EXIT_USAGE)
    except JointbenchError as error:
        return _fail(str(error), code_of(error))
    except (KeyboardInterrupt, typer.Abort):
        return _fail("interrupted; finished files are whole", EXIT_INTERRUPTED)
    except OSError as error:
        return _fail(f"{error.strerror or error}: {error.filename}", EXIT_BAD_DATA)
    except Exception as error:  # noqa: BLE001 - a traceback helps no operator
        kind = type(error).__name__
        return _fail(
            f"internal error ({kind}: {error}); run again with --debug and report it",
            EXIT_INTERNAL,
        )
    return result if isinstance(result, int) else 0


def code_of(error: JointbenchError) -> int:
    """Return the exit code of an error's family."""
    if isinstance(error, UsageError):
        return EXIT_USAGE
    return EXIT_INSTRUMENT if isinstance(error, InstrumentError) else EXIT_BAD_DATA


def _fail(message: str, code: int) -> int:
    line = " ".join(message.split())
    sys.stderr.write(f"jointbench: error: {line}\n")
    return code


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
    from jointbench.station.demo import run_demo

    return run_demo(out, seed=seed, json_target=json)


@app.command(name="record")
def record_command(
    source: Annotated[str, typer.Argument(help="URL of the bench.", metavar="URL")],
    out: Annotated[Path, typer.Option(help="Session file to write.")],
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Record everything a bench delivers into a session file; hits are judged.

    Example: jointbench record 'sim:two-body-campaign?seed=3&hide=jenkins' --out s.h5
    """
    from jointbench.station.record_command import run_record

    run_record(source, out, overwrite=force, json_target=json)


@app.command(name="import")
def import_command(
    files: Files,
    out: Annotated[Path, typer.Option(help="Session file to write.")],
    columns: Columns = None,
    point: Point = "1",
    preload: Preload = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Bring hits and surface heights from foreign files into one session file.

    Example: jointbench import hit1.npy hit2.npy --out session.h5 --columns
    'time:s,force:N,acceleration:m/s^2'
    """
    from jointbench.station.import_files import run_import

    run_import(
        files,
        out,
        columns=columns,
        point=point,
        preload=preload,
        overwrite=force,
        json_target=json,
    )


@app.command(name="modal")
def modal_command(
    files: Files,
    columns: Columns = None,
    point: Point = "1",
    band: Annotated[
        str | None, typer.Option(help="Band to fit, for example '50:5000' [Hz].")
    ] = None,
    order: Annotated[
        int | None, typer.Option(help="Highest model order; chosen when left out.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Results file; beside a session by default.")
    ] = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Estimate the FRFs and the modes of a session or of hit files.

    Example: jointbench modal session.h5 --json modes.json
    """
    from jointbench.station.modal import run_modal

    run_modal(
        files,
        columns=columns,
        point=point,
        band=band,
        order=order,
        out=out,
        json_target=json,
    )


@app.command(name="surface")
def surface_command(
    files: Files, columns: Columns = None, json: Json = None, debug: Debug = False
) -> None:
    """Fit the fractal parameters D and G of measured surfaces.

    Example: jointbench surface face-a.csv face-b.csv --json surfaces.json
    """
    from jointbench.station.surface import run_surface

    run_surface(files, columns=columns, json_target=json)


app.command(name="contact")(contact_command)


@app.command(name="identify")
def identify_command(
    model: Annotated[Path, typer.Argument(help="Bench or structure model, TOML.")],
    sessions: Sessions = None,
    band: Band = None,
    cache: Cache = None,
    report: Page = None,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Identify joints: of a lumped bench [links], or of meshed bodies [joints].

    Example: jointbench identify bench.toml session.h5 --json joint.json
    """
    from jointbench.station.identify import identify_any

    places = {"cache": cache, "report": report}
    fits = identify_any(model, sessions or [], band=band, json_target=json, **places)
    return 0 if fits else EXIT_QUALITY


@app.command(name="gap")
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
    from jointbench.station.gap import run_gap

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


@app.command(name="report")
def report_command(
    session: Annotated[Path, typer.Argument(help="Session file.")],
    out: Annotated[
        Path | None, typer.Option(help="HTML file; beside the session by default.")
    ] = None,
    model: Model = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Write one offline HTML page about a session.

    Example: jointbench report session.h5 --out report.html
    """
    from jointbench.station.report_command import run_report

    run_report(session, out=out, model=model, json_target=json)


@app.command(name="inspect")
def inspect_command(
    file: Annotated[Path, typer.Argument(help="Session or results file.")],
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Say what is in a file: channels, hits and verdicts, surfaces, provenance.

    Example: jointbench inspect session.h5
    """
    from jointbench.station.inspect_file import run_inspect

    run_inspect(file, json_target=json)
