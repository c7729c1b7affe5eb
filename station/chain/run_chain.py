# SPDX-License-Identifier: MIT
"""The chain of a joint as a command: examine, show, write."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.analysis.gap.response.threads import side_by_side
from jointbench.station.chain.chain_report import chain_report
from jointbench.station.chain.chain_words import chain_json, show_chain
from jointbench.station.chain.examine_chain import examine_chain
from jointbench.station.gap.gap_inputs import GapRequest
from jointbench.station.screen.escaping_console import Screen, seen
from jointbench.station.screen.page import write_report
from jointbench.station.screen.terminal import console, write_json

_MOST_REMARKS = 5


def run_chain(
    sessions: Sequence[Path],
    surfaces: Sequence[Path],
    wanted: GapRequest,
    *,
    report: Path | None,
    json_target: str | None,
) -> Diagnosis:
    """Diagnose a chain, show verdict and evidence, and write the report if asked.

    Args:
        sessions: of one bench.
        surfaces: of one or both contact surfaces.
        wanted: model and options.
        report: HTML report to write, or None.
        json_target: where the JSON goes.

    Returns:
        The diagnosis of the joint by the contact law.
    """
    status = Screen(stderr=True)
    with side_by_side(), status.status("reading the chain") as shown:
        done = examine_chain(
            sessions,
            surfaces,
            wanted,
            progress=lambda line: shown.update(seen(line)),
        )
    show_chain(done, json_target)
    screen = console(json_target)
    for remark in done.remarks[:_MOST_REMARKS]:
        screen.print(f"note: {remark}", markup=False)
    if report is not None:
        write_report(chain_report(done), report)
        screen.print(f"\nreport: {report}", soft_wrap=True)
    write_json(json_target, chain_json(done))
    return done.diagnosis
