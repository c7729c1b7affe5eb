# SPDX-License-Identifier: MIT
"""``jointbench process``: one recorded session under a recipe, and what changed."""

import math
from pathlib import Path

from jointbench.acquisition.errors import BadData, UsageError
from jointbench.acquisition.text_files import visible
from jointbench.station.output import console, table, with_sd, working, write_json
from jointbench.station.outputs import check_outputs, require_folder
from jointbench.station.process_file import Outcome, State, Task, process_task
from jointbench.station.processed_file import processed_path
from jointbench.station.quantities import Quantity
from jointbench.station.recipe import Recipe, read_recipe
from jointbench.station.results_read import StoredResult, read_result

STAGES_FOLDER = ".jointbench-stages"
MOST_CHANGES = 20


def stages_folder(beside: Path) -> Path:
    """Return where stages are kept by default: in a folder beside the results."""
    return beside.parent / STAGES_FOLDER


def recipe_or_default(path: Path | None) -> Recipe:
    """Read a recipe; without one, everything is chosen by the data."""
    return Recipe(name="default") if path is None else read_recipe(path)


def run_process(
    file: Path,
    *,
    recipe: Path | None,
    out: Path | None,
    stages: Path | None,
    again: bool,
    json_target: str | None,
) -> StoredResult:
    """Process a session, write the result beside it and show it.

    Args:
        file: session; it is only read.
        recipe: TOML, or None for the defaults.
        out: results file, or None for beside the session.
        stages: folder of kept stages, or None for beside the result.
        again: run all stages whatever is kept.
        json_target: where the JSON goes.

    Raises:
        BadData: the session or the recipe cannot be used.
        UsageError: the result cannot be written.
    """
    require_folder(stages, "--stages")
    made = recipe_or_default(recipe)
    target = out or processed_path(file, made)
    check_outputs([file, *([recipe] if recipe else [])], [target, json_target])
    task = Task(file, target, stages or stages_folder(target), again=again)
    with working(f"processing {file.name}"):
        outcome = process_task(task, made)
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
    columns = ("of", "quantity", "value ± sd", "unit")
    rows = [quantity_cells(one) for one in result.quantities]
    screen.print(table(title, columns, rows))
    changes = result.changes
    if changes:
        screen.print(f"\n{len(changes)} verdicts changed:")
    for change in changes[:MOST_CHANGES]:
        screen.print(
            f"  {change.recording} at {change.time:.3f} s: {change.before} -> "
            f"{change.after}: {change.reason}",
            soft_wrap=True,
        )
    if len(changes) > MOST_CHANGES:
        screen.print(f"  and {len(changes) - MOST_CHANGES} more, see --json")
    for remark in result.remarks:
        screen.print(remark, soft_wrap=True)
    if outcome.rotten:
        screen.print(f"\nmade anew: {outcome.rotten}", soft_wrap=True)
    screen.print(f"\nstages: {stage_words(outcome)}", soft_wrap=True)
    screen.print(f"result: {visible(str(result.path))}", soft_wrap=True)


def quantity_cells(one: Quantity) -> tuple[str, str, str, str]:
    """Return a quantity as the cells of a table."""
    at = "" if math.isnan(one.preload) else f" at {one.preload:g} N"
    of = f"{one.part} {one.item}".strip() + at
    value = one.word or with_sd(one.value, one.sd)
    return of, one.name.replace("_", " "), value, "" if one.unit == "1" else one.unit


def stage_words(outcome: Outcome) -> str:
    """Say which stages were run and which were kept."""
    if outcome.state is State.SKIPPED:
        return "none, the result was there (--again runs all)"
    run = ", ".join(outcome.computed) or "none"
    kept = ", ".join(outcome.reused) or "none"
    return f"run: {run}; kept from before: {kept}"


def outcome_json(outcome: Outcome) -> dict[str, object]:
    """Return a line of the ledger."""
    traces = outcome.traces
    return {
        "file": str(outcome.path),
        "result": str(outcome.result),
        "state": outcome.state.value,
        "key": outcome.key,
        "reason": outcome.reason,
        "lasting": outcome.lasting,
        "seconds": round(outcome.seconds, 4),
        "verdicts_changed": outcome.changes,
        "computed": list(outcome.computed),
        "reused": list(outcome.reused),
        "rotten": outcome.rotten,
        "input_sha256": traces.input_sha256,
        "input_mark": list(traces.session),
        "result_mark": list(traces.result),
    }


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


def quantity_json(one: Quantity) -> dict[str, object]:
    """Return a quantity as plain data; NaN becomes null."""
    return {
        "part": one.part,
        "item": one.item,
        "name": one.name,
        "unit": one.unit,
        "value": one.value,
        "sd": one.sd,
        "word": one.word,
        "preload_n": one.preload,
    }
