# SPDX-License-Identifier: MIT
"""A joint's pieces as Ansys commands: MATRIX27, or COMBIN14 with COMBIN40 sliders.

Source: Ansys Mechanical APDL Element Reference, MATRIX27 (upper triangle by rows,
KEYOPT(3) 4 stiffness and 5 damping), COMBIN14 (KEYOPT(2) 1 to 6), COMBIN40 (FSLIDE).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError
from jointbench.analysis.structures.exchange.joint_pieces import (
    JointPiece,
    PieceRead,
    turned,
)
from jointbench.analysis.structures.exchange.slip_law import SliderLaw

# Far above the numbers of a model that the file is read into.
_FIRST = 900001
_STIFFNESS, _DAMPING, _SLIDER = 4, 5, 40
_PER_LINE = 6
_UPPER = np.triu_indices(12)


def matrix27_text(pieces: Sequence[JointPiece], head: Sequence[str]) -> str:
    """Return commands with two nodes and two MATRIX27 for each piece.

    Args:
        pieces: of a joint.
        head: lines of comment.
    """
    lines = [*(f"! {one}" for one in head), "/PREP7", "CSYS,0"]
    for name, key in (("stiffness", _STIFFNESS), ("damping", _DAMPING)):
        kind = _FIRST + key
        lines += [f"ET,{kind},MATRIX27   ! {name}", f"KEYOPT,{kind},3,{key}"]
    for at, piece in enumerate(pieces):
        first = _FIRST + 2 * at
        lines += ["", f"! piece {piece.name}", *_nodes(piece, first)]
        for key, matrix in (
            (_STIFFNESS, piece.global_stiffness),
            (_DAMPING, piece.global_damping),
        ):
            number = _FIRST + 10 * at + key
            lines += _constants(number, _pair(matrix)[_UPPER])
            lines += [f"TYPE,{_FIRST + key}", f"REAL,{number}"]
            lines.append(f"E,{first},{first + 1}")
    return "\n".join([*lines, ""])


def read_matrix27(text: str) -> tuple[PieceRead, ...]:
    """Read commands of `matrix27_text` back.

    Raises:
        FormatError: they hold no MATRIX27 with all its constants.
    """
    nodes: dict[str, FloatArray] = {}
    constants: dict[str, list[float]] = {}
    ends: dict[tuple[str, str], dict[int, FloatArray]] = {}
    kind = real = ""
    for words in _commands(text):
        match words[0]:
            case "N":
                nodes[words[1]] = np.array([float(one) for one in words[2:5]])
            case "R":
                real = words[1]
                constants[real] = [float(one) for one in words[2:]]
            case "RMORE":
                constants[real] += [float(one) for one in words[1:]]
            case "TYPE":
                kind = words[1]
            case "E":
                found = ends.setdefault((words[1], words[2]), {})
                found[int(kind) - _FIRST] = _block(constants[real])
    if not ends or any(set(one) != {_STIFFNESS, _DAMPING} for one in ends.values()):
        raise FormatError(
            "no MATRIX27 with stiffness and damping; write the file again"
        )
    return tuple(
        PieceRead(nodes[first], one[_STIFFNESS], one[_DAMPING])
        for (first, _), one in ends.items()
    )


def combin14_text(
    pieces: Sequence[JointPiece],
    head: Sequence[str],
    laws: Mapping[int, SliderLaw] | None = None,
) -> str:
    """Return commands with six COMBIN14 for each piece, in its principal axes.

    Args:
        pieces: of a joint; couplings between components other than the two rotations
            about the tangents are left out by COMBIN14.
        head: lines of comment.
        laws: sliders by component; they take their share of the linear stiffness.
    """
    lines = [*(f"! {one}" for one in head), "/PREP7"]
    for component in range(6):
        kind = _FIRST + component
        lines += [f"ET,{kind},COMBIN14", f"KEYOPT,{kind},2,{component + 1}"]
    for component in laws or {}:
        kind = _FIRST + _SLIDER + component
        lines += [f"ET,{kind},COMBIN40", f"KEYOPT,{kind},3,{component + 1}"]
    total = sum(piece.area for piece in pieces)
    for at, piece in enumerate(pieces):
        frame, k, c = principal(piece)
        own = JointPiece(piece.name, piece.centre, frame, piece.area, k, c)
        lines += ["", f"! piece {piece.name}", *_rotated_nodes(own, at)]
        for component in range(6):
            law = (laws or {}).get(component)
            share = piece.area / total
            slack = 0.0 if law is None else share * law.total
            value = (k[component, component] - slack, c[component, component])
            lines += _one_spring(at, component, value)
            if law is not None:
                lines += _sliders(at, component, law, share)
    return "\n".join([*lines, ""])


def principal(piece: JointPiece) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return axes without coupling of the rotations about the tangents, K and C.

    Where the tangents have different stiffnesses, only the rotations may turn: then
    the frame stays, and the coupling is lost where it is not zero.
    """
    k = piece.stiffness
    coupled = abs(k[4, 5]) > 1e-6 * max(k[4, 4], k[5, 5])
    alike = abs(k[1, 1] - k[2, 2]) <= 1e-6 * max(k[1, 1], k[2, 2], 1e-300)
    if not (coupled and alike):
        return piece.frame, k, piece.damping
    angle = 0.5 * np.arctan2(2.0 * k[4, 5], k[4, 4] - k[5, 5])
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]])
    return turn @ piece.frame, turned(k, turn.T), turned(piece.damping, turn.T)


def _pair(matrix: FloatArray) -> FloatArray:
    return np.block([[matrix, -matrix], [-matrix, matrix]])


def _nodes(piece: JointPiece, first: int) -> list[str]:
    place = ",".join(f"{one:.12g}" for one in piece.centre)
    return [
        f"N,{first},{place}   ! first body: couple it to its face (RBE3)",
        f"N,{first + 1},{place}   ! second body, or fix it for the ground",
    ]


def _constants(number: int, values: FloatArray) -> list[str]:
    rows = [values[k : k + _PER_LINE] for k in range(0, values.size, _PER_LINE)]
    words = [",".join(f"{one:.12g}" for one in row) for row in rows]
    return [f"R,{number},{words[0]}", *(f"RMORE,{one}" for one in words[1:])]


def _rotated_nodes(piece: JointPiece, at: int) -> list[str]:
    """Return two nodes whose axes are those of the piece, through three key nodes."""
    first, system = _FIRST + 10 * at, 11 + at
    place = [piece.centre, piece.centre, piece.centre]
    place += [piece.centre + piece.frame[0], piece.centre + piece.frame[1]]
    numbers = [first, first + 1, first + 2, first + 3, first + 4]
    lines = ["CSYS,0"]
    lines += [
        f"N,{number},{','.join(f'{one:.12g}' for one in where)}"
        for number, where in zip(numbers, place, strict=True)
    ]
    lines.append(f"CS,{system},0,{first + 2},{first + 3},{first + 4}")
    lines += [f"CSYS,{system}", f"NROTAT,{first},{first + 1}", "CSYS,0"]
    return [*lines, f"NDELE,{first + 2},{first + 4}"]


def _one_spring(at: int, component: int, value: tuple[float, float]) -> list[str]:
    number = _FIRST + 100 * at + component
    return [
        f"R,{number},{value[0]:.12g},{value[1]:.12g}",
        f"TYPE,{_FIRST + component}",
        f"REAL,{number}",
        f"E,{_FIRST + 10 * at},{_FIRST + 10 * at + 1}",
    ]


def _sliders(at: int, component: int, law: SliderLaw, share: float) -> list[str]:
    lines = [f"! sliders of {law.name}: K1, C, M, GAP, FSLIDE, K2"]
    pairs = zip(law.stiffness * share, law.slip_force * share, strict=True)
    for place, (k, force) in enumerate(pairs):
        number = _FIRST + 100 * at + 10 + place
        lines += [
            f"R,{number},{k:.12g},0,0,0,{force:.12g},0",
            f"TYPE,{_FIRST + _SLIDER + component}",
            f"REAL,{number}",
            f"E,{_FIRST + 10 * at},{_FIRST + 10 * at + 1}",
        ]
    return lines


def _commands(text: str) -> list[list[str]]:
    lines = [line.partition("!")[0].strip() for line in text.splitlines()]
    return [[word.strip() for word in one.split(",")] for one in lines if one]


def _block(values: Sequence[float]) -> FloatArray:
    if len(values) != _UPPER[0].size:
        raise FormatError(
            f"a MATRIX27 has {len(values)} constants; {_UPPER[0].size} are needed"
        )
    whole = np.zeros((12, 12))
    whole[_UPPER] = values
    return whole[:6, :6] + np.triu(whole[:6, :6], 1).T
