# SPDX-License-Identifier: MIT
"""``jointbench gap``: the effect that a model lacks to explain a measurement."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from jointbench.analysis.gap.catalogue.installed_effects import (
    effect_packages,
)
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, diagnosis_json
from jointbench.analysis.gap.response.threads import side_by_side
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.gap.curve_section import curve_section
from jointbench.station.gap.gap_inputs import examine
from jointbench.station.gap.gap_options import gap_request
from jointbench.station.gap.gap_output import show_diagnosis
from jointbench.station.gap.gap_request import Examined
from jointbench.station.gap.gap_scores import score_section, score_table, scores_json
from jointbench.station.gap.structure_plan import with_structure
from jointbench.station.report.gap_report import gap_report
from jointbench.station.report.packages_section import packages_section
from jointbench.station.screen.escaping_console import Screen, seen
from jointbench.station.screen.page import write_report
from jointbench.station.screen.terminal import console, table, write_json
from jointbench.station.sources.open_source import is_url

MOST_REMARKS = 5


def run_gap(
    source: Path | str | Sequence[Path | str],
    *,
    model: Path | None = None,
    preload: str | None = None,
    without: str | None,
    effects: Sequence[Path | str] = (),
    curves: bool = False,
    report: Path | None,
    json_target: str | None,
) -> Diagnosis:
    """Diagnose a source, show verdict and evidence, and write the report if asked.

    Args:
        source: campaign file, session, MAT file, model file that names data, or URL;
            several sessions of the same bench.
        model: bench model, where the source has none.
        preload: on the joint with unit, where the session gives none.
        without: names of effects to leave out of the catalogue, joined by commas.
        effects: further ones: files of the user's own effects, run as Python, and
            names of laws of real joints.
        curves: whether modes over amplitude are compared with the explanations.
        report: HTML report to write, or None.
        json_target: where the JSON goes.
    """
    given = [source] if isinstance(source, Path | str) else source
    sources = [str(one) for one in given]
    files = [Path(name) for name in sources if not is_url(name)]
    owned = [one for one in effects if isinstance(one, Path)]
    check_outputs([*files, *owned, *([model] if model else [])], [report, json_target])
    wanted = gap_request(
        model=model, preload=preload, without=without, effects=effects, curves=curves
    )
    packages = effect_packages(wanted.entries)
    screen = Screen(stderr=True)
    with side_by_side(), screen.status(seen(f"reading {sources[0]}")) as status:
        done = examine(sources, wanted, progress=lambda line: status.update(seen(line)))
    _show(done, packages, json_target)
    if report is not None:
        content = gap_report(done.found, title=done.title, simulated=done.simulated)
        content = with_structure(content, done.plan, done.found)
        content = replace(content, sections=(*done.sections, *content.sections))
        if done.scores:
            section = score_section(done.scores, done.unit)
            content = replace(content, sections=(*content.sections, section))
        if done.found.curves is not None:
            section = curve_section(done.found.curves)
            content = replace(content, sections=(*content.sections, section))
        if packages:
            section = packages_section(packages)
            content = replace(content, sections=(*content.sections, section))
        write_report(content, report)
        console(json_target).print(f"\nreport: {report}", soft_wrap=True)
    write_json(json_target, _json(sources, done, packages))
    return done.found


def _show(done: Examined, packages: Mapping[str, str], json_target: str | None) -> None:
    show_diagnosis(done.found, json_target)
    screen = console(json_target)
    if done.scores:
        content = score_table(done.scores, done.unit)
        screen.print(table(content.caption, content.columns, content.rows))
    for name, package in packages.items():
        screen.print(f"note: effect {name} is from package {package}")
    for remark in done.remarks[:MOST_REMARKS]:
        screen.print(f"note: {remark}")
    if len(done.remarks) > MOST_REMARKS:
        screen.print(
            f"note: {len(done.remarks) - MOST_REMARKS} more notes; use --json for all"
        )


def _json(
    sources: Sequence[str], done: Examined, packages: Mapping[str, str]
) -> dict[str, object]:
    return {
        "campaign": sources[0],
        "sources": list(sources),
        **diagnosis_json(done.found),
        "scored": scores_json(done.scores, done.unit),
        "remarks": list(done.remarks),
        "packages": dict(packages),
    }
