# SPDX-License-Identifier: MIT
"""Figures as plain dictionaries: axes and layout; see `traces` for the format."""

from collections.abc import Mapping, Sequence

from jointbench.station.screen.traces import Trace

Figure = Mapping[str, object]


def axis(title: str, *, log: bool = False, **more: object) -> dict[str, object]:
    """Return an axis with a title that names its unit."""
    result: dict[str, object] = {"title": {"text": title}}
    if log:
        result |= {"type": "log"}
    return result | more


def figure(
    data: Sequence[Trace],
    x: Mapping[str, object],
    y: Mapping[str, object],
    **more: object,
) -> Figure:
    """Return a figure on one pair of axes; `more` adds or replaces layout keys."""
    layout: dict[str, object] = {
        "xaxis": dict(x),
        "yaxis": dict(y),
    }
    return {"data": list(data), "layout": layout | more}
