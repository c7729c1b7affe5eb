# SPDX-License-Identifier: MIT
"""A flexible specimen with its joint, its hits and its hidden effects."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.closed_structure import (
    ClosedStructure,
    Coordinates,
    close_structure,
)
from jointbench.simulators.flexible.flexible_effects import (
    FlexibleEffect,
)
from jointbench.simulators.flexible.flexible_specimen import BoltedSpecimen
from jointbench.simulators.flexible.friction_and_stops import LawBank, law_bank
from jointbench.simulators.flexible.gauss_integration import HitSet
from jointbench.simulators.flexible.hidden_in_joint import (
    HitCondition,
    added_coordinates,
    joint_state,
    port_laws_of,
)
from jointbench.simulators.flexible.hit_records import (
    HitRecord,
)
from jointbench.simulators.flexible.joint_values import (
    BoltValues,
)
from jointbench.simulators.flexible.physical_bodies import PhysicalBody
from jointbench.simulators.flexible.sensor_chain import (
    InputNoise,
)
from jointbench.simulators.flexible.surface_nodes import along_side

COMPLIANCES = {
    "joint_compliance_tangential": slice(0, 2),
    "joint_compliance_normal": slice(2, 3),
}
"""Directions that count as rigid where these are hidden."""


@dataclass(frozen=True, slots=True, eq=False)
class FlexibleBench:
    """A specimen and everything drawn about it, before any hit is simulated.

    Attributes:
        seed: of all draws.
        world: ``exact`` or ``life``.
        specimen: as drawn.
        coordinates: its rows, with the bodies as they are.
        nominal: as the crew knows it, infinite where a direction counts as rigid.
        values: as it is.
        torques: on each bolt [N m].
        levels: peak forces [N].
        hits: in order of time.
        noise: of the inputs.
        effects: hidden ones.
    """

    seed: int
    world: str
    specimen: BoltedSpecimen
    coordinates: Coordinates
    nominal: BoltValues
    values: BoltValues
    torques: tuple[float, ...]
    levels: tuple[float, ...]
    hits: tuple[HitRecord, ...]
    noise: InputNoise
    effects: tuple[FlexibleEffect, ...] = ()

    @property
    def bodies(self) -> tuple[PhysicalBody, PhysicalBody]:
        """As they are."""
        return self.coordinates.bodies

    def condition(self, hit: HitRecord) -> HitCondition:
        """Return torque and time of a hit over those they refer to."""
        reference = float(np.median(self.torques))
        return HitCondition(
            hit.torque / reference, hit.time / max(self.hits[-1].time, 1e-9)
        )


def structure_of(
    bench: FlexibleBench, hit: HitRecord
) -> tuple[ClosedStructure, LawBank | None]:
    """Return the structure that a hit meets, and its laws."""
    condition = bench.condition(hit)
    state = joint_state(
        bench.coordinates, bench.specimen, _acting(bench), bench.effects, condition
    )
    structure = close_structure(bench.coordinates, state)
    laws = port_laws_of(bench.coordinates, state, bench.effects, condition)
    return structure, law_bank(laws, structure.lift.shape[0])


def _acting(bench: FlexibleBench) -> BoltValues:
    """Return the true values, rigid where no hidden compliance shows them."""
    stiffness = bench.values.stiffness.copy()
    names = {effect.name for effect in bench.effects}
    for name, columns in COMPLIANCES.items():
        rigid = np.isinf(bench.nominal.stiffness[:, columns])
        if name not in names and rigid.any():
            stiffness[:, columns] = np.inf
    return replace(bench.values, stiffness=stiffness)


def hit_set(
    bench: FlexibleBench, hits: Sequence[HitRecord], rows: FloatArray
) -> HitSet:
    """Return hits with their loads where they land, and rows to be observed.

    Args:
        bench: drawn.
        hits: on one structure.
        rows: shape (n_rows, n_coordinates).
    """
    extra = sum(added_coordinates(effect) for effect in bench.effects)
    load = np.stack([_load(bench, hit) for hit in hits], axis=1)
    load = np.vstack((load, np.zeros((extra, load.shape[1]))))
    rows = np.hstack((rows, np.zeros((rows.shape[0], extra))))
    return HitSet(load, lambda times: np.stack([h.force(times) for h in hits]), rows)


def _load(bench: FlexibleBench, hit: HitRecord) -> FloatArray:
    """Return the generalised force of one newton where a hit lands."""
    aimed = bench.specimen.points[hit.point]
    place = aimed.position
    for effect in bench.effects:
        if effect.name == "wrong_hit_point" and effect.where["point"] == aimed.name:
            p, body = effect.parameters, bench.specimen.bodies[aimed.body]
            place = along_side(body, aimed, p["u"], p["v"])
    x, y, z = np.asarray(place) + np.asarray(hit.offset)
    rows = bench.coordinates.rows(aimed.body, (float(x), float(y), float(z)))
    return np.asarray(np.asarray(hit.direction) @ rows)
