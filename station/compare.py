# SPDX-License-Identifier: MIT
"""``jointbench compare``: two recipes or versions side by side, shown."""

import math

from jointbench.station.archive_files import result_files
from jointbench.station.archive_table import read_results
from jointbench.station.compare_results import (
    MOVED,
    Comparison,
    Difference,
    compare_results,
)
from jointbench.station.output import console, table, with_sd, working, write_json
from jointbench.station.outputs import check_outputs

MOST_SHOWN = 40


def run_compare(before: str, after: str, *, json_target: str | None) -> Comparison:
    """Compare two results files, folders or patterns, and show what moved."""
    paths = result_files([before]), result_files([after])
    check_outputs([*paths[0], *paths[1]], [json_target])
    with working("reading results"):
        sets = [read_results(group) for group in paths]
    found = compare_results(sets[0][0], sets[1][0])
    screen = console(json_target)
    screen.print(f"{found.pairs} sessions in both, {len(found.differences)} quantities")
    for words, names in (
        ("only in the first", found.only_before),
        ("only in the second", found.only_after),
    ):
        if names:
            shown = ", ".join(names[:5])
            screen.print(f"{words}: {len(names)} sessions ({shown} ...)")
    for path, reason in [*sets[0][1], *sets[1][1]]:
        screen.print(f"left out: {path}: {reason}", soft_wrap=True)
    screen.print("what is not the same:" if found.causes else "nothing is different:")
    for cause in found.causes:
        screen.print(f"  {cause}", soft_wrap=True)
    counts = ", ".join(f"{name} ({n})" for name, n in list(found.stages.items())[:12])
    screen.print(f"stages concerned: {counts or 'none'}", soft_wrap=True)
    title = f"Moved by more than {MOVED:g} standard deviations: {len(found.moved)}"
    columns = ("session", "quantity", "before", "after", "unit", "sd")
    rows = [_row(one) for one in found.moved[:MOST_SHOWN]]
    screen.print(table(title, columns, rows))
    if len(found.moved) > MOST_SHOWN:
        screen.print(f"and {len(found.moved) - MOST_SHOWN} more, see --json")
    write_json(json_target, _json(found))
    return found


def _row(one: Difference) -> tuple[str, str, str, str, str, str]:
    return (
        one.file,
        one.quantity.replace("_", " "),
        one.words[0] or _value(one.before, one.before_sd),
        one.words[1] or _value(one.after, one.after_sd),
        "" if one.unit == "1" else one.unit,
        "-" if math.isinf(one.moved) else f"{one.moved:.1f}",
    )


def _value(value: float, sd: float) -> str:
    return "not there" if math.isnan(value) else with_sd(value, sd)


def _json(found: Comparison) -> dict[str, object]:
    return {
        "sessions": found.pairs,
        "only_before": list(found.only_before),
        "only_after": list(found.only_after),
        "causes": list(found.causes),
        "stages": dict(found.stages),
        "quantities": len(found.differences),
        "moved": [
            {
                "file": one.file,
                "quantity": one.quantity,
                "unit": one.unit,
                "before": one.before,
                "before_sd": one.before_sd,
                "after": one.after,
                "after_sd": one.after_sd,
                "words": list(one.words),
                "moved_sd": one.moved,
            }
            for one in found.moved
        ],
    }
