# SPDX-License-Identifier: MIT
"""The joint of meshed bodies over its preload, by the modes of every session."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.gap.chain.chain_records import (
    JointReading,
    LinkTest,
    StructureReading,
)
from jointbench.analysis.gap.chain.joint_over_preload import BoltedStates
from jointbench.analysis.gap.chain.moved_quantities import MovedModes, MovedStiffness
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.structures.identification.joint_result import (
    StateFit,
    StructureIdentification,
)
from jointbench.analysis.structures.reduction.reduced_model import solve_reduced
from jointbench.station.chain.read_chain import QUANTITY
from jointbench.station.joint_states.joint_state_files import joint_facts
from jointbench.station.joints.identify_run import (
    IdentifiedStructure,
    identified_structure,
)
from jointbench.station.schemas.bolted_joint_table import BoltedLinkTable

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
    """

    structure: IdentifiedStructure
    labels: tuple[str, ...]
    column: int
    states: BoltedStates
    reading: StructureReading
    remarks: tuple[str, ...]


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
    done = identified_structure(model, sessions)
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
    reading = StructureReading(_reading(done.result, list(kept.values())))
    column = done.reduced.names.index(short)
    return IdentifiedChain(done, labels, column, states, reading, tuple(remarks))


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
    chi2, dof = result.solutions[0].chi2, result.degrees_of_freedom
    limit = chi2_limit(CONTACT.fit_chance, dof) if dof > 0 else np.inf
    passed = chi2 <= limit
    words = "explains its modes with a free joint"
    if not passed:
        words = (
            f"chi2 of its modes is {chi2:.0f}, the limit is {limit:.0f}; state what "
            "the mesh is good for with identify.frequency_sd, or seek the effect with "
            "`jointbench gap` without --surface"
        )
    return JointReading(
        np.log([result.parameters[k].value for k in rows]),
        result.log_covariance[np.ix_(rows, rows)],
        LinkTest(chi2, max(dof, 0), bool(passed), words),
    )


def moved_body_modes(
    chain: IdentifiedChain, stiffness: MovedStiffness
) -> tuple[MovedModes, ...]:
    """Return the natural frequencies of every state.

    Args:
        chain: of meshed bodies.
        stiffness: of the joint.
    """
    fits = {one.label: one for one in chain.structure.result.states}
    found = []
    for k, label in enumerate(chain.labels):
        fit = fits[label]
        found.append(
            MovedModes(
                float(stiffness.preload[k]),
                fit.measured,
                _frequencies(chain, fit, float(stiffness.before[k])),
                _frequencies(chain, fit, float(stiffness.after[k])),
            )
        )
    return tuple(found)


def _frequencies(chain: IdentifiedChain, fit: StateFit, stiffness: float) -> FloatArray:
    """Return the modes of the numbers that were measured, with another joint [Hz]."""
    reduced = chain.structure.reduced
    own = _elastic(chain, fit.stiffness)
    number = [int(np.argmin(np.abs(own - one))) for one in fit.predicted]
    values = fit.stiffness.copy()
    values[chain.column] = min(stiffness, reduced.box[1])
    return _elastic(chain, values)[number]


def _elastic(chain: IdentifiedChain, stiffness: FloatArray) -> FloatArray:
    modes = solve_reduced(chain.structure.reduced, stiffness)
    return modes.natural_frequency[modes.rigid :]
