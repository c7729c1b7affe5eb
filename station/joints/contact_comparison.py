# SPDX-License-Identifier: MIT
"""Identified joints beside the contact law's prediction, state by state.

Source: Appl. Sci. 2025, 15, 9040, Fig. 9 (three torques, three models, one test).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.contact_case import ContactCase, ContactConditions
from jointbench.analysis.contact.damping import DampingChoice
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.analysis.contact.torque_to_preload import Preload
from jointbench.analysis.contact.uncertainty import Uncertainty
from jointbench.analysis.structures.identification.joint_result import (
    StructureIdentification,
)
from jointbench.station.joints.structure_contact import TheoryTable
from jointbench.station.joints.theory_records import (
    IdentifiedState,
    JointQuantity,
    StateEstimate,
    TheoryRow,
)
from jointbench.station.pipeline.contact_prediction import ContactPoint, predict_point


def known_preloads(
    table: TheoryTable, preloads: Mapping[str, tuple[float | None, float | None]]
) -> dict[str, Preload]:
    """Return the preload of every state; what the table says comes first.

    Args:
        table: of the model.
        preloads: of each state, and its standard uncertainty where it was measured [N].

    Raises:
        BadData: it is not known of a state.
    """
    found = {}
    for label, (own, measured_sd) in preloads.items():
        stated = table.preloads.get(label)
        value = own if stated is None else stated
        if value is None:
            raise BadData(
                f"state {label!r} has no preload; say it in [contact], "
                f'preloads = {{ "{label}" = "25 kN" }}'
            )
        sd = measured_sd if stated is None else None
        found[label] = table.spread_preload(value, sd)
    return found


def identified_states(
    result: StructureIdentification,
    joint: str,
    preloads: Mapping[str, Preload],
    joints: Sequence[str],
) -> tuple[IdentifiedState, ...]:
    """Take what was identified of the joint that has a contact law, state by state.

    Args:
        result: of the whole structure.
        joint: that has the law.
        preloads: on it, by state.
        joints: names of all joints that have parameters.
    """
    column = 3 * list(joints).index(joint)
    found = []
    for state in result.states:
        mode = int(np.argmax(state.energy_share[:, column]))
        values, doubtful = _values(result, joint, state.label)
        frequency = float(state.predicted[mode])
        found.append(
            IdentifiedState(
                state.label, preloads[state.label], frequency, values, doubtful
            )
        )
    return tuple(found)


def _values(
    result: StructureIdentification, joint: str, label: str
) -> tuple[dict[JointQuantity, StateEstimate], frozenset[JointQuantity]]:
    """Return what was found of one joint in one state, and what of it is open."""
    by_name = {one.name: one for one in result.parameters}
    values, doubtful = {}, set()
    for quantity in JointQuantity:
        short = f"{joint}.{quantity}"
        one = by_name.get(f"{label}:{short}", by_name.get(short))
        if one is None:
            continue
        values[quantity] = StateEstimate(one.value, *one.interval)
        if not one.identifiable:
            doubtful.add(quantity)
    return values, frozenset(doubtful)


def against_theory(
    states: Sequence[IdentifiedState], surface: ContactSurface, table: TheoryTable
) -> tuple[TheoryRow, ...]:
    """Predict every state by every model, and compare with the identification.

    Args:
        states: identified.
        surface: equivalent surface of both.
        table: models, material, bolts.

    Returns:
        A row for each state and quantity that was identified.

    Source:
        `predict.predict_contact`; the damping coefficient is eta K/omega at the
        state's own frequency, of a first loading: an upper bound.
    """
    rows = []
    for state in states:
        points = {
            name: _predict_state(name, state, surface, table) for name in table.models
        }
        for quantity, value in state.values.items():
            rows.append(
                TheoryRow(
                    state.label,
                    state.preload.value,
                    state.preload.sd,
                    table.torque(state.preload.value),
                    quantity,
                    value,
                    quantity not in state.doubtful,
                    {name: _predicted(one, quantity) for name, one in points.items()},
                )
            )
    return tuple(rows)


def _predict_state(
    model: str, state: IdentifiedState, surface: ContactSurface, table: TheoryTable
) -> ContactPoint:
    """Predict one model at the preload of one state."""
    damping = None
    if state.frequency is not None:
        damping = DampingChoice(frequency=state.frequency)
    conditions = ContactConditions(
        table.material,
        hardness_sd=table.hardness_sd * table.hardness,
        damping=damping,
    )
    law = contact_model(model, table.mode)
    return predict_point(ContactCase(law, surface, state.preload, conditions))


def _predicted(point: ContactPoint, quantity: JointQuantity) -> StateEstimate | None:
    state, found = point.state, point.uncertainty
    values = {
        JointQuantity.NORMAL_STIFFNESS: state.normal_stiffness,
        JointQuantity.NORMAL_DAMPING: state.damping,
    }
    value = values.get(quantity, state.tangential_stiffness)
    if value is None:
        return None
    part: Uncertainty | None = None
    if found is not None:
        parts = {
            JointQuantity.NORMAL_STIFFNESS: found.stiffness,
            JointQuantity.NORMAL_DAMPING: found.damping,
        }
        part = parts.get(quantity, found.tangential)
    if part is None:
        return StateEstimate(value, None, None)
    return StateEstimate(value, part.interval.lower, part.interval.upper)


def theory_json(rows: Sequence[TheoryRow]) -> list[dict[str, object]]:
    """Return the comparison as plain numbers and texts."""
    return [
        {
            "state": row.state,
            "preload_n": row.preload,
            "preload_sd_n": row.preload_sd,
            "torque_n_m": row.torque,
            "quantity": row.quantity.value,
            "unit": unit_of(row.quantity),
            "identified": row.identified.value,
            "identified_interval_95": [row.identified.low, row.identified.high],
            "identifiable": row.identifiable,
            "predicted": {
                name: None
                if one is None
                else {
                    "value": one.value,
                    "interval_95": [one.low, one.high],
                    "ratio": one.value / row.identified.value,
                    "intervals_overlap": row.identified.overlaps(one),
                }
                for name, one in row.predicted.items()
            },
        }
        for row in rows
    ]


def unit_of(quantity: JointQuantity) -> str:
    """Return the unit of a quantity."""
    return "N s/m" if quantity is JointQuantity.NORMAL_DAMPING else "N/m"
