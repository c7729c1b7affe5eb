# SPDX-License-Identifier: MIT
"""``jointbench identify``: the links of a lumped bench from its measured modes."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.analysis.lumped.identified import (
    Identification,
    identification_json,
)
from jointbench.signal.modal.modes import ModalSettings
from jointbench.station.desk.desk_results import chosen_at_desk
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.model_kind import describes_structure
from jointbench.station.joints.modes_of_files import modes_of_files
from jointbench.station.pipeline.chain import ChainSettings
from jointbench.station.pipeline.link_stage import fits, identify_joint
from jointbench.station.pipeline.modal_options import parse_band
from jointbench.station.results.results_file import results_path
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.screen.joint_text import parameter_table
from jointbench.station.screen.terminal import console, working, write_json


def run_identify(
    model: Path,
    sessions: Sequence[Path],
    *,
    band: str | None = None,
    options: FrfOptions | None = None,
    json_target: str | None,
) -> Identification:
    """Identify the links of `model` from measured modes and show them.

    Args:
        model: lumped bench as TOML.
        sessions: sessions, files of hits, or files of FRFs.
        band: of the modes, as typed.
        options: what the user states about files that are no sessions.
        json_target: where the JSON goes.
    """
    check_outputs([model, *sessions], [json_target])
    settings = ChainSettings(modal=ModalSettings(band=parse_band(band)))
    bench = read_toml(model, BenchModel)
    with working("fitting modes, identifying links"):
        # A band asks for other modes than those on the desk.
        modes = None if band else chosen_at_desk(sessions)
        chosen = modes is not None
        if modes is None:
            modes = modes_of_files(sessions, options or FrfOptions(), settings)
        result = identify_joint(bench, modes.result.model)
    if chosen:
        name = visible(results_path(sessions[0]).name)
        console(json_target).print(f"modes as chosen at the desk: {name}")
    show_joint(result, json_target)
    write_json(json_target, identification_json(result))
    return result


def identify_any(
    model: Path,
    sessions: Sequence[Path],
    *,
    band: str | None,
    cache: Path | None,
    report: Path | None,
    json_target: str | None,
    surfaces: Sequence[Path] = (),
    options: FrfOptions | None = None,
) -> bool:
    """Identify the joints of a lumped bench or of a meshed structure.

    Returns:
        Whether the model is consistent with the measurement.

    Raises:
        UsageError: a lumped bench without a session, or with --report or --surface.
    """
    if describes_structure(model):
        from jointbench.station.commands.identify.identify_structure_command import (
            run_identify_structure,
        )

        return run_identify_structure(
            model,
            sessions,
            band=band,
            cache=cache,
            report=report,
            json_target=json_target,
            surfaces=surfaces,
            options=options,
        )
    if not sessions:
        raise UsageError(
            f"'{model}' is a lumped bench and needs a measurement; add sessions or "
            f"files of FRFs, 'jointbench identify {model} SESSION'"
        )
    if report is not None or surfaces:
        raise UsageError(
            "--report and --surface apply to structures with [joints]; for a lumped "
            "bench use 'jointbench report SESSION --model MODEL --out PATH'"
        )
    return fits(
        run_identify(
            model, sessions, band=band, options=options, json_target=json_target
        )
    )


def show_joint(result: Identification, json_target: str | None) -> None:
    """Print the identified parameters with their uncertainty."""
    screen = console(json_target)
    title = f"Links identified from modes: {result.verdict.value}"
    screen.print(parameter_table(title, result.parameters))
    reasons = [*result.reasons, *(p.reason for p in result.parameters if p.reason)]
    for reason in dict.fromkeys(reasons):
        screen.print(f"  {reason}", markup=False)
