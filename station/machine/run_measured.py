# SPDX-License-Identifier: MIT
"""``jointbench machine`` of bodies that were struck alone."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.session import software_version
from jointbench.analysis.structures.measured.coupled_measurements import (
    CoupledModes,
    coupled_modes,
    frf_block,
)
from jointbench.analysis.structures.measured.frf_coupling import (
    FrfBlock,
    FrfLink,
    couple_frfs,
)
from jointbench.signal.frf.frf import Frf
from jointbench.station.drawing.palette import MODEL
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.toml_file import read_toml
from jointbench.station.machine.measured_bodies import read_body
from jointbench.station.machine.measured_tables import (
    GROUND,
    MeasuredMachine,
)
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import DataTable, Item, Plot, Report, Section
from jointbench.station.screen.terminal import console, table, working, write_json
from jointbench.station.screen.traces import band, line
from jointbench.station.screen.value_text import with_sd

_Labels = Mapping[str, Sequence[str]]
_COLUMNS = ("mode", "frequency [Hz]", "damping [%]")
_TITLE = "Modes of the coupled bodies (± one standard deviation)"
_WIDE = 1.96


def run_measured(
    model: Path, *, report: Path | None, json_target: str | None
) -> CoupledModes:
    """Couple measured bodies, show and write modes and FRFs.

    Args:
        model: the file.
        report: HTML report to write.
        json_target: JSON to write.

    Returns:
        The modes.
    """
    settings = read_toml(model, MeasuredMachine)
    files = [model.parent / f for one in settings.measured.values() for f in one.frfs]
    check_outputs([model, *files], [json_target, report])
    with working("reading and fitting FRFs, coupling bodies"):
        found = [
            frf_block(name, read_body(name, one, model.parent))
            for name, one in settings.measured.items()
        ]
        blocks = [block for block, _ in found]
        labels = {block.name: names for block, names in found}
        links = _links(settings, labels)
        modes = coupled_modes(blocks, links, settings.band, draws=settings.draws)
        frf = _coupled_frf(settings, blocks, links, labels)
    screen = console(json_target)
    screen.print(table(_TITLE, _COLUMNS, _rows(modes)))
    for remark in modes.remarks:
        screen.print(f"Remark: {remark}")
    write_json(json_target, _json(modes, frf, settings.points))
    if report is not None:
        _write_report(report, model.name, modes, frf, settings.points)
    return modes


def _links(settings: MeasuredMachine, labels: _Labels) -> list[FrfLink]:
    found = []
    for name, one in settings.links.items():
        first, second = one.between
        if first == GROUND:
            raise UsageError(f"link {name!r}: write {GROUND!r} as the second side")
        other = None if second == GROUND else _point(second, labels)
        found.append(FrfLink(_point(first, labels), other, one.stiffness, one.damping))
    return found


def _point(text: str, labels: _Labels) -> tuple[str, int]:
    """Return the body and the number of the point of ``"body:point"``."""
    body, _, label = text.partition(":")
    if body not in labels:
        raise UsageError(
            f"{text!r}: no body {body!r}; write body:point with one of {list(labels)}"
        )
    if label not in labels[body]:
        raise UsageError(
            f"{text!r}: body {body!r} has the points {list(labels[body])}, as its FRFs "
            "are labelled"
        )
    return body, list(labels[body]).index(label)


def _coupled_frf(
    settings: MeasuredMachine,
    blocks: Sequence[FrfBlock],
    links: Sequence[FrfLink],
    labels: _Labels,
) -> Frf:
    return couple_frfs(blocks, links, [_point(one, labels) for one in settings.points])


def _rows(modes: CoupledModes) -> list[tuple[str, str, str]]:
    return [
        (str(at + 1), with_sd(*frequency), with_sd(*damping))
        for at, (frequency, damping) in enumerate(
            zip(
                zip(modes.frequency, modes.frequency_sd, strict=True),
                zip(100 * modes.damping_ratio, 100 * modes.damping_sd, strict=True),
                strict=True,
            )
        )
    ]


def _json(modes: CoupledModes, frf: Frf, points: Sequence[str]) -> dict[str, Any]:
    return {
        "modes": [
            {
                "frequency_hz": float(frequency),
                "frequency_sd_hz": float(modes.frequency_sd[at]),
                "damping_ratio": float(modes.damping_ratio[at]),
                "damping_ratio_sd": float(modes.damping_sd[at]),
            }
            for at, frequency in enumerate(modes.frequency)
        ],
        "remarks": list(modes.remarks),
        "points": list(points),
        "frequency_hz": frf.frequency.tolist(),
        "size_m_per_n": {
            f"{out}/{into}": np.abs(frf.response[i, j]).tolist()
            for i, out in enumerate(points)
            for j, into in enumerate(points)
        },
    }


def _write_report(
    path: Path, name: str, modes: CoupledModes, frf: Frf, points: Sequence[str]
) -> None:
    plots: list[Item] = [_plot(frf, at, one) for at, one in enumerate(points)]
    sections = (
        Section("modes", "Modes", (DataTable(_TITLE, _COLUMNS, tuple(_rows(modes))),)),
        Section("frfs", "FRFs", tuple(plots)),
    )
    lead = "Bodies that were struck alone, joined by springs and dampers."
    write_report(
        Report(f"Machine {name}", lead, software_version(), False, (), sections), path
    )


def _plot(frf: Frf, at: int, name: str) -> Plot:
    """Return a direct FRF with its 95 % interval."""
    size = 1e9 * np.abs(frf.response[at, at])
    traces = []
    if frf.variance is not None:
        wide = 1e9 * _WIDE * np.sqrt(frf.variance[at, at] / 2.0)
        low = np.maximum(size - wide, 1e-3 * size)
        traces += band(frf.frequency, low, size + wide, "95 %", color=MODEL)
    traces.append(line(frf.frequency, size, "coupled", color=MODEL))
    plot = figure(traces, axis("frequency [Hz]"), axis("receptance [nm/N]", log=True))
    return Plot(f"frf-{at}", f"{name} to {name}, line by line", plot)
