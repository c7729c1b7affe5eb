# SPDX-License-Identifier: MIT
"""The files of an exported joint, each read back after it was written."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.records.session import software_version
from jointbench.analysis.structures.exchange import (
    abaqus_joint,
    ansys_joint,
    calculix_joint,
    joint_tables,
    nastran_joint,
)
from jointbench.analysis.structures.exchange.joint_pieces import (
    JointPiece,
    PieceRead,
)
from jointbench.analysis.structures.exchange.slip_law import SliderLaw, SpeedLaw
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.station.files.output_paths import write_text
from jointbench.station.joint_files.export_run import JointExport

PROGRAMS = ("table", "ansys", "abaqus", "nastran", "calculix")
"""For which files can be written."""
# Speeds of a power law are tabulated up to this [m/s]: ten times a hammer test.
_LARGEST_SPEED = 0.1


@dataclass(frozen=True, slots=True)
class WrittenFile:
    """A file that was written and read back.

    Attributes:
        path: of the file.
        content: what it holds, in words.
        difference: largest of what was read from what was written, as a share of the
            largest value [-]; None where a file is not read back.
    """

    path: Path
    content: str
    difference: float | None


@dataclass(frozen=True, slots=True, eq=False)
class _Draft:
    name: str
    content: str
    text: str
    read: Callable[[str], float] | None


def write_joint(
    folder: Path,
    joint: JointExport,
    programs: Sequence[str],
    law: tuple[int, SliderLaw | SpeedLaw] | None = None,
) -> tuple[WrittenFile, ...]:
    """Write the files of a joint and read them back.

    Args:
        folder: that takes them.
        joint: to write.
        programs: of `PROGRAMS`.
        law: direction and law of slip or damping; None is a linear joint.
    """
    head = heading(joint, law)
    makers = {
        "table": _tables,
        "ansys": _ansys,
        "abaqus": _abaqus,
        "nastran": _nastran,
        "calculix": _calculix,
    }
    drafts = [one for name in programs for one in makers[name](joint, head, law)]
    found = []
    for one in drafts:
        path = folder / f"{joint.name}-{one.name}"
        write_text(path, one.text)
        text = path.read_text(encoding="utf-8")
        found.append(
            WrittenFile(path, one.content, None if one.read is None else one.read(text))
        )
    return tuple(found)


def heading(
    joint: JointExport, law: tuple[int, SliderLaw | SpeedLaw] | None
) -> list[str]:
    """Return the comment above every file: source, units, values, uncertainties."""
    frame = joint.pieces[0].frame
    axes = ", ".join(
        f"{word} ({', '.join(f'{x:.4g}' for x in row)})"
        for word, row in zip(("normal", "t1", "t2"), frame, strict=True)
    )
    lines = [
        f"Joint {joint.name} {joint.values.label}, identified by {software_version()}.",
        "Units: N, m, s, kg, rad. Totals over the whole joint:",
    ]
    for one in joint.values.of_joint(joint.name):
        low, high = ("open" if x is None else f"{x:.5g}" for x in one.interval)
        sd = "" if one.sd is None else f" +- {one.sd:.2g}"
        word = one.reason if one.reason.startswith("known") else ""
        lines.append(
            f"  {one.name} = {one.value:.6g}{sd} {one.unit}, 95 %: {low} to {high}"
            + ("" if one.identifiable else " NOT IDENTIFIABLE")
            + (f" ({word})" if word else "")
        )
    lines.append(f"Axes: {axes}; third axis completes a right-handed frame.")
    if law is not None:
        lines += [*law[1].remarks]
    return lines


def _tables(
    joint: JointExport, head: list[str], law: tuple[int, SliderLaw | SpeedLaw] | None
) -> list[_Draft]:
    own = joint.values.of_joint(joint.name)
    text = joint_tables.pieces_table(joint.pieces)
    found = [
        _Draft("values.csv", "values, sd, 95 %", joint_tables.values_table(own), None),
        _Draft(
            "pieces.csv",
            "K and C of each piece",
            text,
            lambda t: _pieces_apart(
                joint.pieces,
                [
                    PieceRead(p.centre, p.global_stiffness, p.global_damping)
                    for p in joint_tables.read_pieces_table(t)
                ],
            ),
        ),
    ]
    if law is not None:
        text = joint_tables.law_table(law[1], _LARGEST_SPEED)
        found.append(_Draft("law.csv", f"law {law[1].name}", text, None))
    return found


def _ansys(
    joint: JointExport, head: list[str], law: tuple[int, SliderLaw | SpeedLaw] | None
) -> list[_Draft]:
    sliders = {law[0]: law[1]} if law and isinstance(law[1], SliderLaw) else None
    return [
        _Draft(
            "ansys-matrix27.inp",
            "MATRIX27 of each piece",
            ansys_joint.matrix27_text(joint.pieces, head),
            lambda t: _pieces_apart(joint.pieces, ansys_joint.read_matrix27(t)),
        ),
        _Draft(
            "ansys-combin14.inp",
            "COMBIN14 of each piece" + (", COMBIN40 sliders" if sliders else ""),
            ansys_joint.combin14_text(joint.pieces, head, sliders),
            None,
        ),
    ]


def _abaqus(
    joint: JointExport, head: list[str], law: tuple[int, SliderLaw | SpeedLaw] | None
) -> list[_Draft]:
    linear = law is None or not isinstance(law[1], SliderLaw)
    laws = None if law is None else {law[0]: law[1]}
    return [
        _Draft(
            "abaqus.inp",
            "matrices of each piece" + (", connectors of the law" if laws else ""),
            abaqus_joint.pieces_text(joint.pieces, head, laws),
            (lambda t: _pieces_apart(joint.pieces, abaqus_joint.read_pieces_text(t)))
            if linear
            else None,
        ),
        _Draft(
            "abaqus-nodes.inp",
            "matrices over the nodes of the mesh",
            abaqus_joint.nodes_text(joint.stiffness, joint.damping, head),
            lambda t: _matrices_apart(
                joint, abaqus_joint.read_nodes_text(t, len(joint.structure.nodes))
            ),
        ),
    ]


def _nastran(
    joint: JointExport, head: list[str], law: tuple[int, SliderLaw | SpeedLaw] | None
) -> list[_Draft]:
    return [
        _Draft(
            "nastran.bdf",
            "CBUSH of each piece",
            nastran_joint.cbush_text(joint.pieces, head),
            lambda t: _pieces_apart(joint.pieces, nastran_joint.read_cbush(t)),
        ),
        _Draft(
            "nastran-nodes.bdf",
            "DMIG over the nodes of the mesh",
            nastran_joint.dmig_text(joint.stiffness, joint.damping, head),
            lambda t: _matrices_apart(
                joint, nastran_joint.read_dmig(t, len(joint.structure.nodes))
            ),
        ),
    ]


def _calculix(
    joint: JointExport, head: list[str], law: tuple[int, SliderLaw | SpeedLaw] | None
) -> list[_Draft]:
    count = len(joint.structure.nodes)
    first = calculix_joint.solid_count(joint.structure) + 1
    lines = [*head, "CalculiX has no dashpots of zero length: the damping is left out."]
    return [
        _Draft(
            "calculix-nodes.inp",
            "springs between the nodes of the mesh",
            calculix_joint.springs_text(joint.stiffness, lines, first),
            lambda t: _apart(joint.stiffness, calculix_joint.read_springs(t, count)),
        )
    ]


def _pieces_apart(pieces: Sequence[JointPiece], read: Sequence[PieceRead]) -> float:
    """Return the largest difference of what was read, relative to each matrix."""
    worst = 0.0
    for piece, one in zip(pieces, read, strict=True):
        pairs = (
            (piece.global_stiffness, one.stiffness),
            (piece.global_damping, one.damping),
        )
        for wanted, found in pairs:
            largest = max(float(np.abs(wanted).max()), 1e-300)
            worst = max(worst, float(np.abs(wanted - found).max()) / largest)
        worst = max(worst, float(np.abs(piece.centre - one.centre).max()))
    return worst


def _matrices_apart(joint: JointExport, read: tuple[Sparse, Sparse]) -> float:
    return max(_apart(joint.stiffness, read[0]), _apart(joint.damping, read[1]))


def _apart(wanted: Sparse, found: Sparse) -> float:
    largest = float(abs(wanted).max()) if wanted.nnz else 0.0
    return float(abs(wanted - found).max()) / max(largest, 1e-300)
