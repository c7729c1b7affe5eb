# SPDX-License-Identifier: MIT
"""The demo's second session: levels, points, preloads, and a hidden effect.

The records take the usual path: session file, model file, gap engine. The truth is
read from its own file after the verdict.
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
from jointbench.station.gap.gap_inputs import examine
from jointbench.station.gap.gap_output import show_diagnosis
from jointbench.station.gap.gap_request import GapRequest
from jointbench.station.report.gap_report import gap_report
from jointbench.station.screen.page_parts import DataTable, Section
from jointbench.station.screen.terminal import console, table
from jointbench.station.screen.truth_table import TruthComparison, compare_value
from jointbench.station.sources.recorded_session import record_session_file

_HIDDEN = "cubic_stiffness"
_GRID = "small"
"""Eight hits: two points, three levels, two preloads, one condition twice."""
_PARAMETER_LIMIT = 0.03
_SECTIONS_SHOWN = 3
FILES = ("gap-session.h5", "gap-session.toml", "gap-session.truth.json")
"""Files that this step writes into the demo's folder."""


@dataclass(frozen=True, slots=True, eq=False)
class DemoGap:
    """Diagnosis of the second session, compared with the truth.

    Attributes:
        found: verdict and evidence.
        truth: the hidden effect, as in its file.
        comparisons: parameters of the hidden effect, and whether it was named.
    """

    found: Diagnosis
    truth: Mapping[str, Any]
    comparisons: tuple[TruthComparison, ...]


def session_for_gap(folder: Path, *, seed: int) -> DemoGap:
    """Record the second session, diagnose its gap, and compare with the truth.

    Args:
        folder: where session, model, truth and report go.
        seed: of the bench.
    """
    url = f"sim:two-body-campaign?seed={seed}&hide={_HIDDEN}&grid={_GRID}"
    written = record_session_file(url, folder / FILES[0], overwrite=True)
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
    """Print the verdict on the second session and the hidden effect."""
    screen = console(json_target)
    screen.print("\nSecond session: gap between model and measurement", style="bold")
    show_diagnosis(gap.found, json_target)
    content = _hidden_table(gap)
    screen.print(table(content.caption, content.columns, content.rows))


def _hidden_table(gap: DemoGap) -> DataTable:
    """Return the hidden effects and the named ones."""
    named = ", ".join(f"{e.name} at {e.site}" for e in gap.found.effects) or "-"
    rows = tuple(
        (f"{name} at {gap.truth['sites'][name]}", gap.found.verdict.value, named)
        for name in gap.truth["effects"]
    )
    return DataTable(
        "Hidden effect and verdict", ("hidden effect", "verdict", "named"), rows
    )


def gap_sections(gap: DemoGap) -> tuple[Section, ...]:
    """Return the step's sections for the demo's report."""
    report = gap_report(gap.found, title="the second session")
    evidence = [one for one in report.sections if one.items][:_SECTIONS_SHOWN]
    return (
        Section("gap", "Gap between model and measurement", (_hidden_table(gap),)),
        *(replace(section, anchor=f"gap-{section.anchor}") for section in evidence),
    )


def gap_json(gap: DemoGap) -> dict[str, object]:
    """Return verdict and truth as in the summary."""
    return {
        **diagnosis_json(gap.found),
        "truth": {
            "effects": dict(gap.truth["effects"]),
            "sites": dict(gap.truth["sites"]),
        },
    }
