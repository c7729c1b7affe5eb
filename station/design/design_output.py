# SPDX-License-Identifier: MIT
"""A designed test on the terminal, as JSON, and as a plan for ``measure``."""

import re
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.basics.units import parse_value
from jointbench.analysis.design.plan_search import NextStep
from jointbench.station.design.design_records import (
    DesignedTest,
    DesignRequest,
    NextTorque,
)
from jointbench.station.design.run_design import designed_test
from jointbench.station.files.output_paths import check_outputs, write_text
from jointbench.station.screen.terminal import console, table, working, write_json

_SHOWN = 8
_INTERVAL = 1.96
_NO_TORQUE = (
    "For a further torque, state that of the plan: design.torque, or design.states by "
    "the labels of identified states."
)
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
    if template is not None and request.measured:
        measured = template.read_text(encoding="utf-8")
        request = replace(request, plan_torques=_plan_torques(measured))
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
    columns = ("parameter", "expected 95 % [± %]", "evenly spread [± %]")
    screen.print(table("Expected intervals", columns, parameter_rows(found)))
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
            (one.kind, _place(found, one), f"{100 * (1 - one.width):.1f}")
            for one in found.steps[:_SHOWN]
        ]
        heads = ("next step", "where", "narrower by [%]")
        screen.print(table("What to add", heads, steps, words=frozenset({0, 1})))
    if found.torques:
        _show_torques(found, json_target)
    elif found.steps:
        screen.print(_NO_TORQUE, markup=False)


def parameter_rows(found: DesignedTest) -> list[tuple[str, str, str]]:
    """Return parameters with their expected intervals, and those of even spacing."""
    return [
        (name, _percent(found.deviation[at]), _percent(found.even[at]))
        for at, name in enumerate(found.names)
    ]


def next_remarks(found: DesignedTest) -> list[str]:
    """Return the best step of each kind, and what the best torque separates."""
    best = {one.kind: one for one in reversed(found.steps)}
    said = [
        f"{one.kind} {_place(found, one)}: narrower by {100 * (1 - one.width):.1f} %"
        for one in sorted(best.values(), key=lambda step: step.width)
    ]
    return [*said, torque_sentence(found)] if found.torques else said


def _show_torques(found: DesignedTest, json_target: str | None) -> None:
    """Print what the plan at one more torque buys, and what the best one separates."""
    screen = console(json_target)
    rows = [
        (
            f"{one.torque:.3g}",
            f"{100 * (1 - one.step.width):.1f}",
            f"{100 * (1 - one.step.law_width):.1f}",
            f"{_INTERVAL * _widest_exponent(found, one):.2g}",
            f"{100 * one.step.decides:.0f}",
        )
        for one in found.torques
    ]
    columns = (
        "torque [N m]",
        "joint narrower by [%]",
        "law narrower by [%]",
        "exponents to ±",
        "laws distinguished [%]",
    )
    screen.print(table("The plan at one more torque", columns, rows))
    screen.print(torque_sentence(found), markup=False)


def torque_sentence(found: DesignedTest) -> str:
    """Return the torque that says most of the law, and what it separates."""
    best = min(found.torques, key=lambda one: one.step.law_width)
    interval = _INTERVAL * _widest_exponent(found, best)
    said = (
        f"{best.torque:.3g} N m says most of the law over the torque: exponents to "
        f"±{interval:.2g} (95 %), and of stiffnesses that grow with its powers 1/3, "
        f"1/2 or 1 one is left in {100 * best.step.decides:.0f} % of outcomes."
    )
    if found.known_torques > 1:
        return said
    return f"One torque leaves open how the joint depends on it. {said}"


def _widest_exponent(found: DesignedTest, one: NextTorque) -> float:
    """Return the largest sd of the exponents of wanted parameters [-].

    Args:
        found: designed test.
        one: torque.
    """
    return float(one.step.exponent_sd[list(found.wanted)].max())


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
                "point": _place(found, one),
                "width_ratio": one.width,
            }
            for one in found.steps
        ],
        "torques": [_torque_json(found, one) for one in found.torques],
    }


def _torque_json(found: DesignedTest, one: NextTorque) -> dict[str, Any]:
    deviation = zip(found.names, one.step.exponent_sd.tolist(), strict=True)
    return {
        "torque": one.torque,
        "width_ratio": one.step.width,
        "law_width_ratio": one.step.law_width,
        "exponent_sd": {name: sd for name, sd in deviation if sd > 0},
        "laws_distinguished": one.step.decides,
    }


def _plan_torques(template: str) -> tuple[float, ...]:
    """Return the torques of a plan of ``measure`` [N m].

    Raises:
        BadData: it is no TOML.
    """
    try:
        hits = tomllib.loads(template).get("hits", {})
    except tomllib.TOMLDecodeError as error:
        raise BadData(f"the plan is no TOML: {error}") from error
    return tuple(parse_value(one, "torque") for one in hits.get("torques", []))


def _place(found: DesignedTest, step: NextStep) -> str:
    if step.kind == "torque":
        return f"{found.torques[step.number].torque:.3g} N m"
    return "all" if step.number < 0 else found.points[step.number]


def _percent(deviation: float) -> str:
    wide = 100 * _INTERVAL * deviation
    return f"{wide:.3g}" if wide < 1e3 else "open"
