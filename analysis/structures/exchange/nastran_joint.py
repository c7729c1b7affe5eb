# SPDX-License-Identifier: MIT
"""A joint as Nastran bulk data: CBUSH for each piece, or DMIG node by node.

Source: MSC Nastran Quick Reference Guide, CBUSH, PBUSH (K and B lines), CORD2R, DMIG;
large fields of 16 columns.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError
from jointbench.analysis.structures.exchange.ansys_joint import principal
from jointbench.analysis.structures.exchange.joint_pieces import (
    JointPiece,
    PieceRead,
    turned,
)
from jointbench.analysis.structures.matrices.element_assembly import Sparse

# Far above the numbers of a model that the file is read into.
_FIRST = 900001
_WIDTH = 16
_TRANSLATIONS, _ROCKING = (0, 1, 2, 3), (4, 5)


def cbush_text(pieces: Sequence[JointPiece], head: Sequence[str]) -> str:
    """Return two grid points and one or two CBUSH for each piece.

    A piece whose rotations about the tangents are coupled has a second CBUSH along its
    principal axes.

    Args:
        pieces: of a joint.
        head: lines of comment.
    """
    lines = [f"$ {one}" for one in head]
    lines.append("$ Couple the first grid point to the face of the first body (RBE3),")
    lines.append("$ the second one to that of the second body.")
    for at, piece in enumerate(pieces):
        grid, element = _FIRST + 2 * at, _FIRST + 2 * at
        lines.append(f"$ piece {piece.name}")
        lines += [_card("GRID", grid + k, None, *piece.centre) for k in range(2)]
        for place, (frame, k, c) in enumerate(_bushes(piece)):
            number = element + place
            lines += [
                _axes(number, piece.centre, frame),
                _card("PBUSH", number, "K", *k, None, "B", *c),
                _card("CBUSH", number, number, grid, grid + 1, *[None] * 3, number),
            ]
    return "\n".join([*lines, ""])


def read_cbush(text: str) -> tuple[PieceRead, ...]:
    """Read `cbush_text` back.

    Raises:
        FormatError: a CBUSH lacks its property, axes or grid points.
    """
    cards: dict[str, dict[str, list[str]]] = {}
    for name, fields in _cards(text):
        cards.setdefault(name, {})[fields[0]] = fields
    found: dict[tuple[str, str], list[FloatArray]] = {}
    try:
        for fields in cards["CBUSH"].values():
            _, number, first, second, _, _, _, system = fields
            frame = _frame_of(cards["CORD2R"][system])
            value = cards["PBUSH"][number]
            ends = found.setdefault((first, second), [np.zeros((6, 6))] * 2)
            for k, begin in enumerate((2, 10)):
                row = [float(one or 0) for one in value[begin : begin + 6]]
                ends[k] = ends[k] + turned(np.diag(row), frame)
        return tuple(
            PieceRead(np.array([float(one) for one in cards["GRID"][first][2:5]]), k, c)
            for (first, _), (k, c) in found.items()
        )
    except (KeyError, ValueError, IndexError) as error:
        raise FormatError(
            f"a CBUSH lacks its property, axes or grid points ({error})"
        ) from error


def dmig_text(stiffness: Sparse, damping: Sparse, head: Sequence[str]) -> str:
    """Return a joint node by node, for the mesh that it was identified on.

    Args:
        stiffness: over the degrees of freedom x, y, z of all nodes [N/m].
        damping: [N s/m].
        head: lines of comment.
    """
    lines = [f"$ {one}" for one in head]
    lines.append("$ Case control: K2GG = JOINTK, B2GG = JOINTC")
    for name, matrix in (("JOINTK", stiffness), ("JOINTC", damping)):
        lines.append(f"DMIG    {name:<8}{0:>8}{6:>8}{2:>8}{0:>8}")
        lower = sparse.tril(matrix).tocsc()
        for column in np.flatnonzero(np.diff(lower.indptr)).tolist():
            own = slice(lower.indptr[column], lower.indptr[column + 1])
            lines.append(f"DMIG*   {name:<16}{column // 3 + 1:>16}{column % 3 + 1:>16}")
            rows = zip(lower.indices[own].tolist(), lower.data[own], strict=True)
            lines += [
                f"*       {row // 3 + 1:>16}{row % 3 + 1:>16}{_number(value):>16}"
                for row, value in rows
            ]
    return "\n".join([*lines, ""])


def read_dmig(text: str, count: int) -> tuple[Sparse, Sparse]:
    """Read stiffness and damping of `dmig_text` back, over `count` nodes."""
    entries: dict[str, list[tuple[int, int, float]]] = {"JOINTK": [], "JOINTC": []}
    name, column = "", 0
    for line in text.splitlines():
        words = line.split()
        if line.startswith("DMIG*"):
            name, column = words[1], 3 * (int(words[2]) - 1) + int(words[3]) - 1
        elif line.startswith("*"):
            row = 3 * (int(words[1]) - 1) + int(words[2]) - 1
            entries[name].append((row, column, float(words[3])))
    return _square(entries["JOINTK"], count), _square(entries["JOINTC"], count)


def _square(entries: Sequence[tuple[int, int, float]], count: int) -> Sparse:
    table = np.array(entries, float).reshape(-1, 3)
    index = (table[:, 0].astype(int), table[:, 1].astype(int))
    lower = sparse.coo_array((table[:, 2], index), shape=(3 * count, 3 * count)).tocsr()
    return Sparse(lower + sparse.tril(lower, -1).T)


def _bushes(
    piece: JointPiece,
) -> Iterator[tuple[FloatArray, list[float], list[float]]]:
    """Return axes and diagonal values of the bushes of a piece."""
    free = JointPiece(
        piece.name,
        piece.centre,
        piece.frame,
        piece.area,
        _rocking(piece.stiffness),
        _rocking(piece.damping),
    )
    frame, k, c = principal(free)
    own_k, own_c = np.diag(piece.stiffness), np.diag(piece.damping)
    if np.allclose(frame, piece.frame):
        yield piece.frame, own_k.tolist(), own_c.tolist()
        return
    plain = np.isin(np.arange(6), _TRANSLATIONS)
    yield piece.frame, (own_k * plain).tolist(), (own_c * plain).tolist()
    yield frame, (np.diag(k) * ~plain).tolist(), (np.diag(c) * ~plain).tolist()


def _rocking(matrix: FloatArray) -> FloatArray:
    """Return the part of a matrix on the rotations about the tangents."""
    kept = np.zeros((6, 6))
    kept[4:, 4:] = matrix[4:, 4:]
    return kept


def _axes(number: int, origin: FloatArray, frame: FloatArray) -> str:
    """Return axes by points on the third axis and in the plane of third and first."""
    points = [origin, origin + frame[2], origin + frame[0]]
    return _card("CORD2R", number, None, *np.concatenate(points))


def _frame_of(fields: Sequence[str]) -> FloatArray:
    values = np.array([float(one) for one in fields[2:11]]).reshape(3, 3)
    third, toward = values[1] - values[0], values[2] - values[0]
    third = third / np.linalg.norm(third)
    second = np.cross(third, toward)
    second = second / np.linalg.norm(second)
    return np.stack([np.cross(second, third), second, third])


def _card(name: str, *fields: float | int | str | None) -> str:
    """Return a card in large fields, four a line."""
    words = [_field(one) for one in fields]
    rows = [words[k : k + 4] for k in range(0, len(words), 4)]
    lines = [f"{name + '*':<8}" + "".join(rows[0])]
    lines += ["*".ljust(8) + "".join(row) for row in rows[1:]]
    return "\n".join(lines)


def _field(value: float | int | str | None) -> str:
    if value is None:
        return " " * _WIDTH
    if isinstance(value, str):
        return f"{value:<{_WIDTH}}"
    if isinstance(value, int):
        return f"{value:>{_WIDTH}}"
    return f"{_number(float(value)):>{_WIDTH}}"


def _number(value: float) -> str:
    """Return at most 16 columns with a decimal point, as Nastran wants of a real."""
    return f"{value:.8E}"


def _cards(text: str) -> Iterator[tuple[str, list[str]]]:
    """Return large-field cards with their fields."""
    card: tuple[str, list[str]] | None = None
    for line in text.splitlines():
        if line.startswith("$") or not line.strip():
            continue
        body = line[8:].ljust(4 * _WIDTH)
        fields = [body[k : k + _WIDTH].strip() for k in range(0, 4 * _WIDTH, _WIDTH)]
        if line.startswith("*") and card is not None:
            card[1].extend(fields)
            continue
        if card is not None:
            yield card
        card = (line[:8].strip().rstrip("*"), fields)
    if card is not None:
        yield card
