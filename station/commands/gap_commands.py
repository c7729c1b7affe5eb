# SPDX-License-Identifier: MIT
"""Commands on what a model lacks: gap and next."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.commands.shared_options.input_options import (
    Preload,
)
from jointbench.station.commands.shared_options.joint_options import (
    ChainSurfaces,
    GapSources,
    Model,
)
from jointbench.station.commands.shared_options.output_options import (
    Debug,
    HtmlReport,
    Json,
)


def gap_command(
    sources: GapSources,
    model: Model = None,
    preload: Preload = None,
    without: Annotated[
        str | None,
        typer.Option(metavar="NAME,...", help="Effects to leave out of the catalogue."),
    ] = None,
    with_: Annotated[
        str | None,
        typer.Option(
            "--with",
            metavar="NAME,...",
            help="Laws of real joints to add: bouc_wen_free, iwan_segalman, clearance, "
            "quadratic_cubic, cubic_quintic, power_damping, or real_joints for all.",
        ),
    ] = None,
    effects: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="PATH", help="Python file with effects of your own; it is executed."
        ),
    ] = None,
    curves: Annotated[
        bool,
        typer.Option(
            "--curves",
            help="Compare natural frequency and damping over amplitude, as measured, "
            "with those that the explanations predict; 1 to 2 s more.",
        ),
    ] = False,
    surface: ChainSurfaces = None,
    report: HtmlReport = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Find the effect that is missing from a model.

    The verdict is 'named', 'none', 'ambiguous' with an experiment that separates the
    candidates, 'mostly' with the family of a law that explains most of the gap, or
    'unknown'. The exit code is 0 for each of them.

    Examples:
        jointbench gap session.h5 --model bench.toml --report gap.html
        jointbench gap hits.h5 --model sheet.json
        jointbench gap session.h5 --model bench.toml --surface a.csv --surface b.csv
        jointbench gap surface.csv --report surface.html
        jointbench gap 'sim:two-body-campaign?seed=3&hide=iwan'
    """
    if surface:
        _refuse_with_surface(with_, effects, curves)
        from jointbench.station.chain.run_chain import run_chain

        run_chain(
            sources,
            surface,
            model=model,
            preload=preload,
            without=without,
            report=report,
            json_target=json,
        )
        return
    from jointbench.station.gap.gap_options import names_in
    from jointbench.station.gap.run_gap import run_gap

    run_gap(
        sources,
        model=model,
        preload=preload,
        without=without,
        effects=[*(effects or []), *sorted(names_in(with_))],
        curves=curves,
        report=report,
        json_target=json,
    )


def _refuse_with_surface(
    with_: str | None, effects: list[Path] | None, curves: bool
) -> None:
    if with_ or effects or curves:
        raise UsageError(
            "--with, --effects and --curves do not apply to a chain; leave them or "
            "--surface out"
        )


def next_command(
    joints: Annotated[
        list[Path],
        typer.Argument(
            metavar="JOINT",
            help="Joint over its preload (TOML), and later sessions of it.",
        ),
    ],
    plan: Annotated[
        Path | None,
        typer.Option(
            metavar="PATH", help="Plan of the first session (TOML): sensors, points."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="PATH", help="Plan of the next session to write (TOML)."),
    ] = None,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Rank the next experiments on a joint.

    Where 'gap' is ambiguous or unknown, outcomes of candidate series of torques are
    simulated under every explanation that survives; the best one becomes a plan.

    Examples:
        jointbench next joint-stiffness.toml
        jointbench next joint.toml --plan plates.toml --out next.toml
    """
    from jointbench.station.joint_states.next_session import run_next

    run_next(joints, plan=plan, out=out, json_target=json)
