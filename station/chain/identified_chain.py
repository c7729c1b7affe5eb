# SPDX-License-Identifier: MIT
"""The joint of meshed bodies over its preload, by the modes of every session."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.chain.chain_records import (
    JointReading,
    StructureReading,
)
from jointbench.analysis.gap.chain.joint_over_preload import BoltedStates
from jointbench.analysis.gap.chain.moved_quantities import MovedModes, MovedStiffness
from jointbench.analysis.structures.identification.body_faults import BodyFault
from jointbench.analysis.structures.identification.identify_structure import (
    StructureSearch,
)
from jointbench.analysis.structures.identification.joint_result import (
    StructureIdentification,
)
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    solve_reduced,
)
from jointbench.station.chain.fault_reading import modes_test, with_fault
from jointbench.station.chain.read_chain import QUANTITY
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joint_states.joint_state_files import joint_facts
from jointbench.station.joints.identify_run import (
    IdentifiedStructure,
    identified_structure,
)
from jointbench.station.joints.structure_model import StructureModel
from jointbench.station.schemas.bolted_joint_table import BoltedLinkTable

_SEARCH = StructureSearch(starts=16, profiles=False)
"""Of the joint in every state: the chain takes the covariance at the optimum."""
DIRECTION = {"normal": "normal", "tangential": "tangential_1"}
"""Direction of a meshed joint for that of the table [bolted_joint]."""


@dataclass(frozen=True, slots=True, eq=False)
class IdentifiedChain:
    """Meshed bodies whose joint was identified in every state.

    Attributes:
        structure: bodies, joints and the identification.
        labels: of the states whose joint is identifiable, in the order measured.
        column: of the joint's direction among the parameters of the structure.
        states: of the joint.
        reading: its stiffness, and the test of the structure.
        remarks: what was left out, and why, a line each.
        fault: of a body that explains the modes, or None.
    """

    structure: IdentifiedStructure
    labels: tuple[str, ...]
    column: int
    states: BoltedStates
    reading: StructureReading
    remarks: tuple[str, ...]
    fault: BodyFault | None = None


def read_identified(
    sessions: Sequence[Path],
    model: Path,
    table: BoltedLinkTable,
    preload: float | None,
) -> IdentifiedChain:
    """Identify the joint of meshed bodies in every state of its sessions.

    Args:
        sessions: of one structure; each is one assembly of the joint.
        model: the structure as TOML.
        table: its bolted joint.
        preload: where a session states none [N], or None.

    Raises:
        BadData: a session has no preload, or the joint is identifiable in no state.
    """
    done = identified_structure(model, sessions, search=_SEARCH)
    short = f"{table.link}.{DIRECTION[table.direction]}"
    kept, remarks = _identifiable(done.result, list(done.measured), short)
    if not kept:
        raise BadData(
            f"the stiffness of {short} is identifiable in no state; see `jointbench "
            f"identify {model.name}` for what to measure"
        )
    labels = tuple(kept)
    states = BoltedStates(
        ", ".join(path.stem for path in sessions),
        joint_facts(table, table),
        np.array([_preload(label, done, preload) for label in labels]),
        _assemblies(sessions, labels),
        QUANTITY[table.direction],
    )
    before = _reading(done.result, list(kept.values()))
    names = [done.result.parameters[k].name for k in kept.values()]
    reading, fault = with_fault(done, read_toml(model, StructureModel), before, names)
    column = done.reduced.names.index(short)
    return IdentifiedChain(done, labels, column, states, reading, tuple(remarks), fault)


def _identifiable(
    result: StructureIdentification, labels: Sequence[str], short: str
) -> tuple[dict[str, int], list[str]]:
    """Return the row of each state's stiffness where it is identifiable."""
    rows = {one.name: k for k, one in enumerate(result.parameters)}
    kept: dict[str, int] = {}
    remarks: list[str] = []
    for label in labels:
        name = f"{short}_stiffness"
        at = rows.get(f"{label}:{name}", rows.get(name) if len(labels) == 1 else None)
        if at is None:
            raise BadData(
                f"{name} is not sought in every state; leave it out of identify.shared "
                "and identify.known"
            )
        if result.parameters[at].identifiable:
            kept[label] = at
        else:
            remarks.append(f"{name} is not identifiable at {label}; left out")
    return kept, remarks


def _preload(label: str, done: IdentifiedStructure, preload: float | None) -> float:
    found = done.measured[label].preload
    found = preload if found is None else found
    if found is None:
        raise BadData(f"{label} states no preload; give it with --preload '25 kN'")
    return found


def _assemblies(sessions: Sequence[Path], labels: Sequence[str]) -> IntArray:
    """Return the session of each state: labels are its name, or name@preload."""
    names = [path.stem for path in sessions]
    own = [
        names.index(label if label in names else label.rpartition("@")[0])
        for label in labels
    ]
    return np.unique(own, return_inverse=True)[1].astype(np.int64)


def _reading(result: StructureIdentification, rows: list[int]) -> JointReading:
    """Return ln k of the states with the covariance of the identification."""
    return JointReading(
        np.log([result.parameters[k].value for k in rows]),
        result.log_covariance[np.ix_(rows, rows)],
        modes_test(result.solutions[0].chi2, result.degrees_of_freedom),
    )


def moved_body_modes(
    chain: IdentifiedChain, stiffness: MovedStiffness
) -> tuple[MovedModes, ...]:
    """Return the natural frequencies of every state.

    Those after hold the fault of a body that was named, too.

    Args:
        chain: of meshed bodies.
        stiffness: of the joint.
    """
    fits = {one.label: one for one in chain.structure.result.states}
    found = []
    for k, label in enumerate(chain.labels):
        fit, reduced = fits[label], chain.structure.reduced
        other, values = reduced, fit.stiffness
        if chain.fault is not None:
            other, values = chain.fault.state(label)
        found.append(
            MovedModes(
                float(stiffness.preload[k]),
                fit.measured,
                _frequencies(
                    *(reduced, fit.stiffness, chain.column),
                    *(float(stiffness.before[k]), fit.predicted),
                ),
                _frequencies(
                    *(other, values, chain.column),
                    *(float(stiffness.after[k]), fit.predicted),
                ),
            )
        )
    return tuple(found)


def _frequencies(
    reduced: ReducedModel,
    fitted: FloatArray,
    column: int,
    stiffness: float,
    paired: FloatArray,
) -> FloatArray:
    """Return the modes of the numbers that were measured, with another joint [Hz].

    Args:
        reduced: the structure.
        fitted: stiffness of every direction in this state [N/m], shape (n,).
        column: of the direction of the chain.
        stiffness: of it instead [N/m].
        paired: modes of the fit that were paired with the measured ones [Hz].
    """
    own = _elastic(reduced, fitted)
    number = [int(np.argmin(np.abs(own - one))) for one in paired]
    values = fitted.copy()
    values[column] = min(stiffness, reduced.box[1])
    return _elastic(reduced, values)[number]


def _elastic(reduced: ReducedModel, stiffness: FloatArray) -> FloatArray:
    modes = solve_reduced(reduced, stiffness)
    return modes.natural_frequency[modes.rigid :]
