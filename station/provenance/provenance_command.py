# SPDX-License-Identifier: MIT
"""``jointbench provenance``: where a result comes from, and all to run it again."""

from collections.abc import Iterator
from pathlib import Path

from jointbench.station.provenance.rerun_folder import write_rerun
from jointbench.station.provenance.result_provenance import (
    ResultProvenance,
    result_provenance,
)
from jointbench.station.provenance.uncertainty_budget import LEFT_OUT
from jointbench.station.screen.terminal import console, table, write_json


def run_provenance(
    path: Path, *, folder: Path | None, overwrite: bool, json_target: str | None
) -> None:
    """Show the provenance of a result; with a folder, write all to run it again."""
    found = result_provenance(path)
    screen = console(json_target)
    width = max(len(name) for name, _ in _facts(found))
    for name, value in _facts(found):
        screen.print(f"{name:{width}}  {value}", soft_wrap=True)
    if found.sensors:
        names = ("name", "quantity", "serial", "certificate", "calibrated", "due")
        rows = [
            tuple(str(one.get(name, "-")) for name in names) for one in found.sensors
        ]
        screen.print(table("Sensors", names, rows, words=set(range(len(names)))))
    rows = [
        (
            f"{row.of} [{row.unit}]" if row.unit != "1" else row.of,
            row.contribution,
            f"{row.sd:.2g}",
            f"{100 * row.share:.0f} %",
        )
        for row in found.budget
    ]
    columns = ("quantity", "contribution", "sd", "share of variance")
    screen.print(table("Uncertainty budget", columns, rows, words={0, 1}))
    for words in LEFT_OUT:
        screen.print(f"not included: {words}", soft_wrap=True)
    if folder is not None:
        readme = write_rerun(found, folder, overwrite=overwrite)
        screen.print(f"\nall to run it again: {readme}", soft_wrap=True)
    write_json(json_target, found.as_json())


def _facts(found: ResultProvenance) -> Iterator[tuple[str, str]]:
    facts = found.result.facts
    for name in (
        *("input_file", "input_sha256", "recipe_name", "software", "created"),
        *("session", "recorded", "operator", "specimen", "source"),
    ):
        if facts[name]:
            yield name.replace("_", " "), facts[name]
    yield from found.environment.items()
    beside = "yes" if found.session else "no, or changed since"
    yield "session beside the result", beside
