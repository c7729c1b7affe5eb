# SPDX-License-Identifier: MIT
"""``jointbench gap``: where model and measurement disagree, and what is missing."""

from pathlib import Path

from rich.console import Console
from rich.text import Text

from jointbench.analysis.gap.campaign import read_campaign
from jointbench.analysis.gap.diagnose import diagnose
from jointbench.analysis.gap.records import Diagnosis, diagnosis_json
from jointbench.station.output import console, table, with_sd, write_json
from jointbench.station.outputs import check_outputs
from jointbench.station.report_gap import gap_report
from jointbench.station.report_page import write_report

MOST_CANDIDATES = 6
MOST_SLICES = 3


def run_gap(
    campaign: Path,
    *,
    without: str | None,
    report: Path | None,
    json_target: str | None,
) -> Diagnosis:
    """Diagnose `campaign`, show verdict and evidence, and write the page if asked.

    Args:
        campaign: a two-body-campaign file.
        without: names of effects to leave out of the catalogue, joined by commas.
        report: HTML page to write, or None.
        json_target: where the JSON goes.
    """
    names = frozenset(
        word.strip() for word in (without or "").split(",") if word.strip()
    )
    check_outputs([campaign], [report, json_target])
    content = read_campaign(campaign)
    screen = Console(stderr=True, highlight=False)
    with screen.status(Text(f"reading {campaign.name}")) as status:
        found = diagnose(
            content,
            without=names,
            progress=lambda line: status.update(Text(line)),
        )
    show_diagnosis(found, json_target)
    if report is not None:
        write_report(gap_report(found, title=campaign.stem), report)
        console(json_target).print(f"\nreport: {report}")
    write_json(json_target, {"campaign": str(campaign), **diagnosis_json(found)})
    return found


def show_diagnosis(found: Diagnosis, json_target: str | None) -> None:
    """Print verdict, effects, where the gap sat, rivals, and what to do next."""
    screen = console(json_target)
    screen.print(f"verdict: {found.verdict.value}", style="bold")
    screen.print(f"  {found.reason}", markup=False)
    rows = [
        (
            f"{effect.name} at {effect.site}",
            one.name,
            with_sd(one.value, one.sd),
            one.unit,
            f"{100 * effect.confidence:.0f} %",
        )
        for effect in found.effects
        for one in effect.parameters
    ]
    if rows:
        columns = ("effect", "parameter", "value", "unit", "confidence")
        screen.print(table("Missing effects (± one standard deviation)", columns, rows))
    screen.print(_gap_line(found), markup=False)
    screen.print(table("Where the gap sits", ("view", "largest shares"), _where(found)))
    ranked = [
        (
            " + ".join(one.effects) or "(base alone)",
            f"{one.behind:.4g}",
            f"{one.chi2_per_dof:.4g}",
            f"{one.pull:.2g}",
        )
        for one in found.candidates[:MOST_CANDIDATES]
    ]
    heads = ("explanation", "behind the best", "chi2/dof", "largest pull [sd]")
    screen.print(table("Explanations tried", heads, ranked))
    if found.experiment:
        screen.print(f"\nnext: {found.experiment}", markup=False)


def _gap_line(found: Diagnosis) -> str:
    before, after = found.gap_before, found.gap_after
    pulls = max((abs(b) for b, _ in found.pulls.values()), default=0.0)
    return (
        f"\ngap on held-out records: {before.value:.3g} before, "
        f"{after.value:.3g} after (shrinks {100 * found.shrink:.1f} %); "
        f"largest pull of the sheet {pulls:.2g} sd before, {after.pull:.2g} sd after"
    )


def _where(found: Diagnosis) -> list[tuple[str, str]]:
    rows = []
    for view in found.gap_before.views:
        ordered = sorted(view.share.items(), key=lambda item: -item[1])[:MOST_SLICES]
        words = ", ".join(f"{label} {100 * share:.0f} %" for label, share in ordered)
        rows.append((view.name, words))
    return rows
