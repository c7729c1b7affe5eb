# SPDX-License-Identifier: MIT
"""``jointbench demo`` on the command line: its options."""

from pathlib import Path
from typing import Annotated

import typer

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.commands.shared_options.output_options import Debug, Json


def demo_command(
    out: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Folder for all results.")
    ] = Path("demo-out"),
    seed: Annotated[
        int, typer.Option(metavar="N", help="Seed of the simulated bench.", min=0)
    ] = 1,
    plates: Annotated[
        bool, typer.Option("--plates", help="Two bolted plates, one bolt left loose.")
    ] = False,
    chain: Annotated[
        bool,
        typer.Option(
            "--chain",
            help="A joint with the stiffness of its own surfaces, bolts and bodies: "
            "why it is softer than its contact law.",
        ),
    ] = False,
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Measure and identify a joint on a simulated bench.

    The demo needs no hardware. It records hammer hits and two surfaces, extracts
    modes and fractal parameters, identifies the joint, and compares all results with
    the true parameters of the simulation. It takes less than two minutes. With
    --plates, two plates on bolts are struck, and the bolt left loose is found. With
    --chain, two surfaces are measured and two bolted blocks are struck at six torques;
    the causes between contact law and modes are named, each with its factor.

    Examples:
        jointbench demo --out demo-out
        jointbench demo --seed 7 --out demo-7 --json demo-7.json
        jointbench demo --plates --out demo-plates
        jointbench demo --chain --out demo-chain
    """
    if plates and chain:
        raise UsageError("--plates and --chain are two demos; give one of them")
    if chain:
        from jointbench.station.demo.demo_chain import run_demo_chain

        return run_demo_chain(out, seed=seed, json_target=json)
    if plates:
        from jointbench.station.demo.demo_plates import run_demo_plates

        return run_demo_plates(out, seed=seed, json_target=json)
    from jointbench.station.demo.demo import run_demo

    return run_demo(out, seed=seed, json_target=json)
