# SPDX-License-Identifier: MIT
"""What lies on the desk: recordings at one preload, or FRFs from files."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.recordings import Recording, Verdict
from jointbench.acquisition.session_file.open_session import open_session
from jointbench.signal.frf.continuous_frf import estimate_continuous_frf
from jointbench.signal.frf.estimators import Estimator
from jointbench.signal.frf.frf import Frf
from jointbench.station.desk.desk_choice import ChoiceAction, DeskChoice
from jointbench.station.files.frf_files import read_frf
from jointbench.station.files.input_files import is_session_name, read_recordings
from jointbench.station.files.run_purposes import shaker_runs
from jointbench.station.pipeline.chain import (
    ChainSettings,
    ModalChain,
    frf_chain,
    judge_hits,
    modal_chain,
)
from jointbench.station.pipeline.recordings_by_preload import (
    at_words,
    by_preload,
    of_preload,
)
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.results.results_file import results_path
from jointbench.station.schemas.geometry_file import (
    Geometry,
    geometry_beside_frfs,
    read_geometry,
)


@dataclass(frozen=True, slots=True)
class DeskRequest:
    """What is asked of a desk.

    Attributes:
        settings: of the chain from recordings to modes.
        frfs: what the user states about files of FRFs.
        samples: what the user states about files of hits.
        geometry: file of points and lines, or None.
    """

    settings: ChainSettings = field(default_factory=ChainSettings)
    frfs: FrfOptions = field(default_factory=FrfOptions)
    samples: SampleOptions = field(default_factory=SampleOptions)
    geometry: Path | None = None


@dataclass(frozen=True, slots=True, eq=False)
class DeskSubject:
    """One thing to choose the modes of.

    Attributes:
        title: file, and preload where a session has several.
        files: it was read from.
        results: file that the choices are written to.
        settings: of the chain.
        recordings: with judged hits; none for FRFs.
        frf: from files or shaker runs, or None.
        preload: on the joint [N], or None.
        geometry: to draw shapes on, or None.
        simulated: whether a simulated bench recorded it.
    """

    title: str
    files: tuple[Path, ...]
    results: Path
    settings: ChainSettings
    recordings: tuple[Recording, ...] = ()
    frf: Frf | None = None
    preload: float | None = None
    geometry: Geometry | None = None
    simulated: bool = False

    @property
    def directions(self) -> Mapping[str, str]:
        """Directions of channels by name, as recorded."""
        channels = (c for r in self.recordings for c in r.channels)
        return {c.name: c.direction for c in channels if c.direction}


def desk_subjects(
    files: Sequence[Path], request: DeskRequest
) -> tuple[DeskSubject, ...]:
    """Read files for the desk.

    Each session is a subject of its own, and each preload of it; files of FRFs
    together are one, as are files of hits.

    Args:
        files: sessions, files of FRFs, or files of hits.
        request: options.

    Raises:
        BadData: a file cannot be read, or holds no hit.
        UsageError: some hold FRFs, and some samples.
    """
    given = None if request.geometry is None else read_geometry(request.geometry)
    frf = read_frf(files, request.frfs)
    if frf is not None:
        beside = next(filter(None, map(geometry_beside_frfs, files)), None)
        subject = DeskSubject(
            _title(files),
            tuple(files),
            results_path(files[0]),
            request.settings,
            frf=frf,
            geometry=given or beside,
        )
        return (subject,)
    sessions = [path for path in files if is_session_name(path)]
    others = tuple(path for path in files if path not in sessions)
    found: list[DeskSubject] = []
    for path in sessions:
        content = open_session(path)
        found += _of_recordings(
            (path,), content.recordings, request, given, content.simulated
        )
    if others:
        options = request.samples
        read = read_recordings(
            others, columns=options.columns, point=options.point, rate=options.rate
        )
        found += _of_recordings(others, read, request, given, False)
    return tuple(found)


def _of_recordings(
    files: tuple[Path, ...],
    recordings: Sequence[Recording],
    request: DeskRequest,
    geometry: Geometry | None,
    simulated: bool,
) -> list[DeskSubject]:
    """Return the subjects of one session: one for each preload."""
    settings, target = request.settings, results_path(files[0])
    blank = DeskSubject(
        _title(files), files, target, settings, geometry=geometry, simulated=simulated
    )
    shaken = shaker_runs(recordings)
    if shaken:
        frf = estimate_continuous_frf(shaken, estimator=settings.estimator)
        return [replace(blank, frf=frf)]
    groups = by_preload(judge_hits(recordings, settings))
    if len(groups) == 1:
        preload, group = groups[0]
        return [replace(blank, recordings=group, preload=preload)]
    return [
        replace(
            blank,
            title=blank.title + at_words(preload),
            results=of_preload(target, preload),
            recordings=group,
            preload=preload,
        )
        for preload, group in groups
    ]


def _title(files: Sequence[Path]) -> str:
    more = f" and {len(files) - 1} more" if len(files) > 1 else ""
    return files[0].name + more


def automatic_chain(
    subject: DeskSubject, choices: Sequence[DeskChoice], run: StageRun
) -> ModalChain:
    """Return FRF and automatic modes of a subject, its hits as chosen.

    Args:
        subject: what lies on the desk.
        choices: of hits and of the estimator; others do not count.
        run: progress, and store of the stages.

    Raises:
        BadData: no hit is left, or no mode rises above the noise.
    """
    if subject.frf is not None:
        return frf_chain(subject.frf, subject.settings, run)
    settings, recordings = subject.settings, subject.recordings
    for one in choices:
        if one.action is ChoiceAction.ESTIMATOR:
            settings = replace(settings, estimator=Estimator(one.name))
        elif one.action in {ChoiceAction.DROP_HIT, ChoiceAction.KEEP_HIT}:
            recordings = tuple(_rejudged(r, one) for r in recordings)
    # Poles on one curve over amplitude stay apart: they are what is chosen from.
    return modal_chain(recordings, settings, run, subject.preload, over_amplitude=False)


def hit_time(recording: Recording, trigger: int) -> float:
    """Return when a hit was struck since the session began [s]."""
    return recording.start_time + trigger / recording.sample_rate


def _rejudged(recording: Recording, choice: DeskChoice) -> Recording:
    """Return a recording with the verdict of one hit set by hand."""
    if recording.name != choice.name:
        return recording
    near = 0.5 / recording.sample_rate
    drop = choice.action is ChoiceAction.DROP_HIT
    verdict = Verdict.OPERATOR if drop else Verdict.OK
    words = f"{'dropped' if drop else 'kept'} at the desk by {choice.who}"
    hits = tuple(
        replace(hit, verdict=verdict, reason=words)
        if abs(hit_time(recording, hit.trigger) - choice.time) < near
        else hit
        for hit in recording.hits
    )
    return replace(recording, hits=hits)
