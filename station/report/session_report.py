# SPDX-License-Identifier: MIT
"""``jointbench report``: one offline HTML report about a session."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.basics.registry import Registry
from jointbench.acquisition.records.provenance import Step
from jointbench.acquisition.session_file.open_session import open_session
from jointbench.analysis.contact.model_catalogue import contact_law_package
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.toml_file import read_toml
from jointbench.station.pipeline.recordings_by_preload import at_words
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.report.figures.torque_trends import trends_section
from jointbench.station.report.findings.session_findings import session_findings
from jointbench.station.report.findings.session_tiles import session_tiles
from jointbench.station.report.frf_analysis import (
    analyse_frfs,
    is_frf_input,
    report_path,
)
from jointbench.station.report.hits_section import hits_section
from jointbench.station.report.joint_section import joint_section
from jointbench.station.report.modal_section import modal_sections
from jointbench.station.report.report_sections import (
    REPORT_SECTIONS_GROUP,
    ReportSection,
    SessionView,
    made_sections,
    section_fault,
)
from jointbench.station.report.session_analysis import SessionAnalysis, analyse_session
from jointbench.station.report.surface_section import surface_section
from jointbench.station.results.results_beside import stored_results
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.geometry_file import (
    Geometry,
    geometry_beside_frfs,
    read_geometry,
)
from jointbench.station.screen.page import placed_sections, write_report
from jointbench.station.screen.page_parts import (
    DataTable,
    ItemGroup,
    Report,
    Section,
    Text,
)
from jointbench.station.screen.terminal import console, write_json

LONGEST_DETAIL = 300


def run_report(
    session: Path,
    *,
    out: Path | None,
    model: Path | None,
    geometry: Path | None = None,
    results: Path | None = None,
    json_target: str | None,
    run: StageRun | None = None,
) -> Path:
    """Write the report of `session` next to it, or to `out`, and name it.

    See `session_page`.
    """
    target = out or report_path(session)
    given = (session, model, geometry, results)
    read = [path for path in given if path is not None]
    check_outputs(read, [target, json_target])
    page, analysis = session_page(
        session, model=model, geometry=geometry, results=results, run=run
    )
    write_report(page, target)
    console(json_target).print(f"report: {target}")
    runs = [
        {"preload_n": one.preload, "results": one.run or None}
        for one in analysis.preloads
    ]
    content_json = {
        "report": str(target),
        "remarks": list(analysis.remarks),
        "modes": runs,
    }
    write_json(json_target, content_json)
    return target


def session_page(
    session: Path,
    *,
    model: Path | None = None,
    geometry: Path | None = None,
    results: Path | None = None,
    run: StageRun | None = None,
) -> tuple[Report, SessionAnalysis]:
    """Analyse a session and arrange the result as a report.

    Modes come from existing results, see `stored_results`; without results they are
    extracted now, and `run` stores the stages. A file of FRFs, or results made of
    some, is reported as well.
    """
    points = None if geometry is None else read_geometry(geometry)
    bench = None if model is None else read_toml(model, BenchModel)
    if is_frf_input(session):
        analysis = analyse_frfs(session, results, run)
        points = points or geometry_beside_frfs(session)
    else:
        content = open_session(session)
        stored = stored_results(session, content.recordings, results)
        analysis = analyse_session(content, bench, stored, run)
    page = compose(analysis, bench, title=session.stem, geometry=points)
    return page, analysis


def compose(
    analysis: SessionAnalysis,
    bench: BenchModel | None,
    *,
    title: str,
    extra: tuple[Section, ...] = (),
    geometry: Geometry | None = None,
) -> Report:
    """Arrange an analysis as a report; `extra` sections come first.

    Shapes are drawn on the `geometry`, or on a row of points without one.
    """
    session, view = analysis.session, SessionView(analysis, bench, geometry)
    sections = list(extra)
    entries = REPORT_SECTIONS.entries()
    for entry in entries:
        sections += made_sections(entry, view)
    added = [(e.value.name, e.package) for e in entries if not e.built_in]
    sections.append(_provenance(analysis, added))
    return Report(
        title=title,
        lead=_lead(analysis),
        software=session.software,
        simulated=session.simulated,
        tiles=session_tiles(analysis, joint_link(bench)),
        sections=tuple(sections),
        findings=session_findings(analysis, joint_link(bench)),
    )


def _remarks(view: SessionView) -> list[Section]:
    notes = tuple(Text(remark, "notice") for remark in view.analysis.remarks)
    return [Section("remarks", "Remarks", notes)] if notes else []


def _hits(view: SessionView) -> list[Section]:
    recordings = view.analysis.recordings
    return [hits_section(recordings)] if recordings else []


def _modes(view: SessionView) -> list[Section]:
    preloads = view.analysis.preloads
    several = len(preloads) > 1
    return [
        section
        for one in preloads
        for section in placed_sections(
            modal_sections(one.modal, view.geometry),
            at_words(one.preload) if several else "",
        )
    ]


def _surfaces(view: SessionView) -> list[Section]:
    surfaces = view.analysis.surfaces
    return [surface_section(surfaces)] if surfaces else []


def _joint(view: SessionView) -> list[Section]:
    """Return one section for each preload with identified links."""
    analysis, link = view.analysis, joint_link(view.bench)
    if analysis.contact is None and analysis.joint is None:
        return []
    known = [one for one in analysis.preloads if one.joint is not None]
    if len(known) < 2:
        return [joint_section(analysis.contact, analysis.joint, link)]
    return [
        section
        for one in known
        for section in placed_sections(
            (joint_section(analysis.contact, one.joint, link),), at_words(one.preload)
        )
    ]


def joint_link(bench: BenchModel | None) -> str:
    """Return the link of the contact law, else the last link."""
    if bench is None:
        return ""
    return bench.contact.link if bench.contact else list(bench.links)[-1]


def _lead(analysis: SessionAnalysis) -> str:
    session = analysis.session
    parts = [session.notes]
    for word, text in (
        ("Recorded", session.created),
        ("Source", session.source),
        ("Operator", session.operator),
        ("Session", session.uuid),
    ):
        parts += [f"{word} {text}"] if text or word == "Source" else []
    return ". ".join(part.rstrip(".") for part in parts if part) + "."


def _trends(view: SessionView) -> list[Section]:
    section = trends_section(view.analysis.preloads)
    return [] if section is None else [section]


_SECTIONS = (
    ReportSection("remarks", _remarks),
    ReportSection("hits", _hits),
    ReportSection("trends", _trends),
    ReportSection("modes", _modes),
    ReportSection("surfaces", _surfaces),
    ReportSection("joint", _joint),
)
REPORT_SECTIONS = Registry(
    REPORT_SECTIONS_GROUP,
    "report section",
    ReportSection,
    lambda: _SECTIONS,
    fault=section_fault,
)
"""The sections of a report in their order; those of other packages follow."""


def _provenance(
    analysis: SessionAnalysis, added: Sequence[tuple[str, str]] = ()
) -> Section:
    records = [*analysis.session.recordings, *analysis.session.surfaces]
    rows = [
        (record.name, step.name, _detail(step))
        for record in records
        for step in record.provenance
    ]
    for one in analysis.preloads:
        of = f"modes{at_words(one.preload)}" if len(analysis.preloads) > 1 else "modes"
        run = one.run or "found for this report, with settings chosen by the data"
        rows.append((of, "run", run))
        rows += [(of, step.name, _detail(step)) for step in one.modal.provenance]
    for chain in analysis.surfaces:
        rows += [
            (f"{chain.surface.name}, fit", step.name, _detail(step))
            for step in chain.fit.provenance
        ]
    if analysis.contact is not None:
        law = analysis.contact.at.state.model
        rows.append(("contact", law, f"package {contact_law_package(law)}"))
    rows += [("report", f"section {name}", f"package {p}") for name, p in added]
    steps = tuple(dict.fromkeys(rows))
    table = DataTable(
        "Every step from the instrument to the numbers above.",
        ("of", "step", "detail"),
        steps,
    )
    fold = ItemGroup(f"{len(steps)} steps from the instrument to the numbers", (table,))
    return Section("provenance", "Provenance", (fold,))


def _detail(step: Step) -> str:
    text = ", ".join(
        f"{key} {value:.6g}" if isinstance(value, float) else f"{key} {value}"
        for key, value in step.detail
    )
    return text if len(text) <= LONGEST_DETAIL else text[: LONGEST_DETAIL - 3] + "..."
