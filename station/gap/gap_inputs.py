# SPDX-License-Identifier: MIT
"""Whatever `gap` is given (campaign, sessions, a long record, a URL), examined.

What only one kind of source needs is imported where it is read: a source of another
kind began 0.7 s later.
"""

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.session_file.store import SESSION_SCHEMA
from jointbench.analysis.gap.catalogue.catalogue import (
    ALL_REAL_JOINTS,
    with_real_joints,
)
from jointbench.analysis.gap.intake.read_hit_campaign import HIT_SCHEMA
from jointbench.station.files.input_files import is_session_name, refuse_twice
from jointbench.station.files.toml_file import read_toml
from jointbench.station.gap.frf_levels import refuse_frfs
from jointbench.station.gap.gap_request import (
    Examined,
    GapRequest,
    Progress,
    refuse_curves,
    refuse_on_bodies,
)
from jointbench.station.gap.structure_plan import read_plan
from jointbench.station.joints.model_kind import describes_structure
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.sources.open_source import is_url

_RESPONSE_UNITS = ("m", "m/s", "m/s^2")


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
        from jointbench.station.gap.lumped_inputs import examine_record

        return examine_record(paths, wanted, progress)
    if not is_session_name(paths[0]):
        return _examine_surface(paths, wanted, progress)
    schema = _schema(paths[0])
    if schema == HIT_SCHEMA:
        return _examine_hits(paths, wanted, progress)
    if schema == SESSION_SCHEMA:
        return _examine_sessions(paths, wanted, progress)
    from jointbench.station.gap.lumped_inputs import examine_campaign

    return examine_campaign(paths, wanted, progress)


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
        from jointbench.station.gap.meshed_inputs import sessions_of

        return sessions_of(model)
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
    refuse_curves(wanted)
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
    refuse_curves(wanted)
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

    refuse_curves(wanted)
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


def _examine_hits(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine hits on bolted bodies, with nominal parameters or meshed bodies."""
    if len(paths) > 1 or wanted.preload is not None:
        raise UsageError(
            f"'{paths[0]}' brings its own torques and is given alone; leave --preload "
            "and other files out"
        )
    refuse_on_bodies(wanted)
    model = wanted.model
    if model is not None and describes_structure(model):
        from jointbench.station.gap.meshed_inputs import examine_meshed_campaign

        return examine_meshed_campaign(paths[0], model, wanted, progress)
    from jointbench.station.gap.structure_files import examine_structure, nominal_beside

    nominal = model or nominal_beside(paths[0])
    found, remarks = examine_structure(
        paths[0], nominal, without=wanted.without, progress=progress
    )
    return Examined(paths[0].stem, found, remarks=remarks, plan=read_plan(nominal))


def _examine_sessions(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine the hits of sessions, on meshed bodies or on a lumped bench."""
    if wanted.model is not None and describes_structure(wanted.model):
        refuse_on_bodies(wanted)
        from jointbench.station.gap.meshed_inputs import examine_meshed_sessions

        return examine_meshed_sessions(paths, wanted.model, wanted, progress)
    from jointbench.station.gap.lumped_inputs import examine_sessions

    return examine_sessions(paths, wanted, progress)
