# SPDX-License-Identifier: MIT
"""``jointbench modal``: FRFs and modes of sessions, hit files and files of FRFs."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rich.text import Text

from jointbench.acquisition.basics.errors import UnitError, UsageError
from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.formats.frfs.frf_columns import TABLE_EXAMPLE
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.frf.continuous_frf import estimate_continuous_frf
from jointbench.signal.hits.plausibility import channel_words
from jointbench.station.desk.desk_results import set_aside
from jointbench.station.files.frf_files import read_frf
from jointbench.station.files.input_files import is_session_name, read_recordings
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.run_purposes import shaker_runs
from jointbench.station.files.universal_frf import write_universal
from jointbench.station.pipeline.chain import (
    ChainSettings,
    ModalChain,
    frf_chain,
    judge_hits,
    judged_modes,
)
from jointbench.station.pipeline.modal_notes import modal_notes
from jointbench.station.pipeline.modal_summary import modal_json
from jointbench.station.pipeline.recordings_by_preload import (
    by_preload,
    join_pages,
    of_preload,
    preload_sd,
    preload_words,
)
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.report.modal_table import show_modal
from jointbench.station.results.results_file import results_path, write_results
from jointbench.station.screen.terminal import console, progress_bar, write_json

Targets = tuple[Path | None, Path | None, str | None]
"""Results file, universal file, JSON."""


def run_frfs(
    files: Sequence[Path],
    options: FrfOptions,
    settings: ChainSettings,
    targets: Targets,
    run: StageRun | None = None,
) -> ModalChain | None:
    """Identify the modes of FRFs, show them and store them next to a single file.

    Args:
        files: any; FRFs are recognised by their content.
        options: what the user states about them.
        settings: of the chain; those of hits, windows and Kalman stage do not count.
        targets: results file, universal file and JSON, each or None.
        run: store of the stages; None to store none.

    Returns:
        The result, None where the files hold samples.
    """
    check_outputs(files, list(targets))
    frf = read_frf(files, options)
    if frf is None:
        if options.averages:
            raise UsageError("--averages is for files of FRFs; these hold samples")
        return None
    target = targets[0] or (results_path(files[0]) if len(files) == 1 else None)
    check_outputs(files, [target, *targets[1:]])
    with progress_bar("fitting modes") as progress:
        own_run = replace(run or StageRun(), progress=progress)
        chain = frf_chain(frf, settings, own_run)
    content = _give_out(chain, files, (target, *targets[1:]))
    write_json(targets[2], content | {"results": str(target or "")})
    return chain


def run_modal(
    files: Sequence[Path],
    settings: ChainSettings | None = None,
    *,
    samples: SampleOptions | None = None,
    out: Path | None = None,
    universal: Path | None = None,
    json_target: str | None = None,
    run: StageRun | None = None,
) -> ModalChain:
    """Identify the modes in `files`, show them and store them next to the session.

    Recordings at different preloads are never averaged: each preload has its own
    modes, table and results file.

    Args:
        files: sessions, or files of hits.
        settings: None for the defaults.
        samples: what the user says about files of hits.
        out: results file; None for next to the session.
        universal: universal file to write, or None.
        json_target: where the JSON goes.
        run: store and source of the stages; None to store none.

    Returns:
        The result at the first preload.
    """
    settings, run = settings or ChainSettings(), run or StageRun()
    target = out or _next_to_session(files)
    check_outputs(files, [target, universal, json_target])
    stored = _recordings(files, samples or SampleOptions())
    doubts = () if all(map(is_session_name, files)) else channel_words(stored)
    for words in doubts:
        console(json_target).print(Text(f"warning: {words}"))
    shaken = shaker_runs(stored)
    if shaken:
        return _shaken_modes(shaken, files, settings, (target, universal, json_target))
    # Levels of hits are judged over the whole campaign, across preloads.
    groups = by_preload(judge_hits(stored, settings, run))
    chains, contents = [], []
    for preload, group in groups:
        with progress_bar("estimating FRFs") as progress:
            own_run = replace(run, progress=progress)
            chain = judged_modes(group, settings, own_run, preload)
        own, shared = target, universal
        if len(groups) > 1:
            console(json_target).print(f"\n{preload_words(preload, group)}")
            own = None if target is None else of_preload(target, preload)
            shared = None if universal is None else of_preload(universal, preload)
        content = _give_out(chain, files, (own, shared, json_target))
        deviation = preload_sd(group)
        known = {} if deviation is None else {"preload_sd_n": deviation}
        contents.append(content | known)
        chains.append(chain)
    content = join_pages([preload for preload, _ in groups], contents)
    content |= {"results": str(target or ""), "import_warnings": list(doubts)}
    write_json(json_target, content)
    return chains[0]


def _shaken_modes(
    runs: Sequence[Recording],
    files: Sequence[Path],
    settings: ChainSettings,
    targets: Targets,
) -> ModalChain:
    """Identify the modes of shaker runs, show them and store them."""
    with progress_bar("estimating FRFs") as progress:
        frf = estimate_continuous_frf(runs, estimator=settings.estimator)
        chain = frf_chain(frf, settings, StageRun(progress=progress))
    content = _give_out(chain, files, targets)
    write_json(targets[2], content | {"results": str(targets[0] or "")})
    return chain


def _recordings(files: Sequence[Path], given: SampleOptions) -> tuple[Recording, ...]:
    """Read recordings; where units are missing, the message names FRFs as well."""
    try:
        return read_recordings(
            files, columns=given.columns, point=given.point, rate=given.rate
        )
    except UnitError as error:
        if given.columns is not None:
            raise
        raise UnitError(f"{error}; for FRFs --columns '{TABLE_EXAMPLE}'") from error


def _give_out(
    chain: ModalChain, files: Sequence[Path], targets: Targets
) -> dict[str, object]:
    """Write the files of a chain, show it, and return its JSON."""
    results, universal, json_target = targets
    if results is not None:
        kept = set_aside(results)
        if kept is not None:
            name = visible(kept.name)
            console(json_target).print(f"choices made at the desk are kept in {name}")
        write_results(results, chain, files)
    if universal is not None:
        write_universal(universal, chain.frf, chain.result.model)
    notes = modal_notes(chain)
    show_modal(chain, notes, json_target)
    return modal_json(chain, notes)


def _next_to_session(files: Sequence[Path]) -> Path | None:
    sessions = [path for path in files if is_session_name(path)]
    return results_path(sessions[0]) if len(sessions) == len(files) == 1 else None
