# SPDX-License-Identifier: MIT
"""``jointbench modal``: FRFs and modes of sessions and hit files."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from jointbench.station.files.input_files import is_session_name, read_recordings
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.universal_frf import write_universal
from jointbench.station.pipeline.chain import (
    ChainSettings,
    ModalChain,
    judge_hits,
    judged_modes,
)
from jointbench.station.pipeline.modal_notes import modal_notes
from jointbench.station.pipeline.modal_summary import modal_json
from jointbench.station.pipeline.recordings_by_preload import (
    by_preload,
    join_pages,
    of_preload,
)
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.report.modal_table import show_modal
from jointbench.station.results.results_file import results_path, write_results
from jointbench.station.screen.terminal import console, progress_bar, write_json


def run_modal(
    files: Sequence[Path],
    settings: ChainSettings | None = None,
    *,
    columns: str | None = None,
    point: str = "1",
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
        columns: of files of hits.
        point: hit point, for files that do not name one.
        out: results file; None for next to the session.
        universal: universal file to write, or None.
        json_target: where the JSON goes.
        run: store and source of the stages; None to store none.

    Returns:
        The result at the first preload.
    """
    target = out or _next_to_session(files)
    check_outputs(files, [target, universal, json_target])
    settings = settings or ChainSettings()
    stored = read_recordings(files, columns=columns, point=point)
    # Levels of hits are judged over the whole campaign, across preloads.
    run = run or StageRun()
    groups = by_preload(judge_hits(stored, settings, run))
    chains, contents = [], []
    for preload, group in groups:
        with progress_bar("estimating FRFs") as progress:
            own_run = replace(run, progress=progress)
            chain = judged_modes(group, settings, own_run, preload)
        own, shared = target, universal
        if len(groups) > 1:
            console(json_target).print(f"\nPreload {preload} N")
            own = None if target is None else of_preload(target, preload)
            shared = None if universal is None else of_preload(universal, preload)
        if own is not None:
            write_results(own, chain, files)
        if shared is not None:
            write_universal(shared, chain.frf, chain.result.model)
        notes = modal_notes(chain)
        show_modal(chain, notes, json_target)
        chains.append(chain)
        contents.append(modal_json(chain, notes))
    content = join_pages([preload for preload, _ in groups], contents)
    write_json(json_target, content | {"results": str(target or "")})
    return chains[0]


def _next_to_session(files: Sequence[Path]) -> Path | None:
    sessions = [path for path in files if is_session_name(path)]
    return results_path(sessions[0]) if len(sessions) == len(files) == 1 else None
