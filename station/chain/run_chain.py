# SPDX-License-Identifier: MIT
"""The chain of a joint as a command: examine, show, write."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.analysis.gap.response.threads import side_by_side
from jointbench.station.chain.chain_json import chain_json
from jointbench.station.chain.chain_report import chain_report
from jointbench.station.chain.chain_words import show_chain
from jointbench.station.chain.examine_chain import examine_chain
from jointbench.station.files.input_files import refuse_twice
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.gap.gap_options import gap_request
from jointbench.station.screen.escaping_console import Screen, seen
from jointbench.station.screen.page import write_report
from jointbench.station.screen.terminal import console, write_json
from jointbench.station.sources.open_source import is_url

_MOST_REMARKS = 5


def run_chain(
    sources: Sequence[str],
    surfaces: Sequence[Path],
    *,
    model: Path | None,
    preload: str | None,
    without: str | None,
    report: Path | None,
    json_target: str | None,
) -> Diagnosis:
    """Diagnose a chain, show verdict and evidence, and write the report if asked.

    Args:
        sources: sessions of one bench.
        surfaces: of one or both contact surfaces.
        model: of the bench, with a table [bolted_joint].
        preload: on the joint with unit, where a session states none.
        without: names of effects to leave out of the catalogues, joined by commas.
        report: HTML report to write, or None.
        json_target: where the JSON goes.

    Returns:
        The diagnosis of the joint by the contact law.

    Raises:
        UsageError: a source is no session, or the model lacks the table.
    """
    if any(is_url(one) for one in sources):
        raise UsageError(
            "--surface needs recorded sessions; record the bench first with "
            "`jointbench record`"
        )
    sessions = [Path(one) for one in sources]
    refuse_twice(sessions)
    check_outputs(
        [*sessions, *surfaces, *([model] if model else [])], [report, json_target]
    )
    wanted = gap_request(model=model, preload=preload, without=without)
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
