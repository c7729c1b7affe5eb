# SPDX-License-Identifier: MIT
"""Write an identified joint for other programs, and check what was written."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.files.output_paths import make_folder, write_text
from jointbench.station.joint_files.calculix_run import (
    calculix_frequencies,
    require_calculix,
)
from jointbench.station.joint_files.export_files import (
    PROGRAMS,
    WrittenFile,
    write_joint,
)
from jointbench.station.joint_files.export_run import (
    ExportSource,
    JointExport,
    calculix_deck,
    calculix_model,
    export_joint,
    export_source,
    frequencies_with_its_mass,
)
from jointbench.station.joint_files.joint_drawing import write_joint_page
from jointbench.station.joint_files.joint_law import read_law
from jointbench.station.joints.state_values import IdentifiedFile
from jointbench.station.screen.page_parts import DataTable
from jointbench.station.screen.terminal import working

LARGEST_DIFFERENCE = 1e-4
"""Of natural frequencies in CalculiX from ours, relative: the files are the joint."""
FREQUENCY_COLUMNS = ("identified model [Hz]", "with pieces", "CalculiX, node by node")
"""Of `ExportedJoint.frequency_rows`; the last one where CalculiX has run."""


@dataclass(frozen=True, slots=True)
class ExportRequest:
    """What is to be exported.

    Attributes:
        joint: name; None where the model has one only.
        state: label; None where there is one only.
        programs: of `PROGRAMS`.
        pieces: their numbers along the two tangents; None is one for each patch.
        law: JSON of ``gap`` with a direction; None is a linear joint.
        check: whether CalculiX computes the whole model.
    """

    joint: str | None = None
    state: str | None = None
    programs: Sequence[str] = PROGRAMS
    pieces: tuple[int, int] | None = None
    law: str | None = None
    check: bool = False

    def __post_init__(self) -> None:
        """Refuse programs for which no files can be written."""
        for one in self.programs:
            if one not in PROGRAMS:
                raise UsageError(
                    f"--to: no program {one!r}; choose of {list(PROGRAMS)}"
                )


@dataclass(frozen=True, slots=True, eq=False)
class ExportedJoint:
    """A joint as it was written.

    Attributes:
        source: model with the identified values.
        joint: its pieces, values and frequencies.
        files: that were written, in the order written.
        report: HTML with the drawing.
        apart: relative difference of the natural frequencies in CalculiX, infinite
            where one is missing; None where it was not asked for.
    """

    source: ExportSource
    joint: JointExport
    files: tuple[WrittenFile, ...]
    report: Path
    apart: FloatArray | None

    @property
    def faithful(self) -> bool:
        """Whether the files hold the joint: read back, and in CalculiX if run."""
        read_back = max(one.difference or 0.0 for one in self.files)
        return read_back < LARGEST_DIFFERENCE and (
            self.apart is None or float(np.abs(self.apart).max()) < LARGEST_DIFFERENCE
        )

    @property
    def frequency_columns(self) -> tuple[str, ...]:
        """Headings of `frequency_rows`."""
        return _columns(self.apart)

    @property
    def frequency_rows(self) -> tuple[tuple[str, ...], ...]:
        """Natural frequencies, and what the pieces and CalculiX change."""
        return _rows(self.joint, self.apart)


def exported_joint(
    model: Path, identified: IdentifiedFile, folder: Path, request: ExportRequest
) -> ExportedJoint:
    """Write a joint and read it back.

    Args:
        model: structure model (TOML).
        identified: joints of the model.
        folder: that takes the files.
        request: what is to be exported.

    Raises:
        UsageError: the request cannot be met.
    """
    law = None if request.law is None else read_law(request.law)
    if request.check:
        require_calculix()
    make_folder(folder)
    with working("meshing, solving"):
        source = export_source(model, identified, request.state)
        joint = export_joint(source, request.joint, request.pieces)
    with working("writing"):
        files = write_joint(folder, joint, request.programs, law)
        if request.check or "calculix" in request.programs:
            deck = calculix_deck(source, calculix_model(source))
            path = folder / "calculix-model.inp"
            write_text(path, deck)
            files = (*files, WrittenFile(path, "the whole model, to be run", None))
    apart = calculix_apart(source, deck) if request.check else None
    report = folder / f"{joint.name}.html"
    write_joint_page(report, joint, files, _frequencies(joint, apart))
    return ExportedJoint(source, joint, files, report, apart)


def calculix_apart(source: ExportSource, deck: str) -> FloatArray:
    """Return how far the natural frequencies of CalculiX are from ours, relative [-].

    Args:
        source: model with the identified values.
        deck: the same for CalculiX.
    """
    with working("running CalculiX"):
        own = frequencies_with_its_mass(source, calculix_model(source))
        found = calculix_frequencies(deck)
    # The elastic ones: those from half of our lowest on.
    found = found[found > 0.5 * own[0]][: own.size]
    apart = np.full(own.size, np.inf)
    apart[: found.size] = found / own[: found.size] - 1.0
    return apart


def _frequencies(joint: JointExport, apart: FloatArray | None) -> DataTable:
    caption = (
        "Natural frequencies of the identified model; change with the pieces in place "
        "of the distributed springs; difference of CalculiX with the nodes of the mesh."
    )
    return DataTable(caption, _columns(apart), _rows(joint, apart))


def _columns(apart: FloatArray | None) -> tuple[str, ...]:
    return FREQUENCY_COLUMNS[: 2 + (apart is not None)]


def _rows(joint: JointExport, apart: FloatArray | None) -> tuple[tuple[str, ...], ...]:
    rows = []
    for at, own in enumerate(joint.frequencies):
        row = [f"{own:.6g}", f"{100 * (joint.of_pieces[at] / own - 1):+.3f} %"]
        if apart is not None:
            row.append(f"{apart[at]:+.1e}" if np.isfinite(apart[at]) else "missing")
        rows.append(tuple(row))
    return tuple(rows)
