# SPDX-License-Identifier: MIT
"""What became of a processed session, as text and plain data."""

import math
from pathlib import Path

from jointbench.station.archive.process_file import Outcome, State
from jointbench.station.results.result_rows import ResultQuantity
from jointbench.station.schemas.recipe import Recipe, read_recipe
from jointbench.station.schemas.stored_recipe import read_stored_recipe
from jointbench.station.screen.value_text import with_sd

STAGES_FOLDER = ".jointbench-stages"


def stages_folder(beside: Path) -> Path:
    """Return where stages are kept by default: in a folder beside the results."""
    return beside.parent / STAGES_FOLDER


def recipe_or_default(path: Path | None) -> Recipe:
    """Read a recipe; without one, everything is chosen by the data.

    A .json is the recipe of a result, as `jointbench provenance` writes it.
    """
    if path is not None and path.suffix.lower() == ".json":
        return read_stored_recipe(path)
    return Recipe(name="default") if path is None else read_recipe(path)


def quantity_cells(one: ResultQuantity) -> tuple[str, str, str, str]:
    """Return a quantity as the cells of a table."""
    at = "" if math.isnan(one.preload) else f" at {one.preload:g} N"
    of = f"{one.part} {one.item}".strip() + at
    value = one.word or with_sd(one.value, one.sd)
    return of, one.name.replace("_", " "), value, "" if one.unit == "1" else one.unit


def stage_words(outcome: Outcome) -> str:
    """Name the stages that were run and those that were kept."""
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
        "rotten": outcome.corrupted,
        "input_sha256": traces.input_sha256,
        "input_mark": list(traces.session),
        "result_mark": list(traces.result),
    }


def quantity_json(one: ResultQuantity) -> dict[str, object]:
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
