# SPDX-License-Identifier: MIT
"""``jointbench pressure-map``: contact patch and pressures of measured maps."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.records.session import software_version
from jointbench.acquisition.records.surfaces import Areal
from jointbench.analysis.contact.half_space.contact_patch import (
    ContactPatch,
    contact_patch,
)
from jointbench.analysis.contact.half_space.mated_heights import (
    LEAST_POINTS,
    MatedHeights,
    mated_heights,
)
from jointbench.station.contact.pressure_map_options import PressureMapOptions
from jointbench.station.files.input_files import read_surfaces
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.pipeline.contact_request import parse_hardness
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
from jointbench.station.screen.traces import heatmap
from jointbench.station.screen.value_text import engineering

COLUMNS = (
    "pressure",
    "patch [%]",
    "real area [%]",
    "largest",
    "gap",
    "k [N/m³]",
    "waviness k [N/m³]",
    "roughness k [N/m³]",
)
_SIDES = 2
_PICTURE = 160
"""Most points of a side of a picture [-]."""
_YIELDING = 0.05
"""Share of the load above the hardness from which a line names it [-]."""


def run_pressure_map(given: PressureMapOptions) -> tuple[ContactPatch, ...]:
    """Solve the contact of measured maps at every pressure, and show the results.

    Raises:
        UsageError: more than two maps, a profile, or a turn that is no quarter.
        BadData: a file cannot be read, or the maps have too few points in common.
    """
    check_outputs(given.maps, [given.json, given.plot])
    if given.points < LEAST_POINTS:
        raise UsageError(f"--points is {given.points}; give at least {LEAST_POINTS}")
    modulus = _positive("--modulus", parse_value(given.modulus, "pressure"))
    hardness = _positive("--hardness", parse_hardness(given.hardness))
    cutoff = _positive("--cutoff", parse_value(given.cutoff, "length"))
    pressures = [
        _positive("--pressure", parse_value(text, "pressure"))
        for text in given.pressure
    ]
    maps = _maps(given)
    mated = mated_heights(
        maps[0],
        maps[1] if len(maps) == _SIDES else None,
        turn=given.turn,
        most_points=given.points,
    )
    found = []
    for text, pressure in zip(given.pressure, pressures, strict=True):
        with working(f"solving the contact at {text}"):
            found.append(
                contact_patch(
                    mated,
                    pressure * mated.area,
                    modulus=modulus,
                    hardness=hardness,
                    cutoff=cutoff,
                )
            )
    lines = _lines(maps, mated, found, cutoff)
    _show(mated, found, lines, given.json)
    if given.plot is not None:
        write_report(_report(mated, found, lines), given.plot)
    write_json(given.json, _plain(maps, mated, found, lines))
    return tuple(found)


def _positive(option: str, value: float) -> float:
    if not value > 0:
        raise BadData(f"{option} is {value:g}; it must be positive")
    return value


def _maps(given: PressureMapOptions) -> list[Areal]:
    maps = []
    for path, surface in read_surfaces(given.maps, columns=given.columns):
        if not isinstance(surface, Areal):
            raise UsageError(
                f"{path.name} is a profile, and pressures need maps; 'jointbench "
                "contact' has laws for profiles"
            )
        maps.append(surface)
    if len(maps) > _SIDES:
        raise UsageError(f"{len(maps)} maps for one joint; give one or two")
    return maps


def _rows(mated: MatedHeights, found: Sequence[ContactPatch]) -> list[tuple[str, ...]]:
    return [
        (
            engineering(one.load / mated.area, "Pa"),
            f"{100 * one.patch:.3g}",
            f"{100 * one.real_area:.3g}",
            engineering(float(one.pressure.max()), "Pa"),
            engineering(one.mean_gap, "m"),
            *(
                f"{1 / (part * mated.area):.3g}" if part > 0 else "-"
                for part in (one.compliance, one.wavy_compliance, one.rough_compliance)
            ),
        )
        for one in found
    ]


def _lines(
    maps: Sequence[Areal],
    mated: MatedHeights,
    found: Sequence[ContactPatch],
    cutoff: float,
) -> list[str]:
    names = " on ".join(one.name for one in maps[::-1])
    size = " x ".join(
        engineering(n * s, "m")
        for n, s in zip(mated.heights.shape, mated.spacing, strict=True)
    )
    height = engineering(float(mated.heights.std()), "m")
    finest = engineering(2 * max(mated.spacing), "m")
    lines = [
        f"{names}: {size}, h_rms = {height} together, form and waviness kept; repeated "
        "at its edges; elastic",
        f"waviness: waves longer than {engineering(cutoff, 'm')}. Its compliance is "
        "the constriction of the bodies below the patches: a structure model whose "
        "mesh resolves these waves has it already, and takes the roughness alone",
        f"waves shorter than {finest} are not in the map: their compliance is the "
        "smaller part, their real area is not",
        *mated.remarks,
    ]
    for one in found:
        if one.above_hardness > _YIELDING:
            lines.append(
                f"at {engineering(one.load / mated.area, 'Pa')}: "
                f"{100 * one.above_hardness:.0f} % of the load is above the hardness: "
                "summits yield, the real area is larger than stated"
            )
    return lines


def _show(
    mated: MatedHeights,
    found: Sequence[ContactPatch],
    lines: Sequence[str],
    json_target: str | None,
) -> None:
    screen = console(json_target)
    title = "Contact of measured maps, per area of the map"
    screen.print(table(title, COLUMNS, _rows(mated, found)))
    for said in lines:
        screen.print(f"  {said}", markup=False)


def _report(
    mated: MatedHeights, found: Sequence[ContactPatch], lines: Sequence[str]
) -> Report:
    rows = tuple(_rows(mated, found))
    items: list[Item] = [DataTable("Contact, per area of the map", COLUMNS, rows)]
    items += [Text(said) for said in lines]
    items += [_picture(mated, one, k) for k, one in enumerate(found)]
    return Report(
        title="Contact of measured maps",
        lead=lines[0],
        software=f"{software_version()}: pressure-map",
        simulated=False,
        tiles=(),
        sections=(Section("pressures", "Contact patch and pressures", tuple(items)),),
    )


def _picture(mated: MatedHeights, one: ContactPatch, k: int) -> Plot:
    """Return pressures averaged over blocks, in MPa."""
    block = int(np.ceil(max(one.pressure.shape) / _PICTURE))
    shown = _averaged(one.pressure, block) / 1e6
    y, x = (
        1e3 * (np.arange(n) + 0.5) * s * block
        for n, s in zip(shown.shape, mated.spacing, strict=True)
    )
    nominal = engineering(one.load / mated.area, "Pa")
    return Plot(
        f"pressures-{k}",
        f"Pressure at {nominal} nominal, averaged over {block} x {block} points.",
        figure(
            [heatmap(x, y, shown, "MPa")],
            axis("x [mm]"),
            axis("y [mm]", scaleanchor="x", autorange="reversed"),
        ),
        height=560,
    )


def _averaged(field: FloatArray, block: int) -> FloatArray:
    rows, columns = (n // block for n in field.shape)
    kept = field[: rows * block, : columns * block]
    mean: FloatArray = kept.reshape(rows, block, columns, block).mean(axis=(1, 3))
    return mean


def _plain(
    maps: Sequence[Areal],
    mated: MatedHeights,
    found: Sequence[ContactPatch],
    lines: Sequence[str],
) -> dict[str, object]:
    return {
        "maps": [one.name for one in maps],
        "area_m2": mated.area,
        "points": list(mated.heights.shape),
        "spacing_m": list(mated.spacing),
        "height_rms_m": float(mated.heights.std()),
        "states": [
            {
                "pressure_Pa": one.load / mated.area,
                "patch_share": one.patch,
                "real_area_share": one.real_area,
                "largest_pressure_Pa": float(one.pressure.max()),
                "mean_gap_m": one.mean_gap,
                "load_share_above_hardness": one.above_hardness,
                "compliance_times_area": one.compliance * mated.area,
                "waviness_compliance_times_area": one.wavy_compliance * mated.area,
                "roughness_compliance_times_area": one.rough_compliance * mated.area,
            }
            for one in found
        ],
        "lines": list(lines),
    }
