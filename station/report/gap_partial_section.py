# SPDX-License-Identifier: MIT
"""A partial explanation under model error: lines in words, section of a report."""

import numpy as np

from jointbench.analysis.gap.model.partial_records import (
    FamilyLead,
    LinearDiscrepancy,
    PartialExplanation,
)
from jointbench.station.report.gap_numbers import percent
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.traces import Trace

_NEVER = "-"
_MOST_PLACES = 3


def partial_lines(partial: PartialExplanation | None) -> list[tuple[str, str]]:
    """Return label and words of each line about a partial explanation.

    Args:
        partial: of a diagnosis; None gives no lines.
    """
    if partial is None:
        return []
    lines = []
    if partial.nonlinear:
        lines = [
            ("law", law_words(partial)),
            ("rivals", "; ".join(rival_words(r) for r in partial.rivals) or "none"),
            ("left", left_words(partial)),
        ]
    return [*lines, ("linear", linear_words(partial.linear))]


def law_words(partial: PartialExplanation) -> str:
    """Return the best law with its parameters and the levels at which it leads."""
    values = ", ".join(f"{p.name} {p.value:.4g} {p.unit}" for p in partial.parameters)
    text = (
        f"{partial.effect.replace('_', ' ')} (family {partial.family}) with {values}: "
        f"{partial.lead.standard_errors:.1f} standard errors ahead of no law"
    )
    if partial.levels:
        text += f"; it leads from {partial.levels[0]} to {partial.levels[1]}"
    return text


def rival_words(lead: FamilyLead) -> str:
    """Return the lead over one rival."""
    return (
        f"{lead.standard_errors:.1f} standard errors ahead of "
        f"{lead.rival.replace('_', ' ')}, in {100 * lead.conditions:.0f} % of "
        f"{lead.shown} conditions"
    )


def left_words(partial: PartialExplanation) -> str:
    """Return where most of the residual power is left."""
    places = [
        (share, view, label)
        for view, slices in partial.left.items()
        for label, share in slices.items()
        if len(slices) > 1
    ]
    places.sort(reverse=True)
    words = ", ".join(
        f"{view} {label} {percent(min(share, 1.0))}"
        for share, view, label in places[:_MOST_PLACES]
    )
    return f"{percent(1.0 - partial.share)} of the power; most at {words}"


def linear_words(rows: tuple[LinearDiscrepancy, ...]) -> str:
    """Return the largest linear discrepancies."""
    if not rows:
        return "no band has enough signal"
    ordered = sorted(rows, key=lambda r: -r.coherent)[:_MOST_PLACES]
    words = ", ".join(
        f"{100 * r.coherent:.2g} % on {r.channel} for hits on {r.hit_point} at "
        f"{r.low:.0f} to {r.high:.0f} Hz"
        for r in ordered
    )
    return f"error of the response function that all levels share: {words}"


def partial_section(partial: PartialExplanation | None) -> Section:
    """Return the section; it is empty if no part of the gap was examined so."""
    if partial is None:
        return Section("model-error", "Under model error", ())
    items: list[Item] = []
    if partial.nonlinear:
        items += [
            Text(f"{partial.reason[:1].upper()}{partial.reason[1:]}."),
            Text(f"Law: {law_words(partial)}."),
            Text(f"Left: {left_words(partial)}."),
            Plot(
                "left",
                "Residual power left by the best law over that without a law, on "
                "conditions held out; 1 is no gain.",
                _left_figure(partial),
                340,
            ),
            _rivals(partial),
        ]
    if partial.linear:
        items += [
            Text(f"Linear discrepancy: {linear_words(partial.linear)}."),
            Plot(
                "discrepancy",
                "Error of the response function that all records of a hit point share "
                "(solid), and what differs from record to record (dotted), relative to "
                "the response.",
                _linear_figure(partial.linear),
                340,
            ),
        ]
    return Section("model-error", "Under model error", tuple(items))


def _rivals(partial: PartialExplanation) -> DataTable:
    rows = tuple(
        (
            lead.rival.replace("_", " "),
            lead.family or _NEVER,
            lead.site or _NEVER,
            percent(max(lead.share, 0.0)),
            f"{lead.standard_errors:.1f}",
            f"{100 * lead.conditions:.0f} % of {lead.shown}",
        )
        for lead in (partial.lead, *partial.rivals)
    )
    columns = (
        "rival",
        "family",
        "site",
        "its power removed",
        "lead [standard errors]",
        "conditions led",
    )
    caption = f"Lead of {partial.effect.replace('_', ' ')}, held out by condition."
    return DataTable(caption, columns, rows)


def _left_figure(partial: PartialExplanation) -> Figure:
    """Return bars of the power left by frequency and by level."""
    traces: list[Trace] = []
    for view in ("frequency", "level"):
        slices = partial.left.get(view, {})
        traces.append(
            {
                "type": "bar",
                "x": list(slices),
                "y": [float(f"{value:.4g}") for value in slices.values()],
                "name": view,
            }
        )
    return figure(
        traces,
        axis("band or level", type="category"),
        axis("power left [-]", range=[0.0, 1.1]),
    )


def _linear_figure(rows: tuple[LinearDiscrepancy, ...]) -> Figure:
    """Return coherent and incoherent error by band, for each hit point and channel."""
    traces: list[Trace] = []
    for point, channel in dict.fromkeys((r.hit_point, r.channel) for r in rows):
        own = [r for r in rows if (r.hit_point, r.channel) == (point, channel)]
        middle = [float(f"{np.sqrt(r.low * r.high):.5g}") for r in own]
        for name, dash in (("coherent", "solid"), ("incoherent", "dot")):
            traces.append(
                {
                    "type": "scatter",
                    "mode": "lines+markers",
                    "x": middle,
                    "y": [float(f"{100 * getattr(r, name):.4g}") for r in own],
                    "name": f"{channel}, hits on {point}, {name}",
                    "line": {"dash": dash},
                }
            )
    return figure(
        traces,
        axis("frequency [Hz]", log=True),
        axis("error of the response [%]"),
    )
