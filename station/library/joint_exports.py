# SPDX-License-Identifier: MIT
"""An identified joint for finite element programs."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.exchange.joint_pieces import JointPiece
from jointbench.station.joint_files.calculix_run import require_calculix
from jointbench.station.joint_files.export_files import PROGRAMS
from jointbench.station.joint_files.export_run import calculix_deck, calculix_model
from jointbench.station.joint_files.export_text import (
    FILE_COLUMNS,
    file_rows,
    files_title,
    remarks,
)
from jointbench.station.joint_files.exported_joint import (
    ExportedJoint,
    ExportRequest,
    calculix_apart,
    exported_joint,
)
from jointbench.station.library.argument_checks import (
    one_path,
    require_lists,
    require_texts,
)
from jointbench.station.library.identified_joints import IdentifiedJoints, values_of
from jointbench.station.library.result_view import ResultView, Shown


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class JointFiles(Shown):
    """The files of an exported joint.

    Attributes:
        result: pieces, values, frequencies, and the files as read back.
    """

    result: ExportedJoint

    @property
    def pieces(self) -> tuple[JointPiece, ...]:
        """Parts of the joint, each with K and C of 6 x 6 at its centre."""
        return self.result.joint.pieces

    @property
    def files(self) -> tuple[Path, ...]:
        """Files that were written, the report with the drawing last."""
        return (*(one.path for one in self.result.files), self.result.report)

    @property
    def faithful(self) -> bool:
        """Whether the files hold the joint, as read back."""
        return self.result.faithful

    def check(self) -> FloatArray:
        """Compute the whole model with CalculiX (ccx).

        Returns:
            Relative difference of its natural frequencies from ours [-], infinite where
            one is missing, shape (n_modes,).

        Raises:
            UsageError: CalculiX is not installed.
        """
        require_calculix()
        source = self.result.source
        return calculix_apart(source, calculix_deck(source, calculix_model(source)))

    @property
    def view(self) -> ResultView:
        """One row a file with its difference read back, and what the pieces change."""
        rows = tuple(file_rows(self.result))
        title, said = files_title(self.result), tuple(remarks(self.result))
        return ResultView(title, FILE_COLUMNS, rows, said)


def export_joint(
    model: str | Path,
    identified: IdentifiedJoints | str | Path,
    out: str | Path,
    *,
    to: Sequence[str] = PROGRAMS,
    joint: str | None = None,
    state: str | None = None,
    pieces: tuple[int, int] | None = None,
    law: str | None = None,
) -> JointFiles:
    """Write an identified joint for Ansys, Abaqus, Nastran, CalculiX, and as tables.

    Args:
        model: structure model (TOML).
        identified: joints that `identify` returned, or the JSON of ``identify``.
        out: folder that takes the files.
        to: programs: table, ansys, abaqus, nastran, calculix.
        joint: its name; None where the model has one only.
        state: its label; None where one only was identified.
        pieces: numbers along the two tangents; None is one for each patch.
        law: JSON of ``gap`` whose law of slip or damping is added; after a colon its
            direction, ``"gap.json:normal"``.

    Returns:
        The files, each read back, and the pieces.

    Raises:
        BadData: the model or the joints cannot be used.
        UsageError: there is no such joint, state or program.
    """
    require_lists("['nastran', 'table']", to=to)
    require_texts("'low'", joint=joint, state=state, law=law)
    request = ExportRequest(joint, state, tuple(to), pieces, law)
    path, folder = one_path(model, "a model"), one_path(out, "a folder")
    return JointFiles(exported_joint(path, values_of(identified), folder, request))
