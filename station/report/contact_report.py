# SPDX-License-Identifier: MIT
"""What ``jointbench contact`` shows: predictions, sweeps, and their report."""

from collections.abc import Sequence
from dataclasses import dataclass

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.registry import OWN_PACKAGE
from jointbench.acquisition.records.session import software_version
from jointbench.analysis.contact.model_catalogue import contact_law_package
from jointbench.analysis.contact.predict import DAMPING_REASON
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.station.contact.measured_prediction import MeasuredPrediction
from jointbench.station.contact.measured_section import measured_section
from jointbench.station.contact.measured_words import COLUMNS as LAW_COLUMNS
from jointbench.station.contact.measured_words import (
    law_rows,
    law_title,
    measured_json,
    surface_lines,
    verdict_lines,
)
from jointbench.station.drawing.palette import LAW, MEMBERS
from jointbench.station.files.input_files import read_surfaces
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.joints.measured_faces import predict_faces
from jointbench.station.pipeline.contact_options import ContactOptions
from jointbench.station.pipeline.contact_prediction import (
    ContactPoint,
    contact_json,
    predict_request,
    surface_of,
)
from jointbench.station.pipeline.contact_request import (
    ContactRequest,
    Sweep,
    parse_sweep,
    swept,
)
from jointbench.station.pipeline.roughness_words import contact_surface_words
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Report,
    Section,
    Text,
)
from jointbench.station.screen.terminal import console, table, working, write_json
from jointbench.station.screen.traces import line

LABELS = {
    "load": "preload [N]",
    "dimension": "fractal dimension of a profile [-]",
    "roughness": "fractal roughness G [m]",
}
COLUMNS = (
    "model",
    "preload [N]",
    "normal K [N/m]",
    "95 %",
    "tangential K [N/m]",
    "C [N s/m]",
    "real area [mm²]",
    "verdict",
)


@dataclass(frozen=True, slots=True)
class SweepRow:
    """One value of a swept input: the predictions, or the reason for refusal."""

    value: float
    points: tuple[ContactPoint, ...]
    refusal: str = ""


def run_contact(
    request: ContactRequest, given: ContactOptions
) -> tuple[ContactPoint, ...]:
    """Predict every model at every preload and along a sweep, and show the results."""
    files = given.surface or []
    check_outputs(files, [given.json, given.plot])
    sweep = None if given.sweep is None else parse_sweep(given.sweep)
    surface, measured = _surface(request, given)
    if surface is None and sweep is not None:
        raise BadData(
            f"--sweep varies a fractal law, and {measured and measured.no_fractal}; "
            "leave it out: --plot draws the laws of the spectrum over pressure"
        )
    points = () if surface is None else predict_request(request, surface)
    rows = (
        () if surface is None or sweep is None else run_sweep(request, surface, sweep)
    )
    if surface is not None:
        _show(points, surface, request, given.json)
    if measured is not None:
        _show_measured(measured, given.json)
    if sweep is not None:
        _show_sweep(sweep, rows, given.json)
    if given.plot is not None:
        swept_rows = None if sweep is None else (sweep, rows)
        write_report(contact_report(points, surface, swept_rows, measured), given.plot)
    laws = None if measured is None else measured_json(measured)
    content = contact_json(points, surface, laws)
    if sweep is not None:
        content["sweep"] = sweep_json(sweep, rows)
    write_json(given.json, content)
    return points


def _surface(
    request: ContactRequest, given: ContactOptions
) -> tuple[ContactSurface | None, MeasuredPrediction | None]:
    """Return D and G as given or measured, and the laws of measured spectra."""
    numbers = given.dimension is not None or given.roughness is not None
    if given.surface and not numbers:
        with working("fitting the surfaces"):
            read = read_surfaces(given.surface, columns=given.columns)
            found = predict_faces([surface for _, surface in read], request)
        return found.surface, found.measured
    surface = surface_of(
        given.dimension,
        given.roughness,
        given.surface or [],
        given.columns,
        dimension_sd=given.dimension_sd,
        roughness_sd=given.roughness_sd,
    )
    return surface, None


def _show_measured(found: MeasuredPrediction, json_target: str | None) -> None:
    screen = console(json_target)
    screen.print(table(law_title(found), LAW_COLUMNS, law_rows(found)))
    for said in (*surface_lines(found), *verdict_lines(found)):
        screen.print(f"  {said}", markup=False)


def run_sweep(
    request: ContactRequest, surface: ContactSurface, sweep: Sweep
) -> tuple[SweepRow, ...]:
    """Predict along a sweep; refused values keep a row with the reason."""
    rows = []
    for value in sweep.values:
        try:
            points = predict_request(*swept(request, surface, sweep.name, value))
        except BadData as error:
            rows.append(SweepRow(value, (), str(error)))
        else:
            rows.append(SweepRow(value, points))
    return tuple(rows)


def sweep_json(sweep: Sweep, rows: Sequence[SweepRow]) -> dict[str, object]:
    """Return a sweep as JSON."""
    return {
        "name": sweep.name,
        "label": LABELS[sweep.name],
        "rows": [
            {
                "value": row.value,
                "refused": row.refusal or None,
                "models": [
                    {
                        "name": point.state.model,
                        "normal_stiffness": point.state.normal_stiffness,
                        "damping": point.state.damping,
                        "verdict": point.state.verdict.value,
                    }
                    for point in row.points
                ],
            }
            for row in rows
        ],
    }


def contact_report(
    points: Sequence[ContactPoint],
    surface: ContactSurface | None,
    swept: tuple[Sweep, Sequence[SweepRow]] | None,
    measured: MeasuredPrediction | None = None,
) -> Report:
    """Arrange predictions and sweep as one offline report."""
    sections = [] if measured is None else [measured_section(measured)]
    if surface is not None:
        cells = tuple(tuple(row) for row in _rows(points))
        items: list[Item] = [DataTable("Predictions", COLUMNS, cells)]
        items += [Text(said, "notice") for said in surface.cautions]
        items += [Text(reason) for reason in _reasons(points)]
        sections.append(Section("points", "Predictions", tuple(items)))
    if swept is not None:
        sections.append(Section("sweep", "Sweep", _plots(*swept)))
    no_fractal = "" if measured is None else measured.no_fractal
    return Report(
        title="Contact of a rough joint",
        lead=f"No fractal law: {no_fractal}"
        if surface is None
        else contact_surface_words(surface),
        software=f"{software_version()}: contact",
        simulated=False,
        tiles=(),
        sections=tuple(sections),
    )


def _plots(sweep: Sweep, rows: Sequence[SweepRow]) -> tuple[Item, ...]:
    """Return stiffness, and damping where predicted, over the swept input."""
    kept = [row for row in rows if row.points]
    if not kept:
        return (Text(rows[0].refusal, "notice"),)
    x = axis(LABELS[sweep.name], log=sweep.name != "dimension")
    plots: list[Item] = []
    for name, key, title in (
        ("stiffness", "normal_stiffness", "normal stiffness [N/m]"),
        ("damping", "damping", "damping [N s/m]"),
    ):
        traces = [
            line(
                [row.value for row in kept],
                [getattr(row.points[i].state, key) or float("nan") for row in kept],
                f"{point.state.model}, {point.state.mode.value}",
                color=(LAW, *MEMBERS)[i % (1 + len(MEMBERS))],
            )
            for i, point in enumerate(kept[0].points)
            if key != "damping" or point.state.damping is not None
        ]
        if traces:
            picture = figure(traces, x, axis(title, log=True))
            plots.append(Plot(f"{name}-sweep", title.capitalize(), picture))
    refused = len(rows) - len(kept)
    if refused:
        plots.append(Text(f"{refused} values refused: {_first_refusal(rows)}"))
    return tuple(plots)


def _first_refusal(rows: Sequence[SweepRow]) -> str:
    return next((row.refusal for row in rows if row.refusal), "")


def _rows(points: Sequence[ContactPoint]) -> list[tuple[str, ...]]:
    return [
        (
            point.state.model,
            f"{point.state.preload:.6g}",
            f"{point.state.normal_stiffness:.4g}",
            _bounds(point),
            f"{point.state.tangential_stiffness:.4g}",
            "-" if point.state.damping is None else f"{point.state.damping:.4g}",
            f"{point.state.real_area * 1e6:.4g}",
            point.state.verdict.value,
        )
        for point in points
    ]


def _show(
    points: Sequence[ContactPoint],
    surface: ContactSurface,
    request: ContactRequest,
    json_target: str | None,
) -> None:
    screen = console(json_target)
    title = f"Contact at {contact_surface_words(surface)}"
    screen.print(table(title, COLUMNS, _rows(points)))
    for said in surface.cautions:
        screen.print(f"  {said}", markup=False)
    for reason in _reasons(points):
        screen.print(f"  {reason}", markup=False)
    if request.conditions.damping is None:
        screen.print(f"  {DAMPING_REASON}", markup=False)


def _reasons(points: Sequence[ContactPoint]) -> list[str]:
    """Return packages of models, every reason once, and the dominant uncertainty."""
    packages = {p.state.model: contact_law_package(p.state.model) for p in points}
    lines = [
        f"{name}: a model of package {package}"
        for name, package in packages.items()
        if package != OWN_PACKAGE
    ]
    lines += [reason for point in points for reason in point.state.reasons]
    for point in points:
        found = point.uncertainty
        if found is not None and (name := found.stiffness.dominant) is not None:
            share = found.stiffness.shares[name]
            lines.append(
                f"{point.state.model}: {name} dominates the uncertainty with "
                f"{share:.0%} of the variance of the stiffness"
            )
    return list(dict.fromkeys(lines))


def _show_sweep(
    sweep: Sweep, rows: Sequence[SweepRow], json_target: str | None
) -> None:
    screen = console(json_target)
    names = next((row.points for row in rows if row.points), ())
    heads = [LABELS[sweep.name]]
    for point in names:
        heads += [f"K {point.state.model} [N/m]", "C [N s/m]"]
    cells = []
    for row in rows:
        line_ = [f"{row.value:.5g}"]
        for point in row.points:
            damping = point.state.damping
            line_ += [
                f"{point.state.normal_stiffness:.4g}",
                "-" if damping is None else f"{damping:.4g}",
            ]
        cells.append(tuple(line_ + ["refused"] * (len(heads) - len(line_))))
    screen.print(table(f"Sweep of {sweep.name}", heads, cells))
    if refusal := _first_refusal(rows):
        screen.print(f"  {refusal}", markup=False)


def _bounds(point: ContactPoint) -> str:
    """Write an interval; a zero-width interval is left out."""
    interval = point.interval
    if interval.upper <= interval.lower * (1 + 1e-9):
        return "-"
    return f"{interval.lower:.3g}–{interval.upper:.3g}"
