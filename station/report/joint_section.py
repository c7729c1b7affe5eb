# SPDX-License-Identifier: MIT
"""The report's section on the joint: contact law compared with identification."""

from jointbench.analysis.lumped.identified import Identification
from jointbench.station.drawing.palette import GUIDE, LAW, MODEL
from jointbench.station.pipeline.joint_comparison import ContactPrediction
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.joint_text import interval_text, parameter_text
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Section, Text
from jointbench.station.screen.traces import Trace, band, line, markers
from jointbench.station.screen.value_text import with_sd


def joint_section(
    contact: ContactPrediction | None, joint: Identification | None, link: str
) -> Section:
    """Return the section: stiffness against preload, identified links, the ratio."""
    items: list[Item] = []
    if contact is not None:
        items += [
            _stiffness_plot(contact, joint, link),
            Text(side_by_side(contact, joint, link)),
        ]
        items += [Text(reason) for reason in contact.at.state.reasons]
    if joint is not None:
        items += [_links_table(joint), _fit_table(joint)]
    return Section("joint", "Joint", tuple(items))


def _stiffness_plot(
    contact: ContactPrediction, joint: Identification | None, link: str
) -> Plot:
    preload = [point.state.preload / 1e3 for point in contact.curve]
    traces: list[Trace] = [
        *band(
            preload,
            [point.interval.lower for point in contact.curve],
            [point.interval.upper for point in contact.curve],
            "95 % interval",
            color=LAW,
        ),
        line(
            preload,
            [point.state.normal_stiffness for point in contact.curve],
            f"{contact.at.state.model}, predicted",
            color=LAW,
        ),
    ]
    if joint is not None:
        traces += _identified(contact, joint, link)
    plot = figure(
        traces,
        axis("preload [kN]", log=True),
        axis("normal stiffness [N/m]", log=True),
        shapes=[_at_preload(contact)],
    )
    caption = (
        "Normal stiffness over preload: prediction of the contact law from the "
        "measured surfaces, and the value identified from the measured modes at the "
        "preload of the joint (dotted line)."
    )
    return Plot("stiffness-plot", caption, plot, 400)


def _identified(
    contact: ContactPrediction, joint: Identification, link: str
) -> list[Trace]:
    """Return the identified value as a marker; none where it is not identifiable."""
    value = joint.parameter(f"{link}.stiffness")
    if not value.identifiable:
        return []
    mark = markers(
        [contact.at.state.preload / 1e3],
        [value.value],
        f"link {link!r}, identified from the modes",
        color=MODEL,
        symbol="diamond",
        size=11,
        error=[1.96 * (value.sd or 0.0)],
    )
    return [mark]


def _at_preload(contact: ContactPrediction) -> dict[str, object]:
    x = contact.at.state.preload / 1e3
    style = {"color": GUIDE, "width": 1, "dash": "dot"}
    return {
        "type": "line",
        "x0": x,
        "x1": x,
        "y0": 0,
        "y1": 1,
        "yref": "paper",
        "line": style,
        "layer": "below",
    }


def side_by_side(
    contact: ContactPrediction, joint: Identification | None, link: str
) -> str:
    """Compare prediction and identification in one sentence."""
    predicted = contact.at.state.normal_stiffness
    text = (
        f"At {contact.at.state.preload / 1e3:.4g} kN the contact law "
        f"{contact.at.state.model} predicts {predicted:.3g} N/m "
        f"(95 %: {contact.at.interval.lower:.2g} to {contact.at.interval.upper:.2g})"
    )
    if joint is None:
        return text + "."
    measured = joint.parameter(f"{link}.stiffness")
    if not measured.identifiable:
        ends = interval_text(measured.interval)
        return f"{text}; the modes do not determine it (admissible, N/m: {ends})."
    ratio = predicted / measured.value
    text += (
        f"; identification from the modes gives "
        f"{with_sd(measured.value, measured.sd)} N/m; predicted / identified = "
        f"{ratio:.3g}."
    )
    if not 1 / 3 < ratio < 3:
        text += (
            " Asperity contact alone does not explain the joint: the compliance of "
            "bodies, bolts and waviness acts in series with it."
        )
    return text


def _links_table(joint: Identification) -> DataTable:
    rows = tuple(
        (
            one.name,
            parameter_text(one),
            one.unit,
            "yes" if one.identifiable else "no",
            one.reason,
        )
        for one in joint.parameters
    )
    return DataTable(
        f"Links identified from frequencies, damping and shapes (± one standard "
        f"deviation; admissible range if not identifiable): {joint.verdict.value}. "
        f"{'; '.join(joint.reasons)}",
        ("parameter", "value", "unit", "identifiable", "reason"),
        rows,
        frozenset({"no"}),
    )


def _fit_table(joint: Identification) -> DataTable:
    links = tuple(link.name for link in joint.model.links)
    rows = tuple(
        (
            str(number + 1),
            f"{measured:.4f}",
            f"{predicted:.4f}",
            f"{100 * (predicted / measured - 1):+.2g}",
            *(f"{100 * share:.1f}" for share in joint.energy_share[number]),
        )
        for number, (measured, predicted) in enumerate(
            zip(
                joint.measured_frequency,
                joint.solutions[0].natural_frequency,
                strict=True,
            )
        )
    )
    return DataTable(
        "Measured and identified modes, and the share of each link in the strain "
        "energy of a mode: a mode with a small share does not determine the link.",
        (
            "mode",
            "measured [Hz]",
            "identified [Hz]",
            "difference [%]",
            *(f"energy in {name} [%]" for name in links),
        ),
        rows,
    )
