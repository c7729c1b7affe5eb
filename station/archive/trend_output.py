# SPDX-License-Identifier: MIT
"""Trends as they are shown: the cells of a table, and plain data."""

import math
from collections.abc import Sequence

from jointbench.station.archive.trends import OVER, Trend
from jointbench.station.screen.value_text import with_sd

_SURE = 3.0
"""A slope or a difference this many standard deviations from zero is called one."""


def trend_rows(
    trends: Sequence[Trend], over: str
) -> list[tuple[str, str, str, str, str]]:
    """Return trends as the cells of a table."""
    return [
        (
            trend.quantity.replace("_", " "),
            str(trend.count),
            f"{with_sd(trend.mean, trend.scatter)} {_unit(trend.unit)}".strip(),
            _over(trend, over),
            _verdict(trend),
        )
        for trend in trends
    ]


def _over(trend: Trend, over: str) -> str:
    if trend.groups:
        return ", ".join(f"{name}: {with_sd(m, s)}" for name, m, s in trend.groups[:6])
    if math.isnan(trend.slope):
        return "-"
    below = f"({OVER[over]})" if " " in OVER[over] else OVER[over]
    return f"{with_sd(trend.slope, trend.slope_sd)} {trend.unit}/{below}"


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


def _verdict(trend: Trend) -> str:
    """State whether a quantity changes."""
    if math.isnan(trend.significance):
        return "one place only"
    sure = trend.significance > _SURE
    return f"{'changes' if sure else 'no change seen'} ({trend.significance:.1f} sd)"


def trends_json(trends: Sequence[Trend]) -> list[dict[str, object]]:
    """Return trends as plain data."""
    return [
        {
            "quantity": trend.quantity,
            "unit": trend.unit,
            "count": trend.count,
            "mean": trend.mean,
            "scatter": trend.scatter,
            "slope": trend.slope,
            "slope_sd": trend.slope_sd,
            "groups": [{"name": n, "mean": m, "sd": s} for n, m, s in trend.groups],
            "significance_sd": trend.significance,
            "verdict": _verdict(trend),
        }
        for trend in trends
    ]
