# SPDX-License-Identifier: MIT
"""``jointbench archive``: all results in one table, and trends over torque and date."""

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.archive.archive_table import (
    Row,
    left_out_words,
    table_rows,
    write_table,
    writer_of,
)
from jointbench.station.archive.results_index import read_indexed
from jointbench.station.archive.trend_output import trend_rows, trends_json
from jointbench.station.archive.trends import OVER, Trend, check_trend, trends_of
from jointbench.station.files.archive_patterns import result_files
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.results.results_read import StoredResult, without_copies
from jointbench.station.screen.terminal import console, table, working, write_json

BETWEEN_LOADS = ("day", "specimen")
"""Over what trends are kept apart by the torque of the bolts."""


def run_archive(
    patterns: Sequence[str], *, out: Path | None, trend: str, json_target: str | None
) -> int:
    """Collect results in one table and show the trend of each quantity over `trend`.

    Args:
        patterns: results files, folders or patterns.
        out: table to write, or None.
        trend: ``torque``, ``preload``, ``day`` or ``specimen``.
        json_target: where the JSON goes.

    Returns:
        Number of results files that could not be read.
    """
    check_trend(trend)
    paths = result_files(patterns)
    check_outputs(paths, [out, json_target])
    if out is not None:
        writer_of(out)
    with working(f"reading {len(paths)} results"):
        found, refused = read_indexed(paths)
    results, copies = without_copies(found)
    rows = table_rows(results)
    if not rows:
        raise BadData(
            f"none of {len(paths)} results files contains a quantity"
            + (f"; {refused[0][1]}" if refused else "")
        )
    if out is not None:
        write_table(out, rows)
    trends = _trends(rows, trend)
    _show(results, rows, trends, trend, out, console(json_target))
    screen = console(json_target)
    for copy in copies:
        words = f"excluded: {visible(str(copy.path))} is a copy of another result"
        screen.print(words, soft_wrap=True)
    for path, reason in refused:
        screen.print(left_out_words(path, reason), soft_wrap=True)
    write_json(
        json_target,
        {
            "results": len(results),
            "rows": len(rows),
            "table": None if out is None else str(out),
            "left_out": [{"file": str(p), "reason": r} for p, r in refused],
            "copies": [str(copy.path) for copy in copies],
            "trend": trend,
            "trends": trends_json(trends),
        },
    )
    return len(refused)


def _trends(rows: Sequence[Row], over: str) -> tuple[Trend, ...]:
    """Return the trends, separately for each recipe and software version.

    Over dates and specimens separately for each torque as well: a joint is stiffer at
    more torque, which would hide what changes.
    """
    ways = ways_of(rows)
    loads = torque_words(rows) if over in BETWEEN_LOADS else {}
    points = [
        Trend.point(
            row,
            over,
            ways[row.recipe, row.recipe_sha256, row.software],
            loads.get(row.torque, ""),
        )
        for row in rows
        if not math.isnan(row.value) and row.part != "hits"
    ]
    return trends_of(points)


def _show(
    results: Sequence[StoredResult],
    rows: Sequence[Row],
    trends: Sequence[Trend],
    over: str,
    out: Path | None,
    screen: Console,
) -> None:
    if out is not None:
        words = f"{out}: {len(rows)} rows from {len(results)} results"
        screen.print(words, soft_wrap=True)
    if not trends:
        screen.print(
            f"no trend over {over}: no quantity has two or more results with a known "
            f"{over}; --trend takes {', '.join(OVER)}",
        )
        return
    title = f"Trends over {over} ({len(results)} results)"
    columns = ("quantity", "results", "mean ± scatter", f"over {over}", "verdict")
    screen.print(table(title, columns, trend_rows(trends, over)))


def torque_words(rows: Sequence[Row]) -> dict[float, str]:
    """Return what names each torque, `` at 20 N m``, where each was set repeatedly.

    Args:
        rows: of the table.

    Returns:
        Words by torque; none for one torque, nor where one has a single result, as
        torques have that were read and not set.
    """
    met = {(row.torque, row.input_sha256) for row in rows}
    counts = Counter(torque for torque, _ in met if not math.isnan(torque))
    if len(counts) < 2 or min(counts.values()) < 2:
        return {}
    return {torque: f" at {torque:g} N m" for torque in counts}


def ways_of(rows: Sequence[Row]) -> dict[tuple[str, str, str], str]:
    """Return a name for each recipe and software version, if there are several.

    Args:
        rows: of the table.

    Returns:
        Names by recipe, digest and software: the name of the recipe, with the first
        characters of the digest or the version where recipes of one name differ;
        empty names where all results have the same.
    """
    ways = sorted({(row.recipe, row.recipe_sha256, row.software) for row in rows})
    if len(ways) == 1:
        return {ways[0]: ""}
    digests, versions = (len({way[i] for way in ways}) > 1 for i in (1, 2))
    names = [way[0] for way in ways]
    found = {}
    for way in ways:
        words = [way[0] or "no recipe"]
        if names.count(way[0]) > 1:
            words += [way[1][:8]] * digests + [way[2]] * versions
        found[way] = f"{' '.join(words)}: "
    return found
