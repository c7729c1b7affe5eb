# SPDX-License-Identifier: MIT
"""Identified joints compared with the contact law: table and plots."""

from collections.abc import Sequence

from jointbench.station.drawing.palette import LAW, MEMBERS, MODEL
from jointbench.station.joints.contact_comparison import unit_of
from jointbench.station.joints.theory_records import (
    JointQuantity,
    StateEstimate,
    TheoryRow,
)
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.joint_text import interval_text
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.terminal import console, table
from jointbench.station.screen.traces import Trace
from jointbench.station.screen.value_text import with_sd

TITLE = "Identified joint compared with the contact law (95 % intervals)"
NOTE = (
    "The damping of the law is the loss of a first loading at the frequency of the "
    "mode with the largest strain energy in the joint: an upper bound for small "
    "vibration. The law does not include the compliance of bodies, bolts and waviness."
)
# Markers of several models are shifted by this ratio at each preload.
_APART = 1.02


HEADS = ("quantity", "state", "identified", "model", "predicted", "ratio", "overlap")


def theory_table(rows: Sequence[TheoryRow]) -> list[tuple[str, ...]]:
    """Return the cells of the comparison, one row per model, under `HEADS`."""
    order = list(JointQuantity)
    ranked = sorted(rows, key=lambda row: (order.index(row.quantity), row.preload))
    return [
        (
            f"{row.quantity.replace('_', ' ')} [{unit_of(row.quantity)}]",
            _state(row),
            _identified(row),
            name,
            *_predicted(row, one),
        )
        for row in ranked
        for name, one in row.predicted.items()
    ]


def _state(row: TheoryRow) -> str:
    """Name a state by torque or preload, the one that its label lacks."""
    if row.torque is not None:
        return f"{row.state}, {row.torque:.4g} N m"
    return f"{row.state}, {with_sd(row.preload, row.preload_sd)} N"


def _estimate(one: StateEstimate) -> str:
    if one.low is None and one.high is None:
        return f"{one.value:.4g}"
    low = "open" if one.low is None else f"{one.low:.3g}"
    high = "open" if one.high is None else f"{one.high:.3g}"
    return f"{one.value:.4g} ({low}–{high})"


def _identified(row: TheoryRow) -> str:
    """Write the identified value, or its admissible range if not identifiable."""
    if row.identifiable:
        return _estimate(row.identified)
    ends = interval_text((row.identified.low, row.identified.high))
    return ends if ends == "open" else f"{ends}, open"


def _predicted(row: TheoryRow, one: StateEstimate | None) -> tuple[str, str, str]:
    if one is None:
        return ("-", "-", "-")
    words = {True: "yes", False: "no", None: "-"}
    ratio = f"{one.value / row.identified.value:.3g}" if row.identifiable else "-"
    return _estimate(one), ratio, words[row.identified.overlaps(one)]


def show_theory(rows: Sequence[TheoryRow], json_target: str | None) -> None:
    """Print the comparison; nothing where there is none."""
    if not rows:
        return
    screen = console(json_target)
    screen.print(table(TITLE, HEADS, theory_table(rows)))
    screen.print(f"  {NOTE}", markup=False)


def theory_section(rows: Sequence[TheoryRow]) -> Section | None:
    """Return the section of the report: the table, and a plot of each quantity."""
    if not rows:
        return None
    items: list[Item] = [
        DataTable(TITLE, HEADS, tuple(theory_table(rows)), frozenset({"no"})),
        Text(NOTE),
    ]
    for quantity in JointQuantity:
        own = sorted(
            (row for row in rows if row.quantity is quantity), key=lambda r: r.preload
        )
        if own:
            items.append(_plot(quantity, own))
    return Section("theory", "Comparison with the contact law", tuple(items))


def _plot(quantity: JointQuantity, rows: Sequence[TheoryRow]) -> Plot:
    preload = [row.preload / 1e3 for row in rows]
    known = [row.identified if row.identifiable else None for row in rows]
    traces = [_points(preload, known, "identified", MODEL)]
    models = list(dict.fromkeys(name for row in rows for name in row.predicted))
    for number, name in enumerate(models):
        shifted = [one * _APART ** (number + 1) for one in preload]
        found = [row.predicted.get(name) for row in rows]
        color = (LAW, *MEMBERS)[number % (1 + len(MEMBERS))]
        traces.append(_points(shifted, found, name, color))
    words = quantity.replace("_", " ")
    plot = figure(
        traces,
        axis("preload [kN]", log=True),
        axis(f"{words} [{unit_of(quantity)}]", log=True),
    )
    caption = f"{words.capitalize()}: identified and predicted, 95 % intervals"
    return Plot(f"theory-{quantity}", caption, plot, 360)


def _points(
    x: Sequence[float], found: Sequence[StateEstimate | None], name: str, color: str
) -> Trace:
    """Return points with intervals; a log axis cannot show a value of 0."""
    kept = [(at, one) for at, one in zip(x, found, strict=True) if one and one.value]
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "x": [at for at, _ in kept],
        "y": [one.value for _, one in kept],
        "name": name,
        "line": {"color": color, "width": 1, "dash": "dot"},
        "marker": {"color": color, "size": 8},
        "error_y": {
            "type": "data",
            "symmetric": False,
            "array": [(one.high or one.value) - one.value for _, one in kept],
            "arrayminus": [one.value - (one.low or one.value) for _, one in kept],
            "thickness": 1,
            "width": 3,
        },
    }
