# SPDX-License-Identifier: MIT
"""Stiffness and damping of joints from measured modes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.analysis.lumped.identified import (
    Identification,
    JointParameter,
    identification_json,
)
from jointbench.analysis.structures.identification.joint_result import (
    StructureIdentification,
)
from jointbench.analysis.structures.identification.weigh_hypotheses import (
    StateHypotheses,
)
from jointbench.signal.modal.modes import ModalSettings
from jointbench.station.desk.desk_results import chosen_at_desk
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.identified_json import identified_json
from jointbench.station.joints.identify_run import (
    IdentifiedStructure,
    identified_structure,
)
from jointbench.station.joints.model_kind import describes_structure
from jointbench.station.joints.modes_of_files import modes_of_files
from jointbench.station.joints.state_values import (
    IdentifiedFile,
    identified_of,
    read_identified,
)
from jointbench.station.library.argument_checks import (
    checked_band,
    one_path,
    require_lists,
    require_texts,
)
from jointbench.station.library.measurements import (
    Files,
    Measurement,
    paths_of,
)
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.pipeline.chain import ChainSettings, run_chain
from jointbench.station.pipeline.link_stage import identify_joint
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.screen.joint_text import VALUE_LEGEND, parameter_text


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class IdentifiedJoints(Shown):
    """Identified parameters of the joints.

    Attributes:
        result: of a lumped bench or of a meshed structure.
        structure: bodies, states and hypotheses of a meshed structure; None for a
            lumped bench.
    """

    result: Identification | StructureIdentification
    structure: IdentifiedStructure | None = None

    @property
    def hypotheses(self) -> tuple[StateHypotheses, ...]:
        """What else could explain each state of a meshed structure."""
        return () if self.structure is None else self.structure.hypotheses

    @property
    def parameters(self) -> tuple[JointParameter, ...]:
        """Stiffness and damping of every link or direction."""
        return self.result.parameters

    def __getitem__(self, name: str) -> JointParameter:
        """Return a parameter by name, ``"joint.stiffness"``.

        Raises:
            UsageError: there is none of that name.
        """
        for one in self.parameters:
            if one.name == name:
                return one
        known = ", ".join(one.name for one in self.parameters)
        raise UsageError(f"no parameter {name!r}; identified are {known}")

    def to_dict(self) -> dict[str, Any]:
        """Return the joints as plain data, as ``identify --json`` writes them."""
        if self.structure is not None:
            return identified_json(self.structure)
        assert isinstance(self.result, Identification)
        return identification_json(self.result)

    @property
    def view(self) -> ResultView:
        """One row a parameter, and the basis of the verdict."""
        rows = [
            (
                one.name,
                parameter_text(one),
                one.unit,
                "yes" if one.identifiable else "no",
            )
            for one in self.parameters
        ]
        reasons = [p.reason for p in self.parameters if p.reason]
        reasons += [
            f"{one.state}: {case.text}: {100 * case.probability:.3g} %"
            for one in self.hypotheses
            for case in one.surviving
        ]
        said = tuple(dict.fromkeys([*self.result.reasons, *reasons]))
        title = f"Joints: {self.result.verdict.value} {VALUE_LEGEND}"
        columns = ("parameter", "value", "unit", "identifiable")
        return ResultView(title, columns, tuple(rows), said)


def identify(
    model: str | Path,
    source: Measurement | Files = (),
    *,
    band: tuple[float, float] | None = None,
    surface: Sequence[str | Path] = (),
    cache: str | Path | None = None,
    columns: str | None = None,
    averages: int = 0,
) -> IdentifiedJoints:
    """Identify the joints of a lumped bench or of a meshed structure.

    Args:
        model: bench or structure as TOML.
        source: recorded measurement, sessions, or files of FRFs; none where a structure
            names measured modes itself.
        band: of the modes [Hz]; None lets the data choose.
        surface: files of the contact surfaces of a structure with a table [contact].
        cache: folder that keeps reduced structures.
        columns: of files of FRFs or hits that state no units, for example
            ``"frf:m/s^2/N"``.
        averages: number of averages of FRFs, where their file gives none.

    Returns:
        Parameters with intervals, or why they are not identifiable.

    Raises:
        BadData: the model or a session cannot be used.
        UsageError: a lumped bench without a session.
    """
    path = one_path(model, "a model")
    band = checked_band(band)
    require_texts("'frf:m/s^2/N'", columns=columns)
    require_lists("['face-a.csv']", surface=surface)
    options = FrfOptions(columns, averages=averages)
    if isinstance(source, Measurement):
        sessions = source.files
    else:
        sessions = () if _is_empty(source) else paths_of(source)
    if describes_structure(path):
        done = identified_structure(
            path,
            sessions,
            band=None if band is None else f"{band[0]}:{band[1]}",
            cache=None if cache is None else Path(cache),
            surfaces=[Path(one) for one in surface],
            options=options,
        )
        return IdentifiedJoints(done.result, done)
    if not sessions:
        raise UsageError(f"'{path}' is a lumped bench and needs sessions, hits or FRFs")
    settings = ChainSettings(modal=ModalSettings(band=band))
    if isinstance(source, Measurement):
        chain = run_chain(source.recordings, settings)
    else:
        # A band asks for other modes than those on the desk.
        chosen = None if band else chosen_at_desk(sessions)
        chain = chosen or modes_of_files(sessions, options, settings)
    return IdentifiedJoints(
        identify_joint(read_toml(path, BenchModel), chain.result.model)
    )


def values_of(identified: IdentifiedJoints | str | Path) -> IdentifiedFile:
    """Return the values of joints that were identified here or in a run before.

    Args:
        identified: result of `identify`, or the JSON of ``identify``.

    Raises:
        FormatError: the file is no such JSON.
    """
    if isinstance(identified, IdentifiedJoints):
        return identified_of(identified.to_dict())
    return read_identified(one_path(identified, "the JSON of 'identify'"))


def _is_empty(source: Files) -> bool:
    return not isinstance(source, str | Path) and not source
