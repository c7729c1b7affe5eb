# SPDX-License-Identifier: MIT
"""Commands of a day at the bench: measure, calibrate, serve a simulated chassis."""

import os
from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.output_options import Debug, Force, Json
from jointbench.station.screen.exit_codes import EXIT_QUALITY


def measure_command(
    plan: Annotated[Path, typer.Argument(help="Plan of the measurement, TOML.")],
    out: Annotated[Path, typer.Option(help="Session file to write.")],
    source: Annotated[
        str | None,
        typer.Option(help="ni:, ni+grpc://host:port or sim:plates; else the plan's."),
    ] = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Measure hammer hits by a plan: points x levels x torques, each repeated.

    Example: jointbench measure plan.toml --out session.h5 --source
    'sim:plates?seed=1'
    """
    # gRPC writes of every lost connection to standard error; the session says it.
    os.environ.setdefault("GRPC_VERBOSITY", "NONE")
    from jointbench.station.measure.bench_session import run_measure

    measured = run_measure(plan, out, source=source, overwrite=force, json_target=json)
    return 0 if measured.whole else EXIT_QUALITY


def calibrate_command(
    session: Annotated[Path, typer.Argument(help="Session of hits on the mass.")],
    mass: Annotated[
        str, typer.Option(help="All that moves, sensors included, '4 kg'.")
    ],
    mass_sd: Annotated[str, typer.Option(help="Its standard uncertainty.")] = "0 g",
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Compare every accelerometer with the hammer on a mass that is known.

    Example: jointbench calibrate mass.h5 --mass '4.512 kg' --mass-sd '0.5 g'
    """
    from jointbench.station.commands.calibrate_command import run_calibrate

    found = run_calibrate(session, mass=mass, mass_sd=mass_sd, json_target=json)
    return 0 if all(each.passed for each in found) else EXIT_QUALITY


def simulate_command(
    bench: Annotated[
        str, typer.Argument(help="What stands on the bench.", metavar="URL")
    ] = "sim:plates?speed=1&interval=2&port=31763",
    debug: Debug = False,
) -> None:
    """Serve a simulated NI chassis for any program that uses nidaqmx over gRPC.

    Example: jointbench simulate 'sim:plates?speed=1&interval=2&port=31763'
    """
    from jointbench.station.commands.simulate import run_simulate

    run_simulate(bench)
