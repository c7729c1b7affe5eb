# SPDX-License-Identifier: MIT
"""What else could explain the measurement of a joint: table, report section, JSON."""

from collections.abc import Sequence
from typing import Any

from jointbench.analysis.lumped.identified import JointParameter, parameter_json
from jointbench.analysis.structures.identification.weigh_hypotheses import (
    StateHypotheses,
    WeighedHypothesis,
)
from jointbench.station.screen.joint_text import VALUE_LEGEND, parameter_text
from jointbench.station.screen.page_parts import DataTable, Item, Section, Text
from jointbench.station.screen.terminal import console, table

NOTE = (
    "Each hypothesis is searched by itself. Its probability is that of the measurement "
    "under it (evidence, Laplace's approximation) times that before the measurement."
)
NONE_FITS = (
    "none of them explains the measurement: more than one fault, or another one; check "
    "supports, material and masses"
)


def show_hypotheses(states: Sequence[StateHypotheses], json_target: str | None) -> None:
    """Print the surviving hypotheses of each state, with their parameters.

    A state that leaves the modes as measured without a rival takes one line.
    """
    screen = console(json_target)
    for one in states:
        if len(one.surviving) == 1 and one.surviving[0].kind.value == "as measured":
            screen.print(
                f"{one.state}: {len(one.hypotheses) - 1} other hypotheses tried, none "
                "survives",
                markup=False,
            )
            continue
        screen.print(
            table(f"{_title(one)} {VALUE_LEGEND}", _heads(one), _rows(one)),
        )
        if not one.fits:
            screen.print(f"  {NONE_FITS}", markup=False)


def hypothesis_section(states: Sequence[StateHypotheses]) -> Section | None:
    """Return the section of the report; None where nothing was tried."""
    if not states:
        return None
    items: list[Item] = [Text(NOTE)]
    for one in states:
        items.append(DataTable(_title(one), _heads(one), tuple(_rows(one))))
        if not one.fits:
            items.append(Text(f"{one.state}: {NONE_FITS}", "notice"))
    return Section("hypotheses", "Hypotheses", tuple(items))


def hypotheses_json(states: Sequence[StateHypotheses]) -> list[dict[str, Any]]:
    """Return all hypotheses as plain numbers and texts, those that fell too."""
    return [
        {
            "state": one.state,
            "fits": one.fits,
            "tried": [_hypothesis_json(case) for case in one.hypotheses],
            "parameters": _parameters_json(one.parameters),
        }
        for one in states
    ]


def _hypothesis_json(one: WeighedHypothesis) -> dict[str, Any]:
    return {
        "kind": one.kind.value,
        "text": one.text,
        "probability": one.probability,
        "survives": one.survives,
        "chi2": one.chi2,
        "rows": one.rows,
        "parameters": _parameters_json(one.parameters),
    }


def _parameters_json(parameters: Sequence[JointParameter]) -> dict[str, Any]:
    return {one.name: parameter_json(one) for one in parameters}


def _title(one: StateHypotheses) -> str:
    tried, left = len(one.hypotheses), len(one.surviving)
    return f"Hypotheses of {one.state}: {left} of {tried} survive"


def _heads(one: StateHypotheses) -> tuple[str, ...]:
    names = tuple(f"{p.name} [{p.unit}]" if p.unit else p.name for p in one.parameters)
    return ("hypothesis", "probability", "chi2 (rows)", *names)


def _rows(one: StateHypotheses) -> list[tuple[str, ...]]:
    names = [parameter.name for parameter in one.parameters]
    rows = []
    for case in one.surviving:
        own = {parameter.name: parameter for parameter in case.parameters}
        rows.append(
            (
                f"{case.kind.value}: {case.text}",
                f"{100 * case.probability:.3g} %",
                f"{case.chi2:.3g} ({case.rows})",
                *(parameter_text(own[name]) for name in names),
            )
        )
    if len(rows) > 1:
        mixed = (parameter_text(parameter) for parameter in one.parameters)
        rows.append(("all, by probability", "", "", *mixed))
    return rows
