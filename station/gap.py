# SPDX-License-Identifier: MIT
"""``jointbench gap``: where model and measurement disagree, and what is missing."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.text import Text

from jointbench.analysis.gap.campaign import read_campaign
from jointbench.analysis.gap.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnose import diagnose
from jointbench.analysis.gap.records import Diagnosis, diagnosis_json
from jointbench.station.effects_file import read_effects, with_own
from jointbench.station.gap_output import show_diagnosis
from jointbench.station.output import console, write_json
from jointbench.station.outputs import check_outputs
from jointbench.station.report_gap import gap_report
from jointbench.station.report_page import write_report


def run_gap(
    campaign: Path,
    *,
    without: str | None,
    effects: Sequence[Path] = (),
    report: Path | None,
    json_target: str | None,
) -> Diagnosis:
    """Diagnose `campaign`, show verdict and evidence, and write the page if asked.

    Args:
        campaign: a two-body-campaign file.
        without: names of effects to leave out of the catalogue, joined by commas.
        effects: files of the user's own effects, run as Python.
        report: HTML page to write, or None.
        json_target: where the JSON goes.
    """
    names = frozenset(
        word.strip() for word in (without or "").split(",") if word.strip()
    )
    check_outputs([campaign, *effects], [report, json_target])
    own = [entry for path in effects for entry in read_effects(path)]
    content = read_campaign(campaign)
    screen = Console(stderr=True, highlight=False)
    with screen.status(Text(f"reading {campaign.name}")) as status:
        found = diagnose(
            content,
            without=names,
            entries=with_own(CATALOGUE, own),
            progress=lambda line: status.update(Text(line)),
        )
    show_diagnosis(found, json_target)
    if report is not None:
        write_report(gap_report(found, title=campaign.stem), report)
        console(json_target).print(f"\nreport: {report}")
    write_json(json_target, {"campaign": str(campaign), **diagnosis_json(found)})
    return found
