# SPDX-License-Identifier: MIT
"""A joint as plain tables: its values with uncertainties, its pieces, its law."""

import csv
import io
from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.errors import FormatError
from jointbench.analysis.lumped.identified import JointParameter
from jointbench.analysis.structures.exchange.joint_pieces import (
    COMPONENTS,
    JointPiece,
)
from jointbench.analysis.structures.exchange.slip_law import SliderLaw, SpeedLaw

_UPPER = np.triu_indices(6)
_PAIRS = [f"{COMPONENTS[i]}*{COMPONENTS[j]}" for i, j in zip(*_UPPER, strict=True)]
_PLACES = ("x [m]", "y [m]", "z [m]")
_AXES = [f"{axis}_{k}" for axis in ("normal", "t1", "t2") for k in "xyz"]
_VALUES = ("parameter", "value", "sd", "low 95 %", "high 95 %", "unit", "identifiable")


def values_table(parameters: Sequence[JointParameter]) -> str:
    """Return value, standard deviation and 95 % interval of each parameter."""
    rows = [
        (
            one.name,
            _text(one.value),
            _text(one.sd),
            _text(one.interval[0]),
            _text(one.interval[1]),
            one.unit,
            "yes" if one.identifiable else "no",
        )
        for one in parameters
    ]
    return _table(_VALUES, rows)


def pieces_table(pieces: Sequence[JointPiece]) -> str:
    """Return centre, axes, area, and the upper triangles of K and C of each piece."""
    columns = ["piece", *_PLACES, *_AXES, "area [m^2]"]
    columns += [f"K {one}" for one in _PAIRS] + [f"C {one}" for one in _PAIRS]
    rows = [
        (
            piece.name,
            *map(_text, piece.centre.tolist()),
            *map(_text, piece.frame.ravel().tolist()),
            _text(piece.area),
            *map(_text, piece.stiffness[_UPPER].tolist()),
            *map(_text, piece.damping[_UPPER].tolist()),
        )
        for piece in pieces
    ]
    return _table(columns, rows)


def read_pieces_table(text: str) -> tuple[JointPiece, ...]:
    """Read `pieces_table` back.

    Raises:
        FormatError: the columns are others.
    """
    rows = list(csv.reader(io.StringIO(text)))
    width = 1 + 3 + 9 + 1 + 2 * len(_PAIRS)
    if not rows or any(len(row) != width for row in rows):
        raise FormatError(
            f"a table of pieces has {width} columns; write the file again"
        )
    found = []
    for row in rows[1:]:
        value = np.array([float(one) for one in row[1:]])
        k, c = value[13 : 13 + len(_PAIRS)], value[13 + len(_PAIRS) :]
        matrices = []
        for one in (k, c):
            whole = np.zeros((6, 6))
            whole[_UPPER] = one
            matrices.append(whole + np.triu(whole, 1).T)
        frame = value[3:12].reshape(3, 3)
        piece = JointPiece(row[0], value[:3], frame, float(value[12]), *matrices)
        found.append(piece)
    return tuple(found)


def law_table(law: SliderLaw | SpeedLaw, largest_speed: float) -> str:
    """Return sliders, or force over speed, of the whole joint in one direction."""
    if isinstance(law, SliderLaw):
        pairs = zip(law.stiffness.tolist(), law.slip_force.tolist(), strict=True)
        rows = [(str(at + 1), _text(k), _text(f)) for at, (k, f) in enumerate(pairs)]
        return _table(("slider", "stiffness [N/m]", "slip force [N]"), rows)
    speed, force = law.table(largest_speed)
    pairs = zip(speed.tolist(), force.tolist(), strict=True)
    return _table(
        ("speed [m/s]", "force [N]"), [(_text(v), _text(f)) for v, f in pairs]
    )


def _text(value: float | None) -> str:
    return "" if value is None else f"{value:.15g}"


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    return stream.getvalue()
