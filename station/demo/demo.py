# SPDX-License-Identifier: MIT
"""``jointbench demo``: the whole main job on the embedded simulated bench."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.recordings import Verdict
from jointbench.acquisition.session_file.overwrite_guard import require_replaceable
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.analysis.lumped.identified import identification_json
from jointbench.simulators.rough_surfaces.surface_files import DATE
from jointbench.station.commands.identify.identify_links_command import show_joint
from jointbench.station.commands.surface_command import show_surfaces
from jointbench.station.demo.demo_bench import DemoSession, record_demo_session
from jointbench.station.demo.demo_gap import FILES as GAP_FILES
from jointbench.station.demo.demo_gap import (
    DemoGap,
    gap_json,
    gap_sections,
    session_for_gap,
    show_gap,
)
from jointbench.station.demo.demo_truth import compare_with_truth
from jointbench.station.files.output_paths import (
    check_folder,
    check_outputs,
    require_mark,
    write_text,
)
from jointbench.station.files.toml_file import read_toml
from jointbench.station.pipeline.contact_prediction import contact_json
from jointbench.station.pipeline.modal_notes import modal_notes
from jointbench.station.pipeline.modal_summary import modal_json
from jointbench.station.pipeline.surface_json import surface_json
from jointbench.station.report.gap_sentences import headline
from jointbench.station.report.joint_section import side_by_side
from jointbench.station.report.modal_table import show_modal
from jointbench.station.report.session_analysis import SessionAnalysis, analyse_session
from jointbench.station.report.session_report import compose, joint_link
from jointbench.station.results.results_file import results_path, write_results
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import DataTable, Section
from jointbench.station.screen.terminal import console, table, working, write_json
from jointbench.station.screen.truth_table import TruthComparison, as_json

EXIT_QUALITY = 5
FILES = (
    "bench.toml",
    "face-a.csv",
    "face-b.csv",
    *GAP_FILES,
    "report.html",
    "session.h5",
    "session.results.h5",
    "summary.json",
)
"""All that the demo makes; it overwrites these and nothing else."""
MODEL_FILE = """\
# The demo's two-body bench: weighed masses, unknown links.
[bodies.base]
mass = "{base:.6g} kg"
mass_sd = "{base_sd:.2g} kg"
channel = "a0"

[bodies.top]
mass = "{top:.6g} kg"
mass_sd = "{top_sd:.2g} kg"
channel = "a1"

[links.support]
between = ["ground", "base"]

[links.joint]
between = ["base", "top"]

# Marble on marble, as in Zhou et al. 2025: 55 GPa and 0.25 for either plate.
[contact]
link = "joint"
preload = "{preload:.6g} N"
modulus = "29.33 GPa"
hardness = "1.5 GPa"
poisson = 0.25
"""


def run_demo(out: Path, *, seed: int, json_target: str | None) -> int:
    """Measure, identify and report a joint on the simulated bench.

    A second session, on a bench with a hidden effect, shows what the model lacks.

    Args:
        out: folder for session, results, model, report and summary.
        seed: of the bench.
        json_target: where the summary goes besides ``summary.json``.

    Returns:
        0, or 5 if an estimate misses the truth by more than the demo allows.
    """
    check_folder(out, FILES)
    require_demo(out)
    check_outputs([], [json_target])
    out.mkdir(parents=True, exist_ok=True)
    screen = console(json_target)
    with working("measuring two surfaces and twelve hits on the simulated bench"):
        recorded = record_demo_session(out, seed=seed)
    session_file = out / "session.h5"
    write_session(recorded.session, session_file, overwrite=True)
    model_file = _write_model(out / "bench.toml", recorded)
    # From here on everything comes from the files, as it would for any user's own.
    bench = read_toml(model_file, BenchModel)
    analysis = analyse_session(read_session(session_file), bench)
    with working("second session: diagnosing the gap between model and measurement"):
        gap = session_for_gap(out, seed=seed)
    comparisons = (*compare_with_truth(recorded.truth, analysis), *gap.comparisons)
    _show(analysis, bench, json_target)
    show_gap(gap, json_target)
    content = truth_table(comparisons)
    screen.print(table(content.caption, content.columns, content.rows))
    summary = _summary(analysis, bench, comparisons, gap, seed)
    _write_files(out, session_file, analysis, bench, comparisons, gap, summary)
    write_json(json_target, summary)
    screen.print(f"\nreport: {out / 'report.html'}   summary: {out / 'summary.json'}")
    return 0 if all(c.passed for c in comparisons) else EXIT_QUALITY


def require_demo(out: Path) -> None:
    """Refuse a folder in which files of the demo's names are somebody's own.

    Raises:
        UsageError: a session in it is none, is being recorded, or is of a real bench;
            a model or a table of heights is none of the demo's.
    """
    require_mark(out / "bench.toml", MODEL_FILE.partition("\n")[0].encode(), "demo")
    for name in ("face-a.csv", "face-b.csv"):
        require_mark(out / name, DATE.encode(), "demo")
    for path in (out / "session.h5", out / GAP_FILES[0]):
        require_replaceable(path)
        if path.exists() and not read_session(path).simulated:
            raise UsageError(f"'{path}' was made by no demo; name another folder")


def _write_model(path: Path, recorded: DemoSession) -> Path:
    text = MODEL_FILE.format(
        base=recorded.masses["base"],
        top=recorded.masses["top"],
        base_sd=recorded.mass_sds["base"],
        top_sd=recorded.mass_sds["top"],
        preload=recorded.truth.bench.preload,
    )
    write_text(path, text)
    return path


def _show(
    analysis: SessionAnalysis, bench: BenchModel, json_target: str | None
) -> None:
    screen = console(json_target)
    if analysis.modal is not None:
        show_modal(analysis.modal, modal_notes(analysis.modal), json_target)
    show_surfaces(analysis.surfaces, json_target)
    if analysis.joint is not None:
        show_joint(analysis.joint, json_target)
    if analysis.contact is not None:
        sentence = side_by_side(analysis.contact, analysis.joint, joint_link(bench))
        screen.print(sentence, markup=False)
    for remark in analysis.remarks:
        screen.print(remark, markup=False)


def truth_table(comparisons: tuple[TruthComparison, ...]) -> DataTable:
    """Return truth and estimate side by side as a table."""
    rows = tuple(
        (
            c.quantity,
            c.unit,
            f"{c.truth:.6g}",
            "-" if c.estimate is None else f"{c.estimate:.6g}",
            "-" if c.sd is None else f"{c.sd:.2g}",
            _error(c, c.error),
            _error(c, c.limit),
            "ok" if c.passed else "missed",
        )
        for c in comparisons
    )
    return DataTable(
        "Simulated truth and estimates",
        ("quantity", "unit", "truth", "estimate", "sd", "error", "allowed", "verdict"),
        rows,
        frozenset({"missed"}),
    )


def _error(comparison: TruthComparison, error: float | None) -> str:
    if error is None:
        return "-"
    return f"{error:.3g}" if comparison.absolute else f"{100 * error:.3g} %"


def _write_files(
    out: Path,
    session_file: Path,
    analysis: SessionAnalysis,
    bench: BenchModel,
    comparisons: tuple[TruthComparison, ...],
    gap: DemoGap,
    summary: Mapping[str, object],
) -> None:
    if analysis.modal is not None:
        write_results(results_path(session_file), analysis.modal, [session_file])
    section = Section("truth", "Truth and estimate", (truth_table(comparisons),))
    page = compose(
        analysis, bench, title="Two bodies on a bolted joint", extra=(section,)
    )
    met = sum(one.passed for one in comparisons)
    findings = (
        f"{met} of {len(comparisons)} estimates are within their limits of the "
        "simulated truth.",
        *page.findings,
        f"Second session, a model that lacks an effect: {headline(gap.found)}.",
    )
    page = replace(
        page, sections=(*page.sections, *gap_sections(gap)), findings=findings
    )
    write_report(page, out / "report.html")
    write_json(str(out / "summary.json"), summary)


def _summary(
    analysis: SessionAnalysis,
    bench: BenchModel,
    comparisons: tuple[TruthComparison, ...],
    gap: DemoGap,
    seed: int,
) -> Mapping[str, object]:
    summary: dict[str, object] = {
        "seed": seed,
        "simulated": True,
        "passed": all(c.passed for c in comparisons),
        "comparisons": as_json(comparisons),
        "remarks": list(analysis.remarks),
        "surfaces": [surface_json(chain) for chain in analysis.surfaces],
        "gap": gap_json(gap),
    }
    if analysis.modal is not None:
        summary["modal"] = modal_json(analysis.modal, modal_notes(analysis.modal))
        summary["accepted_hits"] = sum(
            hit.verdict is Verdict.OK
            for recording in analysis.modal.recordings
            for hit in recording.hits
        )
    if analysis.contact is not None:
        curve = (analysis.contact.at, *analysis.contact.curve)
        summary["contact"] = contact_json(curve, analysis.contact.surface)
    if analysis.joint is not None:
        summary["joint"] = identification_json(analysis.joint)
        summary["joint_link"] = joint_link(bench)
    return summary
