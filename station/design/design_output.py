# SPDX-License-Identifier: MIT
"""A designed test on the terminal, as JSON, and as a plan for ``measure``."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.station.design.run_design import (
    DesignedTest,
    DesignRequest,
    designed_test,
)
from jointbench.station.files.output_paths import check_outputs, write_text
from jointbench.station.screen.terminal import console, table, working, write_json

_SHOWN = 8
_INTERVAL = 1.96
_POINTS = re.compile(r"(?m)^points\s*=\s*\[[^\]]*\]")
_POINT = re.compile(r"(?m)^point\s*=\s*\"[^\"]*\"")


def run_design(
    model: Path,
    request: DesignRequest,
    *,
    template: Path | None,
    out: Path | None,
    json_target: str | None,
) -> None:
    """Design a test, show it, and write the plan.

    Args:
        model: structure model (TOML) with [design] and [reachable.*].
        request: what is asked for.
        template: plan of ``measure`` whose points and repeats are replaced.
        out: plan to write.
        json_target: JSON to write.

    Raises:
        UsageError: a plan is to be written without a template.
    """
    if out is not None and template is None:
        raise UsageError(
            "--out needs --plan: a plan with your sensors, whose points are replaced"
        )
    inputs = [one for one in (model, request.identified, template) if one is not None]
    check_outputs(inputs, [json_target])
    draft = None
    if template is not None and out is not None:
        draft = template.read_text(encoding="utf-8")
        request = replace(request, plan_sensors=_plan_sensors(draft))
    with working("reducing, choosing points"):
        found = designed_test(model, request)
    text = None if draft is None else plan_text(found, draft)
    show_design(found, json_target)
    write_json(json_target, design_json(found))
    if text is not None and out is not None:
        write_text(out, text)


def show_design(found: DesignedTest, json_target: str | None) -> None:
    """Print the points, the expected intervals and the next steps."""
    screen = console(json_target)
    chosen = [
        ("sensors", ", ".join(found.points[at] for at in found.plan.sensors)),
        ("hit points", ", ".join(found.points[at] for at in found.plan.hits)),
        ("hits at each", f"{found.plan.repeats:g}"),
    ]
    screen.print(
        table("Test plan", ("what", "points"), chosen, words=frozenset({0, 1}))
    )
    rows = [
        (name, _percent(found.deviation[at]), _percent(found.even[at]))
        for at, name in enumerate(found.names)
    ]
    columns = ("parameter", "expected 95 % [± %]", "evenly spread [± %]")
    screen.print(table("Expected intervals", columns, rows))
    screen.print(
        f"Evenly spread points give intervals {found.ratio_even:.2f} times as wide, "
        f"the best of 200 random plans {found.ratio_random:.2f} times.",
        markup=False,
    )
    if found.needed is not None:
        screen.print(
            f"{found.needed} hits at each point reach the wanted deviation.",
            markup=False,
        )
    if found.steps:
        steps = [
            (one.kind, _place(found, one.number), f"{100 * (1 - one.width):.1f}")
            for one in found.steps[:_SHOWN]
        ]
        heads = ("next step", "point", "narrower by [%]")
        screen.print(table("What to add", heads, steps, words=frozenset({0, 1})))


def plan_text(found: DesignedTest, template: str) -> str:
    """Return a plan of ``measure`` with the chosen points.

    Args:
        found: designed test.
        template: text of a plan: its points, repeats and places of the response
            sensors, in order, are replaced; it has as many as the design.
    """
    points = ", ".join(f'"{found.points[at]}"' for at in found.plan.hits)
    text = _POINTS.sub(f"points = [{points}]", template, count=1)
    repeats = int(np.ceil(found.plan.repeats))
    text = re.sub(r"(?m)^repeats\s*=\s*\d+", f"repeats = {repeats}", text, count=1)
    places = [found.points[at] for at in found.plan.sensors]
    left = iter(places)
    return _POINT.sub(lambda _: f'point = "{next(left)}"', text)


def _plan_sensors(template: str) -> int:
    """Return the number of response sensors of a plan.

    Raises:
        BadData: it has no points in [hits].
    """
    if not _POINTS.search(template):
        raise BadData("the plan has no 'points = [...]' in [hits]; add it")
    return len(_POINT.findall(template))


def design_json(found: DesignedTest) -> dict[str, Any]:
    """Return a designed test as plain numbers and texts."""
    return {
        "sensors": [found.points[at] for at in found.plan.sensors],
        "hits": [found.points[at] for at in found.plan.hits],
        "repeats": found.plan.repeats,
        "expected_sd": dict(zip(found.names, found.deviation.tolist(), strict=True)),
        "evenly_spread_sd": dict(zip(found.names, found.even.tolist(), strict=True)),
        "evenly_spread_over_plan": found.ratio_even,
        "best_random_over_plan": found.ratio_random,
        "hits_needed": found.needed,
        "next": [
            {
                "kind": one.kind,
                "point": _place(found, one.number),
                "width_ratio": one.width,
            }
            for one in found.steps
        ],
    }


def _place(found: DesignedTest, number: int) -> str:
    return "all" if number < 0 else found.points[number]


def _percent(deviation: float) -> str:
    wide = 100 * _INTERVAL * deviation
    return f"{wide:.3g}" if wide < 1e3 else "open"
