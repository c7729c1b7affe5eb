# SPDX-License-Identifier: MIT
"""Geometry of a measurement from universal files: nodes, lines, elements, units.

Data sets 15 and 2411 hold nodes, 82 trace lines, 2412 elements, whose edges are drawn,
and 164 the units. Only what draws mode shapes is read.

Source:
    Structural Dynamics Research Laboratory, University of Cincinnati, Universal File
    Formats, data sets 15, 82, 164, 2411 and 2412.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import read_bytes

_EDGE = "    -1"
_MOST_BYTES = 2**28
_MOST_NODES, _MOST_LINES = 100_000, 400_000
_GLOBAL = (0, 1)
"""Coordinate systems whose axes are those of the file."""
_BEAMS = frozenset((11, 21, 22, 23, 24))
"""Elements of lines, with a record of their orientation."""
_SHELLS = frozenset((41, 42, 43, 44, 45, 46, 91, 92, 93, 94, 95, 96))
_SOLIDS = {
    111: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    112: ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    115: (
        *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
        *((0, 4), (1, 5), (2, 6), (3, 7)),
    ),
}
"""Edges of tetrahedron, wedge and brick between their corners."""
Place = tuple[float, float, float]
Line = tuple[str, str]


@dataclass(frozen=True, slots=True)
class UniversalGeometry:
    """Nodes and lines of a universal file.

    Attributes:
        points: place of each node by its number [m where `units_stated`].
        lines: pairs of nodes, each once.
        units_stated: whether the file has units (data set 164).
    """

    points: dict[str, Place]
    lines: tuple[Line, ...]
    units_stated: bool


def read_universal_geometry(path: Path) -> UniversalGeometry:
    """Read nodes and lines of a universal file.

    Args:
        path: of the file.

    Returns:
        Nodes in metres where data set 164 states the units, else as they stand. Lines
        of nodes that are not there are left out.

    Raises:
        FormatError: there is no node, or a data set is damaged.
        HostileFile: there are more nodes than any measurement has.
    """
    points: dict[str, Place] = {}
    lines: dict[Line, None] = {}
    factor: float | None = None
    for kind, rows in _sets(path):
        try:
            if kind in _NODES:
                points |= dict(_NODES[kind](path, rows))
            elif kind in _LINES:
                lines |= dict.fromkeys(_LINES[kind](rows))
            elif kind == "164":
                factor = _length_factor(rows)
        except (ValueError, IndexError, OverflowError) as error:
            raise FormatError(
                f"{named(path)}: data set {kind} is damaged ({shown(error)}); use "
                "another copy"
            ) from error
        if len(points) > _MOST_NODES or len(lines) > _MOST_LINES:
            raise HostileFile(
                f"{named(path)} has {len(points)} nodes and {len(lines)} lines; export "
                "the measured points alone"
            )
    if not points:
        raise FormatError(
            f"{named(path)} holds no nodes (data sets 15 and 2411); give a file with "
            "the geometry of the measurement"
        )
    scale = 1.0 if factor is None else 1.0 / factor
    return UniversalGeometry(
        {name: (x * scale, y * scale, z * scale) for name, (x, y, z) in points.items()},
        tuple(line for line in lines if line[0] in points and line[1] in points),
        factor is not None,
    )


def holds_geometry(path: Path) -> bool:
    """Return whether a universal file has nodes; nothing is checked."""
    return any(kind in _NODES for kind, _ in _sets(path))


def _sets(path: Path) -> Iterator[tuple[str, list[str]]]:
    """Yield number and lines of each data set; binary ones are cut off unread."""
    text = read_bytes(path, limit=_MOST_BYTES).decode("latin-1")
    rows: list[str] | None = None
    for row in text.splitlines():
        if row.rstrip() == _EDGE:
            if rows is not None and len(rows) > 1:
                yield rows[0].split()[0] if rows[0].split() else "", rows[1:]
            rows = [] if rows is None else None
        elif rows is not None:
            rows.append(row)


def _whole(text: str) -> list[int]:
    return [int(word) for word in text.split()]


def _number(text: str) -> float:
    value = float(text.replace("D", "E").replace("d", "e"))
    if not math.isfinite(value):
        raise ValueError(f"{text.strip()} is no coordinate")
    return value


def _node(path: Path, head: Sequence[int], place: Sequence[str]) -> tuple[str, Place]:
    number, system = head[0], head[1]
    if system not in _GLOBAL:
        raise FormatError(
            f"{named(path)}: node {number} is in coordinate system {system}; export "
            "the geometry in the global one"
        )
    x, y, z = map(_number, place)
    return str(number), (x, y, z)


def _nodes_15(path: Path, rows: Sequence[str]) -> Iterator[tuple[str, Place]]:
    for row in rows:
        words = row.split()
        if len(words) == 7:
            yield _node(path, _whole(" ".join(words[:4])), words[4:])
        else:  # numbers without blanks between them, in columns
            head = [int(row[i : i + 10]) for i in range(0, 40, 10)]
            yield _node(path, head, [row[i : i + 13] for i in range(40, 79, 13)])


def _nodes_2411(path: Path, rows: Sequence[str]) -> Iterator[tuple[str, Place]]:
    if len(rows) % 2:
        raise ValueError(f"{len(rows)} records, each node has two")
    for head, place in zip(rows[::2], rows[1::2], strict=True):
        words = place.split()
        if len(words) != 3:
            words = [place[i : i + 25] for i in range(0, 75, 25)]
        yield _node(path, _whole(head), words)


def _trace(rows: Sequence[str]) -> Iterator[Line]:
    """Yield the lines of data set 82; a zero lifts the pen."""
    count = _whole(rows[0])[1]
    nodes = [node for row in rows[2:] for node in _whole(row)]
    if len(nodes) < count:
        raise ValueError(f"{count} nodes claimed, {len(nodes)} there")
    for one, other in pairwise(nodes[:count]):
        if one and other:
            yield str(one), str(other)


def _elements(rows: Sequence[str]) -> Iterator[Line]:
    """Yield the edges of the elements of data set 2412."""
    at = 0
    while at < len(rows):
        _, kind, *_, count = _whole(rows[at])
        at += 2 if kind in _BEAMS else 1
        nodes: list[int] = []
        while len(nodes) < count:
            nodes += _whole(rows[at])
            at += 1
        yield from _edges(kind, [str(node) for node in nodes[:count]])


def _edges(kind: int, nodes: Sequence[str]) -> Iterator[Line]:
    if kind in _SHELLS:
        yield from pairwise([*nodes, nodes[0]])
    elif kind in _SOLIDS:
        yield from ((nodes[a], nodes[b]) for a, b in _SOLIDS[kind])
    elif kind in _BEAMS:
        yield from pairwise(nodes)


def _length_factor(rows: Sequence[str]) -> float:
    words = rows[1].split()
    factor = _number(words[0] if len(words) >= 3 else rows[1][:25])
    if not factor > 0.0:
        raise ValueError(f"length factor {factor:g}")
    return factor


_NODES: dict[str, Callable[[Path, Sequence[str]], Iterator[tuple[str, Place]]]] = {
    "15": _nodes_15,
    "2411": _nodes_2411,
}
_LINES: dict[str, Callable[[Sequence[str]], Iterator[Line]]] = {
    "82": _trace,
    "2412": _elements,
}
