# SPDX-License-Identifier: MIT
"""The command line: every command under its group; other modules do the work.

Every command imports what it needs when it runs, so that ``--help`` stays instant.
"""

import sys
from collections.abc import Callable, Mapping
from functools import partial
from typing import Annotated

import typer

from jointbench.station.commands.bench_commands import (
    calibrate_command,
    doctor_command,
    measure_command,
    record_command,
    send_command,
    simulate_command,
    watch_command,
)
from jointbench.station.commands.contact_command import (
    contact_command,
    pressure_map_command,
)
from jointbench.station.commands.file_commands import (
    example_command,
    export_command,
    inspect_command,
    provenance_command,
    recover_command,
    verify_command,
)
from jointbench.station.commands.gap_commands import gap_command, next_command
from jointbench.station.commands.joint_commands import (
    agreement_command,
    design_command,
    export_joint_command,
    identify_command,
    machine_command,
    reassembly_command,
)
from jointbench.station.commands.pressure_command import pressure_command
from jointbench.station.commands.profile_command import profile_command
from jointbench.station.commands.recorded_data_commands import (
    import_command,
    modal_command,
    report_command,
    surface_command,
)
from jointbench.station.commands.reprocessing_commands import (
    archive_command,
    compare_command,
    process_command,
    reprocess_command,
)
from jointbench.station.commands.screen_commands import bench_command, desk_command
from jointbench.station.commands.shared_options.registered_names import (
    added_effects,
    command_with_names,
    contact_models,
)
from jointbench.station.demo.demo_command import demo_command
from jointbench.station.screen.exit_codes import exit_code, show_traceback
from jointbench.station.screen.help_page import HelpCommand, HelpGroup

__all__ = ["app", "exit_code", "run"]

PROGRAM = "jointbench"
COMMANDS: Mapping[str, Mapping[str, Callable[..., object]]] = {
    "At the bench": {
        "demo": demo_command,
        "measure": measure_command,
        "bench": bench_command,
        "record": record_command,
        "watch": watch_command,
        "send": send_command,
        "doctor": doctor_command,
        "calibrate": calibrate_command,
        "profile": profile_command,
        "simulate": simulate_command,
    },
    "Recorded data": {
        "import": import_command,
        "modal": modal_command,
        "desk": desk_command,
        "surface": surface_command,
        "report": report_command,
        "process": process_command,
        "reprocess": reprocess_command,
        "archive": archive_command,
        "compare": compare_command,
    },
    "Joints and machines": {
        "design": design_command,
        "identify": identify_command,
        "agreement": agreement_command,
        "export-joint": export_joint_command,
        "contact": contact_command,
        "pressure-map": pressure_map_command,
        "pressure": pressure_command,
        "machine": machine_command,
        "gap": gap_command,
        "next": next_command,
        "reassembly": reassembly_command,
    },
    "Files": {
        "example": example_command,
        "inspect": inspect_command,
        "provenance": provenance_command,
        "verify": verify_command,
        "recover": recover_command,
        "export": export_command,
    },
}
"""The commands by their group in the help; names are flat: ``jointbench modal``."""

WITH_NAMES = {
    "contact": command_with_names({"model": ("One of", contact_models)}),
    "gap": command_with_names({"without": ("Other packages add", added_effects)}),
}
"""Commands whose help lists names that are installed."""

app = typer.Typer(
    name=PROGRAM,
    cls=HelpGroup,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def run() -> None:
    """Run the command line and leave with its exit code."""
    if len(sys.argv) == 1:
        sys.argv.append("--help")
    sys.excepthook = show_traceback
    command = partial(app, prog_name=PROGRAM)
    sys.exit(exit_code(command, debug="--debug" in sys.argv[1:]))


def _show_versions(asked: bool) -> None:
    if asked:
        from jointbench.station.screen.version_text import version_text

        typer.echo(version_text())
        raise typer.Exit


@app.callback()
def _jointbench(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_show_versions,
            is_eager=True,
            help="Show the versions of jointbench and of its libraries and exit.",
        ),
    ] = False,
) -> None:
    """Measure, identify and explain the joints of machines.

    'jointbench COMMAND --help' shows the options, units and examples of a command.

    Exit codes: 0 success; 1 internal error; 2 usage error; 3 bad data; 4 instrument
    error; 5 finished, but a quality criterion failed; 130 interrupted.

    Examples:
        jointbench demo --out demo-out
        jointbench example joint
        jointbench modal session.h5
    """


for _group, _members in COMMANDS.items():
    for _name, _work in _members.items():
        _class = WITH_NAMES.get(_name, HelpCommand)
        app.command(name=_name, cls=_class, rich_help_panel=_group)(_work)
