# SPDX-License-Identifier: MIT
"""``jointbench demo --plates``: a bolt left loose on two plates, found from hits."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Finding,
    diagnosis_json,
)
from jointbench.simulators.flexible.flexible_campaign import make_flexible_campaign
from jointbench.simulators.flexible.flexible_url import bench_of_flexible_url
from jointbench.simulators.flexible.write_flexible import (
    flexible_truth,
    known_bench,
    write_hits,
)
from jointbench.station.demo.demo import EXIT_QUALITY, truth_table
from jointbench.station.files.output_paths import (
    check_folder,
    check_outputs,
    write_text,
)
from jointbench.station.gap.gap_inputs import examine
from jointbench.station.gap.gap_output import show_diagnosis
from jointbench.station.gap.gap_request import Examined, GapRequest
from jointbench.station.gap.structure_plan import with_structure
from jointbench.station.report.gap_report import gap_report
from jointbench.station.screen.page import write_report
from jointbench.station.screen.terminal import console, table, working, write_json
from jointbench.station.screen.truth_table import (
    TruthComparison,
    as_json,
    compare_value,
)

HIDDEN = "loose_bolt"
FILES = (
    "plates.h5",
    "plates.sheet.json",
    "plates.truth.json",
    "plates-report.html",
    "plates-summary.json",
)
"""All that this demo makes; it overwrites these and nothing else."""
_FACTOR_LIMIT = 0.1


def run_demo_plates(out: Path, *, seed: int, json_target: str | None) -> int:
    """Strike two plates on bolts, one of them loose, and find that bolt.

    Args:
        out: folder for hits, nominal parameters, truth, report and summary.
        seed: of the bench.
        json_target: where the summary goes besides ``plates-summary.json``.

    Returns:
        0, or 5 if another bolt, effect or factor is named.

    Raises:
        UsageError: a file of these names is somebody's own.
    """
    check_folder(out, FILES)
    check_outputs([], [json_target])
    _require_own(out)
    out.mkdir(parents=True, exist_ok=True)
    with working("striking two bolted plates, one bolt loose"):
        truth = _record(out, seed)
    with working("seeking what the model of the plates lacks"):
        done = examine([str(out / FILES[0])], GapRequest(), progress=lambda line: None)
    comparisons = _compare(done.found, truth)
    screen = console(json_target)
    show_diagnosis(done.found, json_target)
    content = truth_table(comparisons)
    screen.print(table(content.caption, content.columns, content.rows))
    _write(out, done, comparisons, truth, json_target)
    screen.print(f"\nreport: {out / FILES[3]}   summary: {out / FILES[4]}")
    return 0 if all(c.passed for c in comparisons) else EXIT_QUALITY


def _require_own(out: Path) -> None:
    """Refuse a folder whose truth is none of this demo's."""
    hits, truth = out / FILES[0], out / FILES[2]
    if hits.exists() and not truth.exists():
        raise UsageError(
            f"'{hits}' is there already and no campaign of the demo; choose another "
            "folder with --out"
        )


def _record(out: Path, seed: int) -> dict[str, Any]:
    """Write hits, nominal parameters and truth; return the truth."""
    bench = bench_of_flexible_url(f"sim:bolted-plates?seed={seed}&hide={HIDDEN}")
    write_hits(make_flexible_campaign(bench), out / FILES[0])
    truth = flexible_truth(bench)
    for name, content in ((FILES[1], known_bench(bench)), (FILES[2], truth)):
        write_text(out / name, json.dumps(content, indent=1) + "\n")
    return truth


def _compare(found: Diagnosis, truth: dict[str, Any]) -> tuple[TruthComparison, ...]:
    site = f"bolt:{truth['where'][HIDDEN]['bolt']}"
    named = {(e.name, e.site): e for e in found.effects}
    effect = named.get((HIDDEN, site))
    right = found.verdict is Finding.NAMED and len(named) == 1 and effect is not None
    factor = None if effect is None else effect.parameters[0]
    return (
        compare_value(
            f"gap[{HIDDEN}@{site}]", "-", 1.0, float(right), limit=0.0, absolute=True
        ),
        compare_value(
            "gap.factor",
            "-",
            truth["effects"][HIDDEN]["factor"],
            None if factor is None else factor.value,
            sd=None if factor is None else factor.sd,
            limit=_FACTOR_LIMIT,
        ),
    )


def _write(
    out: Path,
    done: Examined,
    comparisons: tuple[TruthComparison, ...],
    truth: dict[str, Any],
    json_target: str | None,
) -> None:
    """Write report and summary."""
    report = gap_report(done.found, title="two bolted plates")
    report = replace(report, simulated=True)
    write_report(with_structure(report, done.plan, done.found), out / FILES[3])
    summary = {
        "comparisons": as_json(comparisons),
        "gap": diagnosis_json(done.found),
        "truth": {key: truth[key] for key in ("effects", "where")},
        "remarks": list(done.remarks),
    }
    write_text(out / FILES[4], json.dumps(summary, indent=1) + "\n")
    write_json(json_target, summary)
