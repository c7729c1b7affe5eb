# SPDX-License-Identifier: MIT
"""Read a joint over its preload from TOML, a table of states, or identifications."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.quoting import named
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    JointData,
    JointFacts,
    JointRows,
    JointStates,
)
from jointbench.analysis.gap.contact_bench.preload_law import PreloadLaw
from jointbench.analysis.gap.next_experiment.contact_series import joined_data
from jointbench.station.files.toml_file import read_toml
from jointbench.station.files.toml_text import load_toml
from jointbench.station.joint_states.identified_values import (
    IdentifiedParameters,
    read_identified,
)
from jointbench.station.joint_states.joint_state_tables import (
    read_covariance,
    read_state_table,
)
from jointbench.station.joint_states.loop_states import (
    SetState,
    StateLoop,
    set_states,
)
from jointbench.station.joint_states.preload_law_tables import contact_law, modulus_of
from jointbench.station.schemas.joint_states_model import (
    BodiesTable,
    BoltedJointTable,
    JointStatesModel,
    JointStateTable,
)

_MOST_STATES = 200
"""States of one joint: the covariance of all values is held and factored at once."""
_LEAST_SD = 1e-6
"""Smallest sd of a logarithm: a covariance must not be singular."""
CONE_ANGLE = math.radians(30.0)
"""Half angle of the pressure cone of a bolt: 25 to 35 degrees in VDI 2230."""


@dataclass(frozen=True, slots=True)
class MeasuredValue:
    """One value of a state.

    Attributes:
        state: index of the state.
        quantity: key, ``"kn"`` and so on.
        value: [SI].
        sd: of the logarithm [-].
        bound: whether it is only known to be larger.
        setting: index of the state in the file.
        common_sd: sd of the logarithm that it shares with the values of its loop [-].
        origin: identification and name of the parameter that it is, or None.
    """

    state: int
    quantity: str
    value: float
    sd: float
    bound: bool
    setting: int
    common_sd: float = 0.0
    origin: tuple[IdentifiedParameters, str] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class JointFile:
    """A joint over its preload, as its files state it.

    Attributes:
        data: measured values and facts.
        law: contact law.
        loops: of force and displacement, in the order of files and states.
    """

    data: JointData
    law: PreloadLaw
    loops: tuple[StateLoop, ...] = ()


def names_states(path: Path) -> bool:
    """Return whether a TOML file describes a joint over its preload."""
    try:
        content = load_toml(path)
    except (BadData, OSError, ValueError, RecursionError):
        return False  # the reader of the model reports the fault
    return "law" in content and ("states" in content or "table" in content)


def read_joint(path: Path) -> JointFile:
    """Read the measured values of a joint, its contact law and its loops.

    Args:
        path: of the TOML file; files that it names are beside it.

    Raises:
        BadData: the TOML file or one that it names breaks a rule.
    """
    model = read_toml(path, JointStatesModel)
    states = set_states(_tables(model, path.parent), path.parent)
    if len(states) > _MOST_STATES:
        raise BadData(
            f"{named(path)} names {len(states)} states, at most {_MOST_STATES} are "
            "judged together; average repeated measurements"
        )
    values = _values(states, path.parent)
    if not values:
        raise BadData(f"{named(path)} holds no measured value; add kn = '6e7 N/m' ...")
    facts = joint_facts(model.joint, model.bodies)
    data = JointData(
        path.stem,
        facts,
        _states(states),
        _rows(values, states, _covariance(path, model, len(values))),
    )
    law = contact_law(model.law, model.bodies, facts)
    loops = tuple(one.loop for one in states if one.loop is not None)
    return JointFile(data, law, loops)


def _tables(model: JointStatesModel, folder: Path) -> tuple[JointStateTable, ...]:
    if model.table is None:
        return model.states
    return read_state_table(folder / model.table)


def read_joints(paths: Sequence[Path]) -> JointFile:
    """Read the sessions of one joint as one; facts and law are those of the first.

    Args:
        paths: of TOML files, in the order of the sessions; every session is an
            assembly of its own.

    Raises:
        BadData: a file breaks a rule.
    """
    first, *others = map(read_joint, paths)
    data, loops = first.data, list(first.loops)
    for one in others:
        data = joined_data(data, one.data)
        loops += one.loops
    return JointFile(data, first.law, tuple(loops))


def _states(states: tuple[SetState, ...]) -> JointStates:
    tables = [one.table for one in states]

    def column(name: str) -> FloatArray:
        values = [getattr(s, name) for s in tables]
        return np.array([np.nan if v is None else float(v) for v in values])

    assembly = np.unique([s.assembly for s in tables], return_inverse=True)[1]
    return JointStates(
        torque=column("torque"),
        preload=column("preload"),
        preload_sd=column("preload_sd"),
        assembly=assembly.astype(np.int64),
        falling=np.array([s.branch == "falling" for s in tables]),
        time=column("time"),
        shear=column("shear"),
        frequency=column("frequency"),
        setting=np.array([one.setting for one in states]),
    )


def _values(states: tuple[SetState, ...], folder: Path) -> list[MeasuredValue]:
    """Return all values in the order of states and keys."""
    files: dict[str, IdentifiedParameters] = {}
    found = []
    for k, one in enumerate(states):
        state = one.table
        for quantity in QUANTITIES:
            key = quantity.value
            given, sd, origin = getattr(state, key), getattr(state, f"{key}_sd"), None
            if given is None and key in state.parameters and state.identified:
                name = state.identified
                if name not in files:
                    files[name] = read_identified(folder / name)
                origin = files[name], state.parameters[key]
                value = origin[0].value(origin[1])
                if value is None:
                    continue
                given, sd = (value.value, value.bound), value.sd
            if given is not None:
                own = (given[0], sd, given[1], one.setting, one.common_sd, origin)
                found.append(MeasuredValue(k, key, *own))
    return found


def _rows(
    values: list[MeasuredValue],
    states: tuple[SetState, ...],
    covariance: FloatArray | None,
) -> JointRows:
    keys = [q.value for q in QUANTITIES]
    if covariance is None:
        covariance = _own_covariance(values)
        _correlate(covariance, values, states)
    return JointRows(
        state=np.array([v.state for v in values]),
        quantity=np.array([keys.index(v.quantity) for v in values]),
        value=np.log([v.value for v in values]),
        covariance=covariance,
        bound=np.array([v.bound for v in values]),
    )


def _own_covariance(values: list[MeasuredValue]) -> FloatArray:
    """Return the covariance of loops and of values of one identification."""
    sd = np.array([max(v.sd, _LEAST_SD) for v in values])
    found = np.diag(sd**2)
    for i, one in enumerate(values):
        for j, other in enumerate(values[:i]):
            if one.setting == other.setting:
                shared = one.common_sd * other.common_sd
                found[i, j] = found[j, i] = shared
            if one.origin is None or other.origin is None or one.bound or other.bound:
                continue
            if one.origin[0] is other.origin[0]:
                factor = one.origin[0].correlation(one.origin[1], other.origin[1])
                found[i, j] = found[j, i] = factor * sd[i] * sd[j]
    return found


def _correlate(
    covariance: FloatArray, values: list[MeasuredValue], states: tuple[SetState, ...]
) -> None:
    """Write the correlations that the file states into a covariance."""
    place = {(v.state, v.quantity): i for i, v in enumerate(values)}
    for k, state in enumerate(states):
        for pair, value in state.table.correlation.items():
            one, _, other = pair.partition("_")
            if one == other or not {(k, one), (k, other)} <= place.keys():
                raise BadData(
                    f"state {state.setting + 1}: correlation {pair!r} names values "
                    "that it does not have, or one twice; write e.g. correlation = "
                    "{ kn_kt = 0.4 }"
                )
            i, j = place[k, one], place[k, other]
            root = math.sqrt(covariance[i, i] * covariance[j, j])
            covariance[i, j] = covariance[j, i] = value * root


def _covariance(
    path: Path, model: JointStatesModel, n_values: int
) -> FloatArray | None:
    if model.covariance is None:
        return None
    return read_covariance(path.parent / model.covariance, n_values)


def joint_facts(joint: BoltedJointTable, bodies: BodiesTable) -> JointFacts:
    """Return the facts of a bolted joint.

    Args:
        joint: bolts and contact surface.
        bodies: materials.
    """
    cone = None
    if joint.head_diameter is not None and joint.clamped_length is not None:
        width = joint.head_diameter + joint.clamped_length * math.tan(CONE_ANGLE)
        cone = 0.5 * width
    bolts = None
    if joint.bolt_length is not None:
        section = math.pi * joint.diameter**2 / 4.0
        bolts = joint.bolts * joint.bolt_modulus * section / joint.bolt_length
    return JointFacts(
        bolts=joint.bolts,
        diameter=joint.diameter,
        nut_factor=joint.nut_factor,
        nut_factor_sd=joint.nut_factor_sd,
        torque_scatter=joint.torque_scatter,
        reassembly=joint.reassembly,
        area=joint.area,
        modulus=modulus_of(bodies),
        poisson=bodies.poisson,
        rocking_radius=joint.rocking_radius,
        bolt_radius=joint.bolt_radius,
        cone_radius=cone,
        bolt_stiffness=bolts,
    )
