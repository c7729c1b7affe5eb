# SPDX-License-Identifier: MIT
"""``jointbench process``: one session processed with a recipe."""

from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.archive.process_file import Outcome, State, Task, process_task
from jointbench.station.archive.process_outcome import (
    outcome_json,
    quantity_cells,
    quantity_json,
    recipe_or_default,
    stage_words,
    stages_folder,
)
from jointbench.station.files.output_paths import check_outputs, require_folder
from jointbench.station.results.processed_file import processed_path
from jointbench.station.results.results_read import StoredResult, read_result
from jointbench.station.screen.terminal import console, table, working, write_json

MOST_CHANGES = 20


def run_process(
    file: Path,
    *,
    recipe: Path | None,
    out: Path | None,
    stages: Path | None,
    again: bool,
    json_target: str | None,
) -> StoredResult:
    """Process a session, write the result next to it and show it.

    Args:
        file: session, which is only read.
        recipe: TOML, or None for the defaults.
        out: results file, or None for next to the session.
        stages: folder of stored stages, or None for next to the result.
        again: run all stages, stored ones included.
        json_target: where the JSON goes.

    Raises:
        BadData: the session or the recipe cannot be used.
        UsageError: the result cannot be written.
    """
    require_folder(stages, "--stages")
    settings = recipe_or_default(recipe)
    target = out or processed_path(file, settings)
    check_outputs([file, *([recipe] if recipe else [])], [target, json_target])
    task = Task(file, target, stages or stages_folder(target), again=again)
    with working(f"processing {file.name}"):
        outcome = process_task(task, settings)
    if outcome.unwritable:
        raise UsageError(outcome.reason)
    if outcome.state is State.FAILED:
        raise BadData(outcome.reason)
    result = read_result(target)
    _show(result, outcome, json_target)
    write_json(json_target, _json(result, outcome))
    return result


def _show(result: StoredResult, outcome: Outcome, json_target: str | None) -> None:
    screen = console(json_target)
    title = f"{visible(result.path.name)}: recipe {result.facts['recipe_name']!r}"
    columns = ("part", "quantity", "value ± sd", "unit")
    rows = [quantity_cells(one) for one in result.quantities]
    screen.print(table(title, columns, rows))
    changes = result.changes
    if changes:
        screen.print(f"\n{len(changes)} hit verdicts changed:")
    for change in changes[:MOST_CHANGES]:
        screen.print(
            f"  {change.recording} at {change.time:.3f} s: {change.before} -> "
            f"{change.after}: {change.reason}",
        )
    if len(changes) > MOST_CHANGES:
        screen.print(f"  and {len(changes) - MOST_CHANGES} more; use --json for all")
    for remark in result.remarks:
        screen.print(remark)
    if outcome.corrupted:
        screen.print(f"\ncomputed again: {outcome.corrupted}", soft_wrap=True)
    screen.print(f"\nstages: {stage_words(outcome)}")
    screen.print(f"result: {visible(str(result.path))}", soft_wrap=True)


def _json(result: StoredResult, outcome: Outcome) -> dict[str, object]:
    return {
        "ledger": [outcome_json(outcome)],
        "result": str(result.path),
        "recipe": dict(result.recipe),
        "quantities": [quantity_json(one) for one in result.quantities],
        "verdicts_changed": [
            {
                "recording": change.recording,
                "time_s": change.time,
                "before": change.before,
                "after": change.after,
                "reason": change.reason,
            }
            for change in result.changes
        ],
        "remarks": list(result.remarks),
    }
