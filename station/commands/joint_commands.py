# SPDX-License-Identifier: MIT
"""Commands on joints and machines: their names and options."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.input_options import (
    Averages,
    Columns,
    Sessions,
)
from jointbench.station.commands.shared_options.joint_options import (
    Cache,
    ContactSurfaces,
)
from jointbench.station.commands.shared_options.mode_fit_options import Band
from jointbench.station.commands.shared_options.output_options import (
    Debug,
    HtmlReport,
    Json,
)
from jointbench.station.screen.exit_codes import EXIT_QUALITY


def identify_command(
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL",
            help="Model (TOML): rigid bodies with [links], or meshed bodies with "
            "[joints].",
        ),
    ],
    sessions: Sessions = None,
    band: Band = None,
    columns: Columns = None,
    averages: Averages = None,
    cache: Cache = None,
    surface: ContactSurfaces = None,
    report: HtmlReport = None,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Identify stiffness and damping of joints from modes.

    Stiffness [N/m] and damping [N s/m] have standard deviations. A parameter that
    the measurement does not determine is reported with the reason. FRFs are fitted
    first; a file of FRFs is one state of the joints.

    Examples:
        jointbench identify bench.toml session.h5 --json joint.json
        jointbench identify bench.toml frf.uff --averages 5
        jointbench identify plates.toml session.h5 --surface face-a.csv
        --surface face-b.csv --report joints.html
    """
    from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
    from jointbench.station.commands.identify.identify_links_command import identify_any

    fits = identify_any(
        model,
        sessions or [],
        band=band,
        cache=cache,
        report=report,
        json_target=json,
        surfaces=surface or [],
        options=FrfOptions(columns, averages=averages or 0),
    )
    return 0 if fits else EXIT_QUALITY


def export_joint_command(
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL", help="Model (TOML): meshed bodies with [joints]."
        ),
    ],
    identified: Annotated[
        Path,
        typer.Argument(
            metavar="JSON", help="Identified joints: 'jointbench identify --json'."
        ),
    ],
    out: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Folder that takes the files.")
    ],
    to: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Programs: table, ansys, abaqus, nastran, calculix; default all.",
        ),
    ] = None,
    joint: Annotated[
        str | None, typer.Option(metavar="NAME", help="Joint; default the only one.")
    ] = None,
    state: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="State, where several were identified."),
    ] = None,
    pieces: Annotated[
        str | None,
        typer.Option(
            metavar="TERM,...",
            help="Numbers of pieces along the two tangents, as 4,3; default one for "
            "each patch.",
        ),
    ] = None,
    law: Annotated[
        str | None,
        typer.Option(
            metavar="PATH",
            help="Law of slip or damping to add, of 'jointbench gap --json'; after a "
            "colon its direction, default tangential_1.",
        ),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Compute the model with CalculiX (ccx).")
    ] = False,
    debug: Debug = False,
) -> int:
    """Write an identified joint for finite element programs.

    For Ansys, Abaqus, Nastran and CalculiX, and as tables: stiffness and damping with
    uncertainties, as springs of six components between pieces of the two bodies, and
    node by node; each file is read back.

    Examples:
        jointbench export-joint plates.toml joint.json --out joint/
        jointbench export-joint plates.toml joint.json --out joint/ --to calculix
        --check
    """
    from jointbench.station.joint_files.export_files import PROGRAMS
    from jointbench.station.joint_files.exported_joint import ExportRequest
    from jointbench.station.joint_files.run_export_joint import (
        parse_pieces,
        parse_programs,
        run_export_joint,
    )

    request = ExportRequest(
        joint,
        state,
        PROGRAMS if to is None else parse_programs(to),
        None if pieces is None else parse_pieces(pieces),
        law,
        check,
    )
    good = run_export_joint(model, identified, out, request)
    return 0 if good else EXIT_QUALITY


def agreement_command(
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL", help="Model (TOML): meshed bodies with [joints]."
        ),
    ],
    identified: Annotated[
        Path,
        typer.Argument(
            metavar="JSON", help="Identified joints: 'jointbench identify --json'."
        ),
    ],
    sessions: Sessions = None,
    band: Band = None,
    cache: Cache = None,
    report: HtmlReport = None,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Compare measured and computed modes and FRFs.

    Modes are paired in place and direction: MAC, CoMAC, FRAC, differences of frequency
    and damping with intervals, and points with a doubtful sign, label or axis. The
    exit code is 5 if there is such a point.

    Examples:
        jointbench agreement plates.toml joint.json session.h5 --report agreement.html
    """
    from jointbench.station.agreement.run_agreement import (
        AgreementOutputs,
        run_agreement,
    )

    outputs = AgreementOutputs(report, json, cache)
    good = run_agreement(model, identified, sessions or [], band=band, outputs=outputs)
    return 0 if good else EXIT_QUALITY


def design_command(
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL",
            help="Model (TOML): meshed bodies with [joints], [design], [reachable].",
        ),
    ],
    values: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="Identified joints ('jointbench identify --json'); default the "
            "expected values in [design].",
        ),
    ] = None,
    state: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="State, where several were identified."),
    ] = None,
    next_: Annotated[
        bool,
        typer.Option(
            "--next",
            help="[sensors] and [hits] are measured: the hit, sensor, torque or mass "
            "that would help most next.",
        ),
    ] = False,
    mass: Annotated[
        str | None,
        typer.Option(
            metavar="QUANTITY",
            help="With --next: a mass that could be added, for example '200 g'.",
        ),
    ] = None,
    deviation: Annotated[
        str | None,
        typer.Option(
            metavar="QUANTITY",
            help="Wanted relative standard deviation, for example '1 %': hits needed.",
        ),
    ] = None,
    plan: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="Plan of 'measure' to take sensors from; with --next also torques.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="PATH", help="Plan of 'measure' to write (.toml)."),
    ] = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Choose hit points and sensors before the first hit.

    From points that can be reached, those that determine the joints best, with the
    intervals to expect; nuisances (gains, aim, moduli) are taken out.

    Examples:
        jointbench design plates.toml --plan bench.toml --out plan.toml
        jointbench design plates.toml --next --mass '200 g' --deviation '1 %'
        jointbench design plates.toml --next --values joint.json --state day1@20000N
    """
    from jointbench.acquisition.basics.units import parse_value
    from jointbench.station.design.design_output import run_design
    from jointbench.station.design.design_records import DesignRequest

    request = DesignRequest(
        values,
        state,
        next_,
        None if deviation is None else parse_value(deviation, "ratio"),
        None if mass is None else parse_value(mass, "mass"),
    )
    run_design(model, request, template=plan, out=out, json_target=json)


def machine_command(
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL",
            help="Machine (TOML): bodies with [joints] or [springs], or measured "
            "bodies with [links].",
        ),
    ],
    motion: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH",
            help="Table of the tool's motion under the loads to write (.csv).",
        ),
    ] = None,
    cache: Cache = None,
    report: HtmlReport = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Predict a machine: its joints rigid, and as they are.

    Modes [Hz], damping, strain energy by body and joint, receptance at the tool [m/N],
    what each joint costs there, the chatter limit, and the motion under loads.

    Examples:
        jointbench machine grinder.toml --report grinder.html
        jointbench machine grinder.toml --json grinder.json --motion tool.csv
    """
    from jointbench.station.machine.run_machine import run_any_machine

    run_any_machine(model, report=report, motion=motion, json_target=json, cache=cache)


def reassembly_command(
    joints: Annotated[
        list[Path],
        typer.Argument(
            metavar="JOINT",
            help="Joint over its preload (TOML) in several assemblies, and later "
            "sessions of it.",
        ),
    ],
    level: Annotated[
        list[str] | None,
        typer.Option(
            metavar="QUANTITY",
            help="Torque or preload at which the next assembly is predicted, such as "
            "'30 N m'; may be repeated. Default: those measured.",
        ),
    ] = None,
    unopened: Annotated[
        bool,
        typer.Option(
            "--unopened",
            help="The joint was not opened before the latest assembly was measured.",
        ),
    ] = False,
    report: HtmlReport = None,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Compare the assemblies of a joint, and predict the next one.

    How much stiffness and damping scatter when the joint is put together again; the
    range in which the next assembly will lie; whether the latest has changed. Ends
    with exit code 5 if it has.

    Examples:
        jointbench reassembly joint-stiffness.toml --report assemblies.html
        jointbench reassembly first.toml later.toml --level '30 N m'
    """
    from jointbench.station.reassembly.run_reassembly import (
        ReassemblyOutputs,
        run_reassembly,
    )

    same = run_reassembly(
        joints,
        level=level or [],
        opened=not unopened,
        outputs=ReassemblyOutputs(report, json),
    )
    return 0 if same else EXIT_QUALITY
