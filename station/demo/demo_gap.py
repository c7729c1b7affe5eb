# SPDX-License-Identifier: MIT
"""The demo's second visit: levels, points and preloads, and a hidden effect.

The records go the way of any bench's own: session file, model file, gap engine. What
is hidden comes from the file beside them, after the verdict.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Finding,
    diagnosis_json,
)
from jointbench.analysis.gap.response.threads import side_by_side
from jointbench.station.gap.gap_inputs import GapRequest, examine
from jointbench.station.gap.gap_output import show_diagnosis
from jointbench.station.report.gap_report import gap_report
from jointbench.station.screen.page_parts import DataTable, Section
from jointbench.station.screen.terminal import console, table
from jointbench.station.screen.truth_table import TruthComparison, compare_value
from jointbench.station.sources.visit_file import write_visit

_HIDDEN = "cubic_stiffness"
_GRID = "small"
"""Eight hits: two points, three levels, two preloads, one condition twice."""
_PARAMETER_LIMIT = 0.03
_SECTIONS_SHOWN = 3
FILES = ("gap-session.h5", "gap-session.toml", "gap-session.truth.json")
"""All that this step leaves in the demo's folder."""


@dataclass(frozen=True, slots=True, eq=False)
class DemoGap:
    """What the gap engine made of the second visit, beside the truth.

    Attributes:
        found: verdict and evidence.
        truth: what was hidden, as its file has it.
        comparisons: parameters of the hidden effect, and whether it was named.
    """

    found: Diagnosis
    truth: Mapping[str, Any]
    comparisons: tuple[TruthComparison, ...]


def visit_for_gap(folder: Path, *, seed: int) -> DemoGap:
    """Record the second visit, find what its model misses, and compare.

    Args:
        folder: where session, model, truth and page go.
        seed: of the bench.
    """
    url = f"sim:two-body-campaign?seed={seed}&hide={_HIDDEN}&grid={_GRID}"
    written = write_visit(url, folder / FILES[0], overwrite=True)
    wanted = GapRequest(model=written.model)
    with side_by_side():
        done = examine([str(written.path)], wanted, progress=lambda line: None)
    truth = json.loads((folder / FILES[2]).read_text(encoding="utf-8"))
    return DemoGap(done.found, truth, _compare(done.found, truth))


def _compare(found: Diagnosis, truth: Mapping[str, Any]) -> tuple[TruthComparison, ...]:
    site = truth["sites"][_HIDDEN]
    named = {(e.name, e.site): e for e in found.effects}
    effect = named.get((_HIDDEN, site))
    right = found.verdict is Finding.NAMED and len(named) == 1 and effect is not None
    rows = [
        compare_value(
            f"gap[{_HIDDEN}@{site}]", "-", 1.0, float(right), limit=0.0, absolute=True
        )
    ]
    estimates = {} if effect is None else {p.name: p for p in effect.parameters}
    for name, value in truth["effects"][_HIDDEN].items():
        one = estimates.get(name)
        rows.append(
            compare_value(
                f"gap.{name}",
                "-" if one is None else one.unit,
                value,
                None if one is None else one.value,
                sd=None if one is None else one.sd,
                limit=_PARAMETER_LIMIT,
            )
        )
    return tuple(rows)


def show_gap(gap: DemoGap, json_target: str | None) -> None:
    """Print the verdict on the second visit and what was hidden in it."""
    screen = console(json_target)
    screen.print("\nSecond visit: what does the model miss?", style="bold")
    show_diagnosis(gap.found, json_target)
    content = _hidden_table(gap)
    screen.print(table(content.caption, content.columns, content.rows))


def _hidden_table(gap: DemoGap) -> DataTable:
    """Return what was hidden beside what was named."""
    named = ", ".join(f"{e.name} at {e.site}" for e in gap.found.effects) or "-"
    rows = tuple(
        (f"{name} at {gap.truth['sites'][name]}", gap.found.verdict.value, named)
        for name in gap.truth["effects"]
    )
    return DataTable("Hidden and found", ("hidden", "verdict", "named"), rows)


def gap_sections(gap: DemoGap) -> tuple[Section, ...]:
    """Return the step's sections for the demo's page."""
    page = gap_report(gap.found, title="the second visit")
    evidence = [section for section in page.sections if section.items][:_SECTIONS_SHOWN]
    return (
        Section("gap", "What the model misses", (_hidden_table(gap),)),
        *(replace(section, anchor=f"gap-{section.anchor}") for section in evidence),
    )


def gap_json(gap: DemoGap) -> dict[str, object]:
    """Return verdict and truth as the summary has them."""
    return {
        **diagnosis_json(gap.found),
        "truth": {
            "effects": dict(gap.truth["effects"]),
            "sites": dict(gap.truth["sites"]),
        },
    }
