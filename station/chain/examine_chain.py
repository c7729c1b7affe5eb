# SPDX-License-Identifier: MIT
"""The chain of a joint from files: surfaces, contact law, structure, hits."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Surface
from jointbench.acquisition.session_file.session_origin import any_simulated
from jointbench.analysis.gap.catalogue.catalogue import check_names
from jointbench.analysis.gap.chain.chain_diagnosis import (
    ChainDiagnosis,
    diagnose_chain,
)
from jointbench.analysis.gap.chain.locate_link import Chain
from jointbench.analysis.gap.chain.lumped_structure import read_lumped
from jointbench.analysis.gap.chain.moved_quantities import (
    MovedModes,
    MovedResponse,
    MovedStiffness,
    moved_modes,
    moved_response,
    moved_stiffness,
)
from jointbench.analysis.gap.contact_bench.contact_catalogue import CONTACT_NAMES
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.station.chain.identified_chain import (
    moved_body_modes,
    read_identified,
)
from jointbench.station.chain.read_chain import bolted_joint, read_states
from jointbench.station.chain.surface_reading import read_surfaces_of_chain
from jointbench.station.files.input_files import read_surfaces
from jointbench.station.files.toml_file import read_toml
from jointbench.station.gap.gap_request import GapRequest
from jointbench.station.joints.model_kind import describes_structure
from jointbench.station.joints.structure_model import StructureModel
from jointbench.station.schemas.bench_model import BenchModel

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, eq=False)
class ExaminedChain:
    """What became of a chain.

    Attributes:
        title: of the sessions.
        found: verdict on the chain.
        surfaces: as read.
        stiffness: of every state, before and after.
        modes: of every state.
        response: of the state with the highest preload; None without hits.
        remarks: what was left out, and why, a line each.
        simulated: whether a session was.
    """

    title: str
    found: ChainDiagnosis
    surfaces: tuple[Surface, ...]
    stiffness: MovedStiffness
    modes: tuple[MovedModes, ...]
    response: MovedResponse | None
    remarks: tuple[str, ...]
    simulated: bool

    @property
    def diagnosis(self) -> Diagnosis:
        """Diagnosis of the joint by the contact law."""
        return self.found.contact.found


def examine_chain(
    sessions: Sequence[Path],
    surfaces: Sequence[Path],
    wanted: GapRequest,
    *,
    progress: Progress = lambda line: None,
) -> ExaminedChain:
    """Read sessions and surfaces, and find the link at which they disagree.

    Args:
        sessions: of one bench; each is one assembly of the joint.
        surfaces: files of one or both contact surfaces.
        wanted: model and options.
        progress: receives one line per step.

    Raises:
        UsageError: the model or its table [bolted_joint] is missing, or `without`
            holds an unknown name.
        BadData: a file cannot be used as it is.
    """
    if wanted.model is None:
        raise UsageError(
            "--surface needs the bench's model with a table [bolted_joint]; give it "
            "with --model bench.toml"
        )
    contact_names = _contact_names(wanted)
    if describes_structure(wanted.model):
        return _meshed(
            sessions, surfaces, wanted.model, wanted.preload, contact_names, progress
        )
    model = read_toml(wanted.model, BenchModel)
    table = bolted_joint(model, wanted.model)
    progress("reading surfaces")
    heights = tuple(one for _, one in read_surfaces(list(surfaces), columns=None))
    progress("reading hits")
    measured = read_states(sessions, model, table, wanted.preload)
    progress("fitting surfaces")
    surface = read_surfaces_of_chain(heights, table, measured.states, progress)
    structure = read_lumped(
        measured.campaigns,
        link=measured.link,
        without=wanted.without,
        entries=wanted.entries,
        progress=progress,
    )
    chain = Chain(surface, structure.reading, measured.states)
    found = diagnose_chain(chain, without=contact_names, progress=progress)
    stiffness = moved_stiffness(found)
    return ExaminedChain(
        measured.states.name,
        found,
        heights,
        stiffness,
        moved_modes(structure, stiffness),
        moved_response(structure, stiffness, int(np.argmax(measured.states.preload))),
        measured.remarks,
        any_simulated(sessions),
    )


def _meshed(
    sessions: Sequence[Path],
    surfaces: Sequence[Path],
    path: Path,
    preload: float | None,
    without: frozenset[str],
    progress: Progress,
) -> ExaminedChain:
    """Examine the chain of meshed bodies, whose joint is identified from modes."""
    table = bolted_joint(read_toml(path, StructureModel), path)
    progress("reading surfaces")
    heights = tuple(one for _, one in read_surfaces(list(surfaces), columns=None))
    progress("identifying the joint in every state")
    own = read_identified(sessions, path, table, preload)
    progress("fitting surfaces")
    surface = read_surfaces_of_chain(heights, table, own.states, progress)
    chain = Chain(surface, own.reading, own.states)
    found = diagnose_chain(chain, without=without, progress=progress)
    stiffness = moved_stiffness(found)
    modes = moved_body_modes(own, stiffness)
    return ExaminedChain(
        own.states.name,
        found,
        heights,
        stiffness,
        modes,
        None,
        own.remarks,
        any_simulated(sessions),
    )


def _contact_names(wanted: GapRequest) -> frozenset[str]:
    """Return the effects of the contact law to leave out.

    Raises:
        UsageError: a name is neither in the catalogue of structures nor in that of
            contact laws.
    """
    contact = wanted.without & frozenset(CONTACT_NAMES)
    check_names(sorted(wanted.without - contact), wanted.entries)
    return contact
