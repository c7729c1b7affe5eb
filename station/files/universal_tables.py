# SPDX-License-Identifier: MIT
"""What a universal file of others holds, as tables: functions, mode shapes, header."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.samples.universal import read_universal_sets
from jointbench.station.files.table_files import ExportColumn, ExportTable

_FUNCTIONS = {
    **{1: "time_response", 2: "auto_spectrum", 3: "cross_spectrum", 4: "frf"},
    **{6: "coherence", 9: "psd", 10: "esd"},
}
_AXES = {17: ("time", "s"), 18: ("frequency", "Hz")}
_DIRECTIONS = {0: "", 1: "+x", -1: "-x", 2: "+y", -2: "-y", 3: "+z", -3: "-z"}
_NORMAL, _COMPLEX = 2, 3
_COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")
Set = Mapping[str, Any]


def universal_tables(path: Path) -> list[ExportTable]:
    """Return functions on one axis, modes on the same nodes, and the header as tables.

    Raises:
        FormatError: it is no universal file, is damaged, or holds nothing of these.
        HostileFile: a header claims more than the file holds.
    """
    sets = read_universal_sets(path, kinds=(55, 58, 151))
    try:
        tables = [*_header(sets), *_functions(sets), *_modes(sets)]
    except (ArithmeticError, KeyError, TypeError, ValueError) as error:
        raise FormatError(
            f"{named(path)}: a data set is damaged ({shown(error)}); use another copy"
        ) from error
    if not tables:
        raise FormatError(f"{named(path)} holds no data set 55, 58 or 151")
    return tables


def _of(sets: Sequence[Set], kind: int) -> list[Set]:
    return [one for one in sets if int(one["type"]) == kind]


def _header(sets: Sequence[Set]) -> Iterator[ExportTable]:
    rows = [
        (name, str(value).strip())
        for one in _of(sets, 151)
        for name, value in one.items()
        if name != "type"
    ]
    if rows:
        columns = zip(("name", "value"), zip(*rows, strict=True), strict=True)
        texts = {
            n: ExportColumn("", np.array(v, np.str_), ("fact",)) for n, v in columns
        }
        yield ExportTable("header", texts)


def _functions(sets: Sequence[Set]) -> Iterator[ExportTable]:
    """Yield a table for each kind of function and axis; a column each function."""
    groups: dict[tuple[str, str, bytes], dict[str, ExportColumn]] = {}
    for one in _of(sets, 58):
        axis = np.asarray(one["x"], dtype=np.float64)
        kind = _FUNCTIONS.get(int(one["func_type"]), f"function_{one['func_type']}")
        along, unit = _AXES.get(int(one["abscissa_spec_data_type"]), ("x", ""))
        unit = unit or _text(one, "abscissa_axis_units_lab")
        start = {along: ExportColumn(unit, axis, (along,))}
        columns = groups.setdefault((kind, along, axis.tobytes()), start)
        name, data = _free(_place(one), columns), np.asarray(one["data"])
        columns[name] = ExportColumn(
            _text(one, "ordinate_axis_units_lab"), data, (along,)
        )
    for number, ((kind, _, _), columns) in enumerate(groups.items(), 1):
        yield ExportTable(f"{kind}-{number}" if len(groups) > 1 else kind, columns)


def _text(one: Set, name: str) -> str:
    text = str(one.get(name) or "").strip()
    return "" if text.upper() == "NONE" else text


def _place(one: Set) -> str:
    """Name a function by its response and its reference."""
    words = []
    for side in ("rsp", "ref"):
        node = str(one.get(f"{side}_node") or "")
        way = _DIRECTIONS.get(int(one.get(f"{side}_dir") or 0), "")
        words.append(f"{_text(one, f'{side}_ent_name')} {node}{way}".strip())
    return "/".join(word for word in words if word) or "function"


def _free(name: str, taken: Mapping[str, object]) -> str:
    wanted, number = name, 2
    while name in taken:
        name, number = f"{wanted} ({number})", number + 1
    return name


def _modes(sets: Sequence[Set]) -> Iterator[ExportTable]:
    """Yield a table for all modes on the same nodes."""
    groups: dict[bytes, list[Set]] = {}
    for one in _of(sets, 55):
        if "r1" in one and len(one["node_nums"]):
            nodes = np.asarray(one["node_nums"], dtype=np.int64)
            groups.setdefault(nodes.tobytes(), []).append(one)
    for number, group in enumerate(groups.values(), 1):
        poles = np.array([_pole(one) for one in group]).T
        names = [name for name in _COMPONENTS if _component(group[0], name) is not None]
        shapes = [[_component(one, name) for name in names] for one in group]
        columns = {
            "natural_frequency": ExportColumn("Hz", poles[0], ("mode",)),
            "damping_ratio": ExportColumn("1", poles[1], ("mode",)),
            "shape": ExportColumn("", np.array(shapes), ("mode", "component", "node")),
        }
        places = [str(int(node)) for node in group[0]["node_nums"]]
        title = "modes" if len(groups) == 1 else f"modes-{number}"
        yield ExportTable(title, columns, {"node": places, "component": names})


def _component(one: Set, name: str) -> Any:
    return one.get(f"r{_COMPONENTS.index(name) + 1}")


def _pole(one: Set) -> tuple[float, float]:
    """Return natural frequency [Hz] and damping ratio; NaN where it is no mode."""
    kind = int(one["analysis_type"])
    if kind == _COMPLEX:
        pole = complex(one["eig"])
        size = abs(pole)
        return size / (2.0 * np.pi), -pole.real / size if size else np.nan
    if kind == _NORMAL:
        return float(one["freq"]), float(one["modal_damp_vis"])
    return np.nan, np.nan
