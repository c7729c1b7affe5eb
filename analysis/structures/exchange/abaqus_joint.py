# SPDX-License-Identifier: MIT
"""A joint as Abaqus matrices: between two nodes of each piece, or node by node.

Source: Abaqus Keywords Reference, *MATRIX INPUT (row node, its degree of freedom,
column node, its degree of freedom, value) and *MATRIX ASSEMBLE.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError
from jointbench.analysis.structures.exchange.joint_pieces import JointPiece, PieceRead
from jointbench.analysis.structures.exchange.slip_law import SliderLaw, SpeedLaw
from jointbench.analysis.structures.matrices.element_assembly import Sparse

# Far above the numbers of a model that the file is read into.
_FIRST = 900001
_KINDS, _NAMES = ("STIFFNESS", "VISCOUS DAMPING"), ("JOINT_K", "JOINT_C")
# Speeds of a power law are tabulated up to this [m/s]: ten times a hammer test.
_LARGEST_SPEED = 0.1


def pieces_text(
    pieces: Sequence[JointPiece],
    head: Sequence[str],
    laws: Mapping[int, SliderLaw | SpeedLaw] | None = None,
) -> str:
    """Return two nodes for each piece, and the matrices between them.

    Args:
        pieces: of a joint.
        head: lines of comment.
        laws: sliders or damping by component, as connectors in parallel; sliders take
            their share of the stiffness out of the matrix.
    """
    lines = [*(f"** {one}" for one in head), "*NODE"]
    for at, piece in enumerate(pieces):
        place = ", ".join(f"{one:.12g}" for one in piece.centre)
        lines += [f"{_FIRST + 2 * at}, {place}", f"{_FIRST + 2 * at + 1}, {place}"]
    lines += [
        "** Couple the first node of each pair to the face of the first body and the",
        "** second one to that of the second: *COUPLING with *DISTRIBUTING.",
    ]
    slack = {
        component: law.total
        for component, law in (laws or {}).items()
        if isinstance(law, SliderLaw)
    }
    stiffness = [_without(piece, slack, pieces) for piece in pieces]
    damping = [piece.global_damping for piece in pieces]
    lines += _matrix_input(_chain(stiffness), _chain(damping), _FIRST, 6)
    for component, law in (laws or {}).items():
        lines += _connectors(pieces, component, law)
    return "\n".join([*lines, ""])


def nodes_text(stiffness: Sparse, damping: Sparse, head: Sequence[str]) -> str:
    """Return a joint node by node, for the mesh that it was identified on.

    Args:
        stiffness: over the degrees of freedom x, y, z of all nodes [N/m].
        damping: [N s/m].
        head: lines of comment.
    """
    lines = [f"** {one}" for one in head]
    return "\n".join([*lines, *_matrix_input(stiffness, damping, 1, 3), ""])


def read_pieces_text(text: str) -> tuple[PieceRead, ...]:
    """Read `pieces_text` back.

    Raises:
        FormatError: a pair of nodes has no matrices.
    """
    nodes: dict[int, FloatArray] = {}
    for keyword, values in _data(text):
        if keyword == "*NODE":
            nodes[int(values[0])] = np.array(values[1:])
    numbers = sorted(nodes)
    if not numbers or len(numbers) % 2:
        raise FormatError("no pairs of nodes for the pieces; write the file again")
    whole = _matrices(text, numbers[0], 6, len(numbers))
    found = []
    for at in range(0, len(numbers), 2):
        own = slice(6 * at, 6 * at + 6)
        blocks = [one[own, own].toarray() for one in whole]
        found.append(PieceRead(nodes[numbers[at]], blocks[0], blocks[1]))
    return tuple(found)


def read_nodes_text(text: str, count: int) -> tuple[Sparse, Sparse]:
    """Read stiffness and damping of `nodes_text` back, over `count` nodes."""
    return _matrices(text, 1, 3, count)


def _matrices(
    text: str, first: int, freedoms: int, count: int
) -> tuple[Sparse, Sparse]:
    """Return stiffness and damping; zero where the file has none."""
    tables: dict[str, list[list[float]]] = {name: [] for name in _NAMES}
    for keyword, values in _data(text):
        if keyword.startswith("*MATRIX INPUT"):
            tables[keyword.split("NAME=")[1].split(",")[0]].append(values)
    stiffness, damping = (tables[name] for name in _NAMES)
    return (
        _matrix(stiffness, first, freedoms, count),
        _matrix(damping, first, freedoms, count),
    )


def _matrix_input(
    stiffness: Sparse, damping: Sparse, first: int, freedoms: int
) -> list[str]:
    """Return the matrices that are not zero, and their assembly."""
    lines, words = [], []
    for kind, name, matrix in zip(_KINDS, _NAMES, (stiffness, damping), strict=True):
        if not matrix.nnz:
            continue
        lines.append(f"*MATRIX INPUT, NAME={name}, TYPE=SYMMETRIC")
        lines += _entries(matrix, first, freedoms)
        words.append(f"{kind}={name}")
    return [*lines, f"*MATRIX ASSEMBLE, {', '.join(words)}"]


def _chain(blocks: Sequence[FloatArray]) -> Sparse:
    """Return the matrices between the two nodes of each piece."""
    pairs = [np.block([[one, -one], [-one, one]]) for one in blocks]
    return Sparse(sparse.block_diag(pairs, format="csr"))


def _without(
    piece: JointPiece, slack: Mapping[int, float], pieces: Sequence[JointPiece]
) -> FloatArray:
    """Return the global stiffness of a piece without that of its sliders."""
    share = piece.area / sum(one.area for one in pieces)
    local = piece.stiffness.copy()
    for component, total in slack.items():
        local[component, component] -= share * total
    turn = np.kron(np.eye(2), piece.frame)
    return np.asarray(turn.T @ local @ turn)


def _connectors(
    pieces: Sequence[JointPiece], component: int, law: SliderLaw | SpeedLaw
) -> list[str]:
    """Return connectors in parallel to the matrices, in the axes of each piece."""
    lines = []
    total = sum(piece.area for piece in pieces)
    for at, piece in enumerate(pieces):
        share, tag = piece.area / total, f"P{at + 1}"
        axes = ", ".join(f"{one:.12g}" for one in piece.frame[:2].ravel())
        lines += [f"*ORIENTATION, NAME=AXES_{tag}, DEFINITION=COORDINATES", axes]
        count = law.stiffness.size if isinstance(law, SliderLaw) else 1
        first = _FIRST + 1000 * (at + 1)
        for place in range(count):
            name = f"{law.name.upper()}_{tag}_{place + 1}"
            ends = f"{_FIRST + 2 * at}, {_FIRST + 2 * at + 1}"
            lines += [
                f"*ELEMENT, TYPE=CONN3D2, ELSET={name}",
                f"{first + place}, {ends}",
                f"*CONNECTOR SECTION, ELSET={name}, BEHAVIOR={name}",
                "CARTESIAN",
                f"AXES_{tag}",
                f"*CONNECTOR BEHAVIOR, NAME={name}",
                *_behaviour(law, place, component + 1, share),
            ]
    return lines


def _behaviour(
    law: SliderLaw | SpeedLaw, place: int, component: int, share: float
) -> list[str]:
    if isinstance(law, SpeedLaw):
        speed, force = law.table(_LARGEST_SPEED)
        pairs = zip((force * share).tolist(), speed.tolist(), strict=True)
        rows = [f"{one:.9g}, {v:.9g}" for one, v in pairs]
        return [f"*CONNECTOR DAMPING, COMPONENT={component}, NONLINEAR", *rows]
    return [
        f"*CONNECTOR ELASTICITY, COMPONENT={component}",
        f"{law.stiffness[place] * share:.12g},",
        f"*CONNECTOR PLASTICITY, COMPONENT={component}",
        "*CONNECTOR HARDENING, TYPE=ISOTROPIC",
        f"{law.slip_force[place] * share:.12g}, 0.",
    ]


def _entries(matrix: Sparse, first: int, freedoms: int) -> list[str]:
    upper = sparse.triu(matrix).tocoo()
    rows = zip(upper.row.tolist(), upper.col.tolist(), upper.data.tolist(), strict=True)
    return [
        f"{first + i // freedoms}, {i % freedoms + 1}, "
        f"{first + j // freedoms}, {j % freedoms + 1}, {value:.15g}"
        for i, j, value in rows
        if value
    ]


def _matrix(
    rows: Sequence[Sequence[float]], first: int, freedoms: int, count: int
) -> Sparse:
    table = np.array(rows).reshape(-1, 5)
    i = (freedoms * (table[:, 0] - first) + table[:, 1] - 1).astype(int)
    j = (freedoms * (table[:, 2] - first) + table[:, 3] - 1).astype(int)
    size = freedoms * count
    upper = sparse.coo_array((table[:, 4], (i, j)), shape=(size, size)).tocsr()
    return Sparse(upper + sparse.triu(upper, 1).T)


def _data(text: str) -> Iterator[tuple[str, list[float]]]:
    """Return the data lines of *NODE and *MATRIX INPUT with their keyword."""
    keyword = ""
    for line in text.splitlines():
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            keyword = line.upper()
        elif keyword.startswith(("*NODE", "*MATRIX INPUT")):
            yield keyword, [float(word) for word in line.split(",")]
