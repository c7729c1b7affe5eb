# SPDX-License-Identifier: MIT
"""Whatever `gap` is given (campaign, sessions, a long record, a URL), examined.

What only one kind of source needs is imported where it is read: a source of another
kind began 0.7 s later.
"""

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.session_file.store import SESSION_SCHEMA, read_session
from jointbench.analysis.gap.catalogue.catalogue import (
    ALL_REAL_JOINTS,
    with_real_joints,
)
from jointbench.analysis.gap.catalogue.installed_effects import installed_catalogue
from jointbench.analysis.gap.intake.read_hit_campaign import HIT_SCHEMA
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.analysis.gap.model.stretch_score import StretchScore
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.station.bolted.free_bodies import gap_table
from jointbench.station.files.input_files import is_session_name, refuse_twice
from jointbench.station.files.toml_file import read_toml
from jointbench.station.gap.frf_levels import refuse_frfs
from jointbench.station.gap.structure_files import (
    examine_meshed,
    examine_recordings,
    examine_structure,
    nominal_beside,
)
from jointbench.station.gap.structure_plan import StructurePlan, read_plan
from jointbench.station.joints.model_kind import describes_structure
from jointbench.station.joints.structure_model import StructureModel
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.gap_model import nominal_parameters
from jointbench.station.screen.page_parts import Section
from jointbench.station.sources.open_source import is_url

_RESPONSE_UNITS = ("m", "m/s", "m/s^2")
Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class GapRequest:
    """What is asked of a source.

    Attributes:
        model: bench model file, or None.
        without: names of effects to leave out of the catalogue.
        preload: on the joint where the session does not say [N], or None.
        entries: the catalogue of this run.
        curves: whether modes over amplitude are compared with the explanations.
        extended: whether effects beyond the installed catalogue were asked for.
    """

    model: Path | None = None
    without: frozenset[str] = frozenset()
    preload: float | None = None
    entries: tuple[LumpedEffect, ...] = field(default_factory=installed_catalogue)
    curves: bool = False
    extended: bool = False


@dataclass(frozen=True, slots=True)
class Examined:
    """What became of a source.

    Attributes:
        title: of the source, for the report.
        found: verdict and evidence.
        scores: on parts of a long record that no fit has seen.
        unit: of the scores.
        remarks: what was left out, and why, a line each.
        plan: places of a bolted structure, or None.
        sections: further sections of the report, after the verdict.
        simulated: whether a session was.
    """

    title: str
    found: Diagnosis
    scores: tuple[StretchScore, ...] = ()
    unit: str = ""
    remarks: tuple[str, ...] = ()
    plan: StructurePlan | None = None
    sections: tuple[Section, ...] = ()
    simulated: bool = False


def examine(
    sources: Sequence[str], wanted: GapRequest, *, progress: Progress
) -> Examined:
    """Read the sources, whatever they are, and diagnose them.

    Args:
        sources: a campaign file; sessions; a MAT file; a model file that names one of
            these; or the URL of a bench.
        wanted: model and options.
        progress: receives one line per step.

    Raises:
        UsageError: a model is missing, or is given where the source brings its own.
        BadData: a file cannot be used as it is.
    """
    if len(sources) == 1 and is_url(sources[0]):
        return _examine_url(sources[0], wanted, progress)
    if any(is_url(source) for source in sources):
        raise UsageError("a URL is a measurement of its own; give no files with it")
    paths = [Path(source) for source in sources]
    if paths[0].suffix.lower() == ".toml":
        return _examine_named(paths, wanted, progress)
    refuse_twice(paths)
    refuse_frfs(paths, wanted.model)
    if any(path.suffix.lower() == ".mat" for path in paths):
        return _examine_record(paths, wanted, progress)
    if not is_session_name(paths[0]):
        return _examine_surface(paths, wanted, progress)
    if _schema(paths[0]) == HIT_SCHEMA:
        return _examine_hits(paths, wanted, progress)
    if _schema(paths[0]) != SESSION_SCHEMA:
        return _examine_campaign(paths, wanted, progress)
    return _examine_sessions(paths, wanted, progress)


def _schema(path: Path) -> str:
    with open_guarded(path) as file:
        return str(read_attribute(file, "schema"))


def _examine_url(url: str, wanted: GapRequest, progress: Progress) -> Examined:
    """Record a session file from a source, and examine it like any other session."""
    from jointbench.station.sources.recorded_session import record_session_file

    with tempfile.TemporaryDirectory() as folder:
        session = Path(folder) / "session.h5"
        progress("recording the session")
        written = record_session_file(url, session)
        model = wanted.model or written.model
        done = _examine_sessions([session], replace(wanted, model=model), progress)
    return replace(done, title=url)


def _examine_named(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine the files that a model file names."""
    from jointbench.station.gap.level_files import names_levels
    from jointbench.station.joint_states.joint_state_files import names_states

    model = paths[0]
    if names_levels(model):
        return _examine_levels(paths, wanted, progress)
    if names_states(model):
        return _examine_joint(paths, wanted, progress)
    if len(paths) > 1 or wanted.model is not None:
        raise UsageError(
            f"'{model}' is a model file: give it alone, with the sessions it is about "
            "in its [gap] table, or as --model beside them"
        )
    names = _named_data(model)
    if not names:
        raise UsageError(
            f"'{model}' names no data; add sessions = ['session.h5'] to its [gap] "
            f"table, or type: jointbench gap session.h5 --model {model}"
        )
    files = [str(model.parent / name) for name in names]
    return examine(files, replace(wanted, model=model), progress=progress)


def _named_data(model: Path) -> tuple[str, ...]:
    """Return the sessions, or the record, that a model file names."""
    if describes_structure(model):
        return gap_table(read_toml(model, StructureModel)).sessions
    bench = read_toml(model, BenchModel)
    if bench.record is not None and bench.record.file is not None:
        return (*bench.gap.sessions, bench.record.file)
    return bench.gap.sessions


def _examine_levels(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine records at several levels, with a base of modes."""
    from jointbench.analysis.gap.diagnosis.level_diagnosis import diagnose_levels
    from jointbench.station.gap.level_files import read_levels
    from jointbench.station.gap.level_remarks import level_remarks

    if len(paths) > 1 or wanted.model is not None or wanted.preload is not None:
        raise UsageError(
            f"'{paths[0]}' names its records, ports and base: give it alone"
        )
    _refuse_curves(wanted)
    progress("reading the levels")
    given, base = read_levels(paths[0])
    done = diagnose_levels(
        given,
        base,
        without=wanted.without,
        entries=with_real_joints(wanted.entries, (ALL_REAL_JOINTS,)),
        progress=progress,
    )
    return Examined(
        given.name,
        done.found,
        done.scores,
        _RESPONSE_UNITS[int(given.output)],
        level_remarks(given, done),
    )


def _examine_joint(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine a joint over its preload, with a contact law as base."""
    from jointbench.analysis.gap.law_diagnosis.contact_diagnosis import (
        diagnose_contact,
    )
    from jointbench.station.gap.contact_section import contact_sections
    from jointbench.station.gap.loop_section import loop_sections
    from jointbench.station.joint_states.joint_state_files import read_joints

    if wanted.model is not None or wanted.preload is not None:
        raise UsageError(
            f"'{paths[0]}' names its states, facts and contact law: leave --model and "
            "--preload out"
        )
    refuse_twice(paths)
    _refuse_curves(wanted)
    if wanted.extended:
        raise UsageError(
            "--effects and --with do not apply to a joint over its preload"
        )
    progress("reading the states")
    joint = read_joints(paths)
    done = diagnose_contact(
        joint.data, joint.law, without=wanted.without, progress=progress
    )
    return Examined(
        joint.data.name,
        done.found,
        remarks=tuple(one.words for one in joint.loops),
        sections=(*contact_sections(done), *loop_sections(joint.loops)),
    )


def _examine_surface(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine heights, with a self-affine surface as base."""
    from jointbench.station.gap.surface_gap import examine_surface
    from jointbench.station.gap.surface_gap_section import surface_gap_sections

    _refuse_curves(wanted)
    if wanted.extended or wanted.model is not None or wanted.preload is not None:
        raise UsageError(
            f"'{paths[0]}' is no campaign, session (.h5) or record (.mat): as a "
            "surface it takes no model, preload or effects. Bring hits in with "
            "`jointbench import` first"
        )
    done, remarks = examine_surface(paths, without=wanted.without, progress=progress)
    title = ", ".join(path.stem for path in paths)
    return Examined(
        title,
        done.found,
        remarks=remarks,
        sections=surface_gap_sections(done),
    )


def _examine_campaign(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    from jointbench.analysis.gap.diagnosis.diagnose import diagnose
    from jointbench.analysis.gap.intake.read_campaign import read_campaign
    from jointbench.station.gap.measured_curves import curves_of_campaign
    from jointbench.station.gap.session_hits import ANY_LEVEL

    if len(paths) > 1 or wanted.model is not None or wanted.preload is not None:
        raise UsageError(
            f"'{paths[0]}' is no session: a campaign file is given alone, it brings "
            "its own model and preloads"
        )
    campaign = read_campaign(paths[0])
    curves = (
        curves_of_campaign(campaign, ANY_LEVEL, progress) if wanted.curves else None
    )
    found = diagnose(
        campaign,
        without=wanted.without,
        entries=wanted.entries,
        curves=curves,
        progress=progress,
    )
    return Examined(paths[0].stem, found)


def _examine_hits(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine hits on bolted bodies, whose model is nominal parameters."""
    if len(paths) > 1 or wanted.preload is not None:
        raise UsageError(
            f"'{paths[0]}' brings its own torques and is given alone; leave --preload "
            "and other files out"
        )
    _refuse_on_bodies(wanted)
    if wanted.model is not None and describes_structure(wanted.model):
        found, remarks, plan = examine_meshed(
            paths[0], wanted.model, without=wanted.without, progress=progress
        )
        return Examined(paths[0].stem, found, remarks=remarks, plan=plan)
    nominal = wanted.model or nominal_beside(paths[0])
    found, remarks = examine_structure(
        paths[0], nominal, without=wanted.without, progress=progress
    )
    return Examined(paths[0].stem, found, remarks=remarks, plan=read_plan(nominal))


def _examine_record(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    from jointbench.analysis.gap.diagnosis.single_record import diagnose_record
    from jointbench.station.gap.record_campaign import read_record

    if len(paths) > 1:
        raise UsageError("a record is examined alone; give one MAT file")
    bench = _model(paths[0], wanted)
    _refuse_curves(wanted)
    if wanted.preload is not None:
        raise UsageError("--preload belongs to sessions; a record has none")
    record = read_record(paths[0], bench)
    found, scores = diagnose_record(
        record.record,
        record.training,
        record.scored,
        record.nominal,
        without=wanted.without,
        entries=wanted.entries,
        progress=progress,
    )
    return Examined(
        paths[0].stem,
        record.in_stand_ins(found),
        record.in_unit(scores),
        record.unit,
        record.remarks,
    )


def _examine_sessions(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    from jointbench.station.gap.measured_curves import curves_of_recordings
    from jointbench.station.gap.session_hits import (
        ANY_LEVEL,
        judged_recordings,
        with_preloads,
    )
    from jointbench.station.pipeline.joint_stages import gap_of

    bolted = wanted.model is not None and describes_structure(wanted.model)
    nominal = None if bolted else nominal_parameters(_model(paths[0], wanted))
    sessions = [read_session(path) for path in paths]
    sessions.sort(key=lambda session: session.created)
    remarks: list[str] = []
    stored = [
        pair for session in sessions for pair in with_preloads(session, wanted.preload)
    ]
    recordings = judged_recordings(stored, remarks)
    if not recordings:
        names = ", ".join(path.name for path in paths)
        raise BadData(f"no recording with a hit in {names}; see `jointbench inspect`")
    title = ", ".join(path.stem for path in paths)
    simulated = any(session.simulated for session in sessions)
    if nominal is None:
        done = _examine_bolted(title, recordings, wanted, progress)
        return replace(done, remarks=(*remarks, *done.remarks), simulated=simulated)
    curves = None
    if wanted.curves:
        curves = curves_of_recordings(
            recordings, nominal.preload_reference, ANY_LEVEL, progress
        )
    found, left_out = gap_of(
        title,
        recordings,
        nominal,
        without=wanted.without,
        entries=wanted.entries,
        curves=curves,
        progress=progress,
    )
    return Examined(title, found, remarks=(*remarks, *left_out), simulated=simulated)


def _examine_bolted(
    title: str, recordings: list[Recording], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine hits of sessions with a model of meshed bodies."""
    _refuse_on_bodies(wanted)
    found, remarks, plan = examine_recordings(
        title,
        recordings,
        wanted.model or Path(),
        without=wanted.without,
        progress=progress,
    )
    return Examined(title, found, remarks=remarks, plan=plan)


def _refuse_on_bodies(wanted: GapRequest) -> None:
    """Raise `UsageError` for options that do not apply to bolted bodies."""
    if wanted.curves or wanted.extended:
        raise UsageError(
            "--curves, --effects and --with do not apply to bolted bodies; leave them "
            "out"
        )


def _refuse_curves(wanted: GapRequest) -> None:
    if wanted.curves:
        raise UsageError(
            "--curves needs the decays after hits, and driven records have none; leave "
            "it out"
        )


def _model(path: Path, wanted: GapRequest) -> BenchModel:
    if wanted.model is None:
        raise UsageError(
            f"'{path}' holds data but no model; give the bench's with --model "
            "bench.toml"
        )
    return read_toml(wanted.model, BenchModel)
