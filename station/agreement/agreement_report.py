# SPDX-License-Identifier: MIT
"""The report on a measured structure beside its model: MAC, differences, FRFs."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from jointbench.acquisition.records.session import software_version
from jointbench.analysis.structures.agreement.compare_structure import Agreement
from jointbench.station.agreement.agreement_text import (
    PAIR_COLUMNS,
    coordinate_rows,
    pair_rows,
    sentences,
)
from jointbench.station.drawing.palette import MEASURED, MODEL
from jointbench.station.joints.state_values import label_parts
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
from jointbench.station.screen.plot_numbers import numbers
from jointbench.station.screen.traces import line
from jointbench.station.screen.value_text import engineering

_MOST_FRFS = 9


def write_agreement_report(
    path: Path,
    name: str,
    results: Mapping[str, Agreement],
    *,
    simulated: bool = False,
) -> None:
    """Write one offline HTML report, a section for each state.

    Args:
        path: to write.
        name: of the model.
        results: by state.
        simulated: whether a session was.
    """
    sections = [
        Section(f"state-{at}", _heading(label), tuple(_items(at, one)))
        for at, (label, one) in enumerate(results.items())
    ]
    report = Report(
        title=f"Agreement of {name} with the measurement",
        lead="Measured and computed modes and FRFs at the same points, along the same "
        "directions.",
        software=software_version(),
        simulated=simulated,
        tiles=tuple(_tiles(next(iter(results.values())))),
        sections=tuple(sections),
    )
    write_report(report, path)


def _heading(label: str) -> str:
    """Return the label of a state, ``session@25000N``, in words."""
    name, preload = label_parts(label)
    return name if preload is None else f"{name} at {engineering(preload, 'N')}"


def _tiles(one: Agreement) -> list[Tile]:
    worst = max((abs(p.frequency) for p in one.pairs), default=np.nan)
    least = min((p.mac for p in one.pairs), default=np.nan)
    count = f"{len(one.pairs)} of {one.measured.frequency.size}"
    return [
        Tile("modes paired", count),
        Tile("largest frequency difference", f"{100 * worst:.2f} %"),
        Tile("smallest MAC", f"{least:.3f}"),
        Tile("smallest FRAC", f"{float(one.frac.min()):.3f}"),
        Tile("coordinates suspected", str(len(one.suspects))),
    ]


def _items(at: int, one: Agreement) -> list[Item]:
    words = sentences(one)
    items: list[Item] = [
        Text(word, "notice") if one.suspects else Text(word) for word in words
    ]
    caption = "Computed less measured, with 95 % intervals."
    columns, cells = coordinate_rows(one)
    items += [
        Plot(f"mac-{at}", "MAC of measured and computed modes", _mac(one), 420),
        DataTable(caption, PAIR_COLUMNS, tuple(pair_rows(one))),
        Plot(f"differences-{at}", caption, _differences(one), 320),
        DataTable(
            "CoMAC is 1 and ECOMAC 0 where shapes agree; ECOMAC feels the sign.",
            columns,
            tuple(cells),
        ),
    ]
    pairs = [(i, j) for i in range(len(one.outputs)) for j in range(len(one.inputs))]
    worst = sorted(pairs, key=lambda pair: float(one.frac[pair]))[:_MOST_FRFS]
    items += [
        Plot(
            f"frf-{at}-{i}-{j}",
            f"{one.outputs[i]}, hit {one.inputs[j]}: FRAC {one.frac[i, j]:.3f}",
            _frf(one, i, j),
            260,
        )
        for i, j in worst
    ]
    return items


def _mac(one: Agreement) -> Figure:
    """Return the MAC as a map with its values."""
    rows = [f"{value:.0f} Hz" for value in one.measured.frequency]
    columns = [f"{value:.0f} Hz" for value in one.computed.frequency]
    trace = {
        "type": "heatmap",
        "x": [f"{at + 1}: {text}" for at, text in enumerate(columns)],
        "y": [f"{at + 1}: {text}" for at, text in enumerate(rows)],
        "z": [numbers(row) for row in one.mac],
        "text": [[f"{value:.2f}" for value in row] for row in one.mac],
        "texttemplate": "%{text}",
        "textfont": {"size": 10},
        "colorscale": "Viridis",
        "zmin": 0,
        "zmax": 1,
        "colorbar": {"title": {"text": "MAC"}, "thickness": 12},
    }
    x, y = axis("computed", type="category"), axis("measured", type="category")
    return figure([trace], x, y | {"autorange": "reversed"})


def _differences(one: Agreement) -> Figure:
    """Return relative frequency differences with their intervals."""
    at = [one.measured.frequency[pair.measured] for pair in one.pairs]
    value = np.array([pair.frequency for pair in one.pairs])
    ends = np.array([pair.frequency_interval for pair in one.pairs]).reshape(-1, 2)
    trace = {
        "type": "scatter",
        "mode": "markers",
        "name": "frequency",
        "x": numbers(at),
        "y": numbers(100 * value),
        "error_y": {
            "array": numbers(100 * (ends[:, 1] - value)),
            "arrayminus": numbers(100 * (value - ends[:, 0])),
            "symmetric": False,
        },
        "marker": {"color": MODEL, "size": 8},
    }
    x = axis("measured natural frequency [Hz]")
    return figure([trace], x, axis("computed over measured - 1 [%]", zeroline=True))


def _frf(one: Agreement, i: int, j: int) -> Figure:
    curves = [
        line(one.frequency, np.abs(one.measured_frf[i, j]), "measured", color=MEASURED),
        line(
            one.frequency,
            np.abs(one.computed_frf[i, j]),
            "computed",
            color=MODEL,
            dash="dash",
        ),
    ]
    height = axis(f"{one.kind.value} [{one.kind.unit}]", log=True)
    return figure(curves, axis("frequency [Hz]"), height)
