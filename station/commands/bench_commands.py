# SPDX-License-Identifier: MIT
"""Commands at the bench: their names and options; other modules do the work."""

import os
from pathlib import Path
from typing import Annotated

import typer

from jointbench.station.commands.shared_options.output_options import (
    Debug,
    Force,
    Json,
    SessionOut,
)
from jointbench.station.screen.exit_codes import EXIT_QUALITY


def measure_command(
    plan: Annotated[
        Path, typer.Argument(metavar="PLAN", help="Measurement plan (TOML).")
    ],
    out: SessionOut,
    source: Annotated[
        str | None,
        typer.Option(
            metavar="URL",
            help="Instrument: 'ni:', 'ni+grpc://HOST:PORT' or 'sim:plates'; from the "
            "plan by default.",
        ),
    ] = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Measure hammer hits as planned: points, levels and torques.

    The command proposes trigger level and windows, judges each hit, and names the
    next point, level and torque. The session file survives a crash, a lost cable and
    a full disk.

    Examples:
        jointbench measure plan.toml --out session.h5 --source ni:
        jointbench measure plates.toml --out plates.h5 --source 'sim:plates?seed=1'
    """
    # gRPC reports lost connections on standard error; the session reports them itself.
    os.environ.setdefault("GRPC_VERBOSITY", "NONE")
    from jointbench.station.measure.bench_session import run_measure

    measured = run_measure(plan, out, source=source, overwrite=force, json_target=json)
    return 0 if measured.whole else EXIT_QUALITY


def record_command(
    source: Annotated[
        str,
        typer.Argument(
            metavar="PLAN|URL",
            help="Plan of timed runs (TOML); or a bench: 'sim:two-body-campaign', "
            "'sim:bolted-plates', 'sim:lap-beam' or 'sim:column-on-bed'.",
        ),
    ],
    out: SessionOut,
    instrument: Annotated[
        str | None,
        typer.Option(
            "--source",
            metavar="URL",
            help="Instrument of a plan: 'ni:', 'ni+grpc://HOST:PORT', 'sim:spindle' or "
            "'sim:shaker'; from the plan by default.",
        ),
    ] = None,
    force: Force = False,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Record timed runs by a plan, or a simulated campaign.

    Runs of a plan are operating runs, shaker runs, or plain recordings; a session of
    hammer hits is recorded by 'measure'. Of a simulated campaign all hits are judged
    after the recording; nominal values and what it hides go beside it.

    Examples:
        jointbench record examples/operating.toml --out spindle.h5
        jointbench record plan.toml --out run.h5 --source ni:
        jointbench record 'sim:two-body-campaign?seed=3&hide=jenkins' --out
        campaign.h5
        jointbench record 'sim:bolted-plates?seed=3&hide=loose_bolt' --out hits.h5
    """
    os.environ.setdefault("GRPC_VERBOSITY", "NONE")
    if source.lower().endswith(".toml") and not Path(source).is_dir():
        from jointbench.station.continuous.record_runs import run_record_plan

        whole = run_record_plan(
            Path(source), out, source=instrument, overwrite=force, json_target=json
        )
        return 0 if whole else EXIT_QUALITY
    from jointbench.simulators.flexible.flexible_url import is_flexible_url
    from jointbench.station.commands.record_command import require_bench, run_record

    require_bench(source)
    if is_flexible_url(source):
        from jointbench.station.sources.record_flexible import run_record_flexible

        run_record_flexible(source, out, overwrite=force, json_target=json)
        return 0
    written = run_record(source, out, overwrite=force, json_target=json)
    return 0 if written.whole else EXIT_QUALITY


def watch_command(
    session: Annotated[
        Path,
        typer.Argument(
            metavar="SESSION", help="Session that is being recorded, or was recorded."
        ),
    ],
    once: Annotated[
        bool, typer.Option("--once", help="Show the state once, and leave.")
    ] = False,
    json: Json = None,
    debug: Debug = False,
) -> None:
    """Follow a session in a second terminal while it is recorded.

    The command shows what was measured so far, then each event as it comes. It reads
    the session file only: it may start late and stop at any time. A finished session
    is shown as it ended.

    Examples:
        jointbench watch session.h5
        jointbench watch session.h5 --once --json -
    """
    from jointbench.station.bench_view.watch_session import run_watch

    run_watch(session, once=once, json_target=json)


def send_command(
    session: Annotated[
        Path, typer.Argument(metavar="SESSION", help="Session that is being recorded.")
    ],
    words: Annotated[
        list[str],
        typer.Argument(
            metavar="COMMAND",
            help="'pause', 'continue', 'reject 17', 'go 4', 'note TEXT', 'quit yes'; "
            "all are in docs/bench-screen.md.",
        ),
    ],
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Send a command to a session that is being recorded.

    The command goes to the 'measure' or 'record' that writes the session, as if it
    was typed there; its answer is printed. 'watch --once' prints the state.

    Examples:
        jointbench send session.h5 pause
        jointbench send session.h5 note bolt 2 rubs
        jointbench send session.h5 quit yes
    """
    from jointbench.station.bench_view.send_command import run_send

    done = run_send(session, " ".join(words), json_target=json)
    return 0 if done else EXIT_QUALITY


def doctor_command(
    plan: Annotated[
        Path | None,
        typer.Argument(
            metavar="PLAN",
            help="Plan of 'measure' or 'record' (TOML); the devices alone without one.",
        ),
    ] = None,
    source: Annotated[
        str | None,
        typer.Option(
            metavar="URL",
            help="Instrument: 'ni:', 'ni+grpc://HOST:PORT' or 'sim:plates'; from the "
            "plan by default.",
        ),
    ] = None,
    noise: Annotated[
        str,
        typer.Option(
            metavar="QUANTITY", help="Duration of the noise, for example '5 s'."
        ),
    ] = "10 s",
    hit: Annotated[
        str,
        typer.Option(
            metavar="QUANTITY",
            help="Longest time for one hit, for example '30 s'; '0 s' for none.",
        ),
    ] = "30 s",
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Examine a bench before the first measurement.

    The command examines driver, devices and sensors against the plan, the noise of
    each channel against its data sheet, and one hit. Each finding states what to do.

    Examples:
        jointbench doctor plan.toml --source ni:
        jointbench doctor --source ni+grpc://192.168.0.7:31763
        jointbench doctor examples/plates.toml --source 'sim:plates?seed=1'
    """
    from jointbench.acquisition.basics.units import parse_value
    from jointbench.station.doctor.bench_finding import Health
    from jointbench.station.doctor.run_doctor import run_doctor

    found = run_doctor(
        plan,
        source=source,
        noise_time=parse_value(noise, "time"),
        hit_time=parse_value(hit, "time"),
        json_target=json,
    )
    return 0 if all(f.health is Health.GOOD for f in found) else EXIT_QUALITY


def calibrate_command(
    session: Annotated[
        Path,
        typer.Argument(metavar="SESSION", help="Session of hits on the known mass."),
    ],
    mass: Annotated[
        str,
        typer.Option(
            metavar="QUANTITY",
            help="Moving mass, sensors included, for example '4.512 kg'.",
        ),
    ],
    mass_sd: Annotated[
        str,
        typer.Option(
            metavar="QUANTITY",
            help="Standard uncertainty of the mass, for example '0.5 g'.",
        ),
    ] = "0 g",
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Calibrate accelerometers against the hammer on a known mass.

    Examples:
        jointbench calibrate mass.h5 --mass '4.512 kg' --mass-sd '0.5 g'
    """
    from jointbench.station.commands.calibrate_command import run_calibrate

    found = run_calibrate(session, mass=mass, mass_sd=mass_sd, json_target=json)
    return 0 if all(each.passed for each in found) else EXIT_QUALITY


def simulate_command(
    bench: Annotated[
        str,
        typer.Argument(metavar="URL", help="Simulated bench, its speed and its port."),
    ] = "sim:plates?speed=1&interval=2&port=31763",
    module: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Modules, joined by commas: 9234, 9231, 9250, 9230, 4431, 9215, 6363.",
        ),
    ] = None,
    debug: Debug = False,
) -> None:
    """Serve simulated NI devices over gRPC.

    Programs that use nidaqmx over gRPC can connect. The parameter
    'interval' is the time between hits [s], 'speed' the simulated time per real time
    [-], 'port' the TCP port. 'sim:sine' has a sine at every input instead of a
    specimen. Stop the server with Ctrl-C.

    Examples:
        jointbench simulate 'sim:plates?interval=2&port=31763'

        jointbench simulate 'sim:sine?port=31763' --module 9234,9215
    """
    from jointbench.station.commands.simulate import run_simulate

    run_simulate(bench, module or "")
