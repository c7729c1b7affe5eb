# SPDX-License-Identifier: MIT
"""``jointbench compare``: differences between two recipes or versions."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.console import Console

from jointbench.acquisition.basics.errors import BadData
from jointbench.station.archive.archive_table import left_out_words, read_results
from jointbench.station.archive.compare_results import (
    MOVED,
    Difference,
    ResultComparison,
    compare_results,
)
from jointbench.station.files.archive_patterns import result_files
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.screen.terminal import console, table, working, write_json
from jointbench.station.screen.value_text import with_sd

MOST_SHOWN = 40
FEW_SHOWN = 5


def run_compare(
    before: str, after: str, *, json_target: str | None
) -> tuple[ResultComparison, int]:
    """Compare two results files, folders or patterns and show what changed.

    Returns:
        The comparison, and how many results files could not be read.
    """
    paths = result_files([before]), result_files([after])
    check_outputs([*paths[0], *paths[1]], [json_target])
    with working("reading results"):
        (first, refused), (second, also) = (read_results(group) for group in paths)
    left_out = [*refused, *also]
    if left_out and not (first and second):  # one side is empty
        raise BadData(left_out_words(*left_out[0]))
    found = compare_results(first, second)
    screen = console(json_target)
    for line in _head(found):
        screen.print(line)
    for path, reason in left_out:
        screen.print(left_out_words(path, reason), soft_wrap=True)
    title = f"Changed by more than {MOVED:g} standard deviations, added or removed"
    _list(screen, title, found.moved, MOST_SHOWN)
    if found.unjudged:
        title = "Changed, standard deviation unknown"
        _list(screen, title, found.unjudged, FEW_SHOWN)
    write_json(json_target, _json(found, left_out))
    return found, len(left_out)


def _list(screen: Console, title: str, found: Sequence[Difference], most: int) -> None:
    columns = ("session", "quantity", "before", "after", "unit", "change [sd]", "cause")
    rows = [_row(one) for one in found[:most]]
    screen.print(table(f"{title}: {len(found)}", columns if rows else (), rows))
    if len(found) > most:
        screen.print(f"and {len(found) - most} more; use --json for all")


def _head(found: ResultComparison) -> Iterator[str]:
    """Yield the extent of the comparison, differing settings and affected stages."""
    yield f"sessions in both: {found.pairs}, quantities: {len(found.differences)}"
    for words, names in (
        ("only in BEFORE", found.only_before),
        ("only in AFTER", found.only_after),
    ):
        if names:
            more = ", ..." if len(names) > FEW_SHOWN else ""
            shown = ", ".join(names[:FEW_SHOWN])
            yield f"{words}: {len(names)} sessions ({shown}{more})"
    yield "differences:" if found.causes else "settings and version: identical"
    for cause, count in found.causes.items():
        some = (
            "" if count == found.pairs else f" (in {count} of {found.pairs} sessions)"
        )
        yield f"  {cause}{some}"
    counts = ", ".join(f"{name} ({n})" for name, n in list(found.stages.items())[:12])
    yield f"affected stages: {counts or 'none'}"


def _row(one: Difference) -> tuple[str, ...]:
    return (
        one.file,
        one.quantity.replace("_", " "),
        one.words[0] or _value(one.before, one.before_sd),
        one.words[1] or _value(one.after, one.after_sd),
        "" if one.unit == "1" else one.unit,
        f"{one.moved:.1f}" if math.isfinite(one.moved) else "-",
        one.since,
    )


def _value(value: float, sd: float) -> str:
    return "absent" if math.isnan(value) else with_sd(value, sd)


def _json(
    found: ResultComparison, left_out: Sequence[tuple[Path, str]]
) -> dict[str, object]:
    return {
        "sessions": found.pairs,
        "only_before": list(found.only_before),
        "only_after": list(found.only_after),
        "left_out": [{"file": str(p), "reason": r} for p, r in left_out],
        "causes": dict(found.causes),
        "stages": dict(found.stages),
        "quantities": len(found.differences),
        "moved": [_difference(one) for one in found.moved],
        "changed_without_sd": [_difference(one) for one in found.unjudged],
    }


def _difference(one: Difference) -> dict[str, object]:
    return {
        "file": one.file,
        "quantity": one.quantity,
        "unit": one.unit,
        "before": one.before,
        "before_sd": one.before_sd,
        "after": one.after,
        "after_sd": one.after_sd,
        "words": list(one.words),
        "moved_sd": one.moved,
        "since": one.since,
    }
