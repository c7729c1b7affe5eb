# SPDX-License-Identifier: MIT
"""``jointbench demo`` on the command line: its options."""

from pathlib import Path
from typing import Annotated

import typer

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
    json: Json = None,
    debug: Debug = False,
) -> int:
    """Measure and identify a joint on a simulated bench.

    The demo needs no hardware. It records hammer hits and two surfaces, extracts
    modes and fractal parameters, identifies the joint, and compares all results with
    the true parameters of the simulation. It takes less than two minutes. With
    --plates, two plates on bolts are struck, and the bolt left loose is found.

    Examples:
        jointbench demo --out demo-out
        jointbench demo --seed 7 --out demo-7 --json demo-7.json
        jointbench demo --plates --out demo-plates
    """
    if plates:
        from jointbench.station.demo.demo_plates import run_demo_plates

        return run_demo_plates(out, seed=seed, json_target=json)
    from jointbench.station.demo.demo import run_demo

    return run_demo(out, seed=seed, json_target=json)
