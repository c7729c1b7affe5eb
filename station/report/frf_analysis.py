# SPDX-License-Identifier: MIT
"""What a report shows of FRFs from files: their modes, and no hits."""

from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.file_access.quoting import named, visible
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.records.session import Session, software_version
from jointbench.signal.frf.frf_of_functions import noise_source
from jointbench.station.files.frf_files import read_frf
from jointbench.station.files.input_files import is_session_name
from jointbench.station.pipeline.chain import ChainSettings, frf_chain
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.report.session_analysis import PreloadAnalysis, SessionAnalysis
from jointbench.station.results.results_file import results_path
from jointbench.station.results.results_modes import StoredRun, read_run
from jointbench.station.results.results_read import is_results
from jointbench.station.screen.terminal import working


def report_path(path: Path) -> Path:
    """Return where the report of an input goes: ``frf-uff.html`` beside a session."""
    if is_session_name(path):
        return path.with_suffix(".html")
    return path.with_name(results_path(path).name.removesuffix(".results.h5") + ".html")


def is_frf_input(path: Path) -> bool:
    """Return whether a report is about FRFs: a file of them, or results alone.

    Raises:
        BadData: it is an HDF5 file that is damaged, or hostile.
    """
    return is_results(path) if is_session_name(path) else True


def analyse_frfs(
    path: Path, results: Path | None, run: StageRun | None = None
) -> SessionAnalysis:
    """Return the modes of FRFs as a report shows them.

    Args:
        path: a file of FRFs, or the results that `jointbench modal` made of some.
        results: a results file to show in place of the one next to `path`, or None.
        run: store and source of the stages; None to keep none.

    Raises:
        UsageError: the results are of a session, or of another file.
        BadData: the file holds no FRFs.
    """
    own = is_session_name(path)
    if own and results is not None:
        raise UsageError(f"{named(path)} holds results already; leave --results out")
    stored = read_run(path) if own else _stored(path, results)
    if stored is not None:
        return _analysis(path, _shown(path, stored), stored)
    frf = read_frf([path], FrfOptions())
    if frf is None:
        raise BadData(
            f"{named(path)} is no session and holds no FRFs that state their units; "
            "`jointbench modal` reads others with --columns and stores results"
        )
    with working("fitting modes"):
        chain = frf_chain(frf, ChainSettings(), run or StageRun())
    return _analysis(path, (PreloadAnalysis(None, chain),), None)


def _stored(path: Path, given: Path | None) -> StoredRun | None:
    """Return the results of a file of FRFs: those given, else those next to it.

    Raises:
        UsageError: those given were made of another file.
    """
    beside = given or results_path(path)
    if not beside.is_file():
        return None
    run = read_run(beside)
    if file_digest(path) in run.inputs:
        return run
    if given is not None:
        raise UsageError(
            f"{named(given)} was not made of {named(path)} as it is now; compute "
            "results again, or leave --results out"
        )
    return None


def _shown(path: Path, run: StoredRun) -> tuple[PreloadAnalysis, ...]:
    """Return stored modes without recordings.

    Raises:
        UsageError: they were made of samples, which the report shows as well.
    """
    words = f"{visible(run.path.name)}: {run.words}"
    for modes in run.modes:
        if noise_source(modes.steps) is None:
            raise UsageError(
                f"{named(path)} holds results of a session; give the session itself"
            )
    return tuple(
        PreloadAnalysis(modes.preload, modes.with_recordings(()), words)
        for modes in run.modes
    )


def _analysis(
    path: Path, preloads: tuple[PreloadAnalysis, ...], run: StoredRun | None
) -> SessionAnalysis:
    session = Session(
        uuid="",
        created="",
        software=software_version(),
        simulated=False,
        notes="Modes of FRFs from files; no samples were given",
        source=path.name,
    )
    remarks = (f"Modes from {visible(run.path.name)} ({run.words}).",) if run else ()
    return SessionAnalysis(session, (), preloads, remarks=remarks)
