# SPDX-License-Identifier: MIT
"""The report on a joint over its assemblies: measured values and the next assembly."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.records.session import software_version
from jointbench.analysis.gap.contact_bench.joint_states import ContactQuantity
from jointbench.analysis.gap.reassembly.changed_joint import (
    QuantityOverAssemblies,
    Reassembly,
)
from jointbench.station.drawing.palette import GUIDE, MEASURED, MODEL
from jointbench.station.reassembly.reassembly_text import (
    SCATTER_COLUMNS,
    headline,
    level_unit,
    next_columns,
    next_rows,
    remedy,
    scatter_rows,
    unit_of,
)
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Report,
    Section,
    Text,
    Tile,
)
from jointbench.station.screen.traces import band, line, markers

_SHADE = MODEL


def write_reassembly_report(path: Path, name: str, found: Reassembly) -> None:
    """Write one offline HTML report.

    Args:
        path: to write.
        name: of the joint.
        found: joint over its assemblies.
    """
    words: list[Item] = [Text(headline(found))]
    if remedy(found):
        words.append(Text(remedy(found), "notice"))
    plots: list[Item] = [
        Plot(
            f"over-{key}",
            f"{key}: measured (95 %), and where the next assembly is expected (95 %)",
            _figure(key, one, found),
        )
        for key, one in found.quantities.items()
    ]
    tables: list[Item] = [
        DataTable("Scatter", SCATTER_COLUMNS, tuple(scatter_rows(found))),
        DataTable("The next assembly", next_columns(found), tuple(next_rows(found))),
    ]
    sections = (Section("assemblies", "Assemblies", (*words, *plots, *tables)),)
    report = Report(
        title=f"{name} over its assemblies",
        lead="How much the joint scatters when it is put together again, what the next "
        "assembly will show, and whether the latest differs.",
        software=software_version(),
        simulated=False,
        tiles=tuple(_tiles(found)),
        sections=sections,
    )
    write_report(report, path)


def _tiles(found: Reassembly) -> list[Tile]:
    tiles = [Tile("joint", found.change.value)]
    for key, one in found.quantities.items():
        middle, low, high = one.scatter.interval("between")
        note = f"{100 * low:.2g} to {100 * high:.2g} %"
        tiles.append(Tile(f"{key}, re-assembly", f"{100 * middle:.2g} %", note))
    return tiles


def _figure(
    key: ContactQuantity, one: QuantityOverAssemblies, found: Reassembly
) -> Figure:
    middle, low, high = one.next_assembly
    traces = band(one.level, low, high, "next assembly, 95 %", color=_SHADE)
    traces.append(line(one.level, middle, "its median"))
    rows = one.rows
    sd = np.sqrt(np.diag(rows.covariance))
    for k, number in enumerate(rows.assemblies):
        own = rows.assembly == number
        latest = number == rows.assemblies[-1]
        value = np.exp(rows.value[own])
        traces.append(
            markers(
                rows.level[own],
                value,
                "latest assembly" if latest else f"assembly {k + 1}",
                color=MEASURED if latest else GUIDE,
                error=1.96 * sd[own] * value,
            )
        )
    x = axis(f"level [{level_unit(found)}]", log=True)
    return figure(traces, x, axis(f"{key} [{unit_of(key)}]", log=True))
