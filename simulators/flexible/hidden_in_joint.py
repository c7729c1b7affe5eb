# SPDX-License-Identifier: MIT
"""What hidden effects change in the structure: its linear joint, its laws, its rows."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.bolt_friction import Yielding
from jointbench.simulators.flexible.closed_structure import (
    NORMAL,
    Coordinates,
    FixedPart,
    JointAtTorque,
    Oscillator,
)
from jointbench.simulators.flexible.flexible_effects import FlexibleEffect, rocking_arms
from jointbench.simulators.flexible.flexible_specimen import (
    BODY_NAMES,
    BodyPlace,
    BoltedSpecimen,
)
from jointbench.simulators.flexible.friction_and_stops import BoltLaw, PortLawKind
from jointbench.simulators.flexible.joint_values import BoltValues

TANGENTIAL = (0, 1)
_EXPONENTS = {
    Yielding.RICHARD_ABBOTT: "yield_exponent",
    Yielding.CONTACT: "contact_exponent",
    Yielding.BOUC_WEN: "bouc_wen_exponent",
}
_RATTLER_DAMPING, _RATTLER_FREQUENCY = 0.05, 4.0  # [-], [Hz]: it rests in its cavity
_RATTLER_STIFFNESS = 400.0  # [Hz], as frequency of its mass on its stop
_TINY = 1e-12  # [m]


@dataclass(frozen=True, slots=True)
class HitCondition:
    """What the joint depends on from hit to hit.

    Attributes:
        torque_ratio: torque over the reference one [-].
        progress: time since the first hit over the time of all [-].
    """

    torque_ratio: float
    progress: float


def joint_state(
    place: Coordinates,
    specimen: BoltedSpecimen,
    values: BoltValues,
    effects: Sequence[FlexibleEffect],
    condition: HitCondition,
) -> JointAtTorque:
    """Return the linear joint, feet and attachments with effects.

    Args:
        place: rows of the specimen.
        specimen: as drawn.
        values: true values of the base.
        effects: hidden ones.
        condition: torque and time.
    """
    state = JointAtTorque(values, np.ones(len(specimen.feet)))
    for effect in effects:
        state = _changed(state, place, specimen, effect, condition)
    return state


def _changed(
    state: JointAtTorque,
    place: Coordinates,
    specimen: BoltedSpecimen,
    effect: FlexibleEffect,
    condition: HitCondition,
) -> JointAtTorque:
    p, where, values = effect.parameters, effect.where, state.values
    match effect.name:
        case "joint_compliance_rocking":
            arm = rocking_arms(specimen, str(where["axis"]))
            return replace(state, rocking=p["compliance"] * np.outer(arm, arm))
        case "loose_bolt":
            factors = np.ones(len(specimen.bolts))
            factors[int(where["bolt"])] = p["factor"]
            return replace(state, values=_scaled(values, factors, factors))
        case "contact_patch":
            arm = rocking_arms(specimen, str(where["axis"]))
            # Bolts that lie on the axis of the slope do not notice it.
            factors = 1 + p["slope"] * arm / max(np.abs(arm).max(), _TINY)
            return replace(state, values=_scaled(values, factors, factors))
        case "preload_stiffness":
            factor = condition.torque_ratio ** p["n"]
            return replace(state, values=_scaled(values, factor, factor))
        case "preload_damping":
            factor = condition.torque_ratio ** p["n"]
            return replace(state, values=_scaled(values, 1.0, factor))
        case "thermal_drift":
            factor = 1 + p["rise"] * condition.progress
            return replace(state, values=_scaled(values, factor, 1.0))
        case "modulus":
            modulus = values.modulus.copy()
            modulus[BODY_NAMES.index(str(where["body"]))] *= p["factor"]
            return replace(state, values=replace(values, modulus=modulus))
        case "support":
            feet = state.feet_factors.copy()
            feet[int(where["foot"])] *= p["factor"]
            return replace(state, feet_factors=feet)
    return _attached(state, place, specimen, effect)


def _attached(
    state: JointAtTorque,
    place: Coordinates,
    specimen: BoltedSpecimen,
    effect: FlexibleEffect,
) -> JointAtTorque:
    """Return the state with what an effect fixes to a body."""
    p = effect.parameters
    if effect.name not in {
        "added_mass",
        "added_stiffness",
        "hidden_mode",
        "rattling_mass",
    }:
        return state
    spot = named_place(specimen, effect)
    rows = place.rows(spot.body, spot.position)
    normal = np.abs(np.asarray(spot.direction)) @ rows
    if effect.name == "added_mass":
        more = FixedPart(rows, mass=p["m"])
        return replace(state, attachments=(*state.attachments, more))
    if effect.name == "added_stiffness":
        more = FixedPart(normal[None], stiffness=p["k"])
        return replace(state, attachments=(*state.attachments, more))
    if effect.name == "rattling_mass":
        own = [Oscillator(normal, p["m"], _RATTLER_FREQUENCY, _RATTLER_DAMPING)]
    else:
        moving = rows if effect.where["direction"] == "all" else normal[None]
        own = [
            Oscillator(row, p["m"], p["frequency"], p["damping_ratio"])
            for row in moving
        ]
    return replace(state, oscillators=(*state.oscillators, *own))


def added_coordinates(effect: FlexibleEffect) -> int:
    """Return how many coordinates an effect adds to those of the bodies."""
    if effect.name == "hidden_mode":
        return 3 if effect.where["direction"] == "all" else 1
    return int(effect.name == "rattling_mass")


def _scaled(
    values: BoltValues, stiffness: FloatArray | float, damping: FloatArray | float
) -> BoltValues:
    """Return values with factors of stiffness and damping per bolt."""
    count = values.stiffness.shape[0]
    own = [np.broadcast_to(x, count)[:, None] for x in (stiffness, damping)]
    return replace(
        values,
        stiffness=values.stiffness * own[0],
        damping=values.damping * own[1],
    )


def named_place(specimen: BoltedSpecimen, effect: FlexibleEffect) -> BodyPlace:
    """Return the point or the sensor at which an effect acts."""
    name = str(effect.where.get("point", effect.where.get("channel")))
    return next(
        each for each in (*specimen.points, *specimen.sensors) if each.name == name
    )


def port_laws_of(
    place: Coordinates,
    state: JointAtTorque,
    effects: Sequence[FlexibleEffect],
    condition: HitCondition,
) -> tuple[BoltLaw, ...]:
    """Return the laws that effects put at bolts, feet and hidden masses."""
    return tuple(
        law for effect in effects for law in _laws(place, state, effect, condition)
    )


def _laws(
    place: Coordinates,
    state: JointAtTorque,
    effect: FlexibleEffect,
    condition: HitCondition,
) -> Iterator[BoltLaw]:
    p, where = effect.parameters, effect.where
    if effect.name in {"microslip", "macroslip"}:
        yield from _friction(place, state, effect, condition)
        return
    if effect.name == "rattling_mass":
        own = state.oscillators[-1]
        k = own.mass * (2 * np.pi * _RATTLER_STIFFNESS) ** 2
        row = np.append(own.row, -1.0)
        yield BoltLaw(PortLawKind.SLOT, row, (k, p["g"]))
        return
    if effect.name == "foot_stop":
        row = -place.feet[int(where["foot"]), NORMAL]
        yield BoltLaw(PortLawKind.STOP, row, (p["k"], p["g"]))
        return
    kinds = {
        "clearance": (PortLawKind.STOP, "k", "g"),
        "cubic": (PortLawKind.CUBIC, "k3", ""),
        "quadratic": (PortLawKind.QUADRATIC, "k2", ""),
        "damping_law": (PortLawKind.SQUARE_DAMPING, "c2", ""),
    }
    if effect.name in kinds:
        kind, first, second = kinds[effect.name]
        row = place.bolts[int(where["bolt"]), NORMAL]
        yield BoltLaw(kind, row, (p[first], p.get(second, 0.0)))


def _friction(
    place: Coordinates,
    state: JointAtTorque,
    effect: FlexibleEffect,
    condition: HitCondition,
) -> Iterator[BoltLaw]:
    """Yield the friction of the tangential directions of one bolt or of all."""
    p, bolt = effect.parameters, effect.where["bolt"]
    bolts = range(place.bolts.shape[0]) if bolt == "all" else (int(bolt),)
    for index in bolts:
        for direction in TANGENTIAL:
            k = float(state.values.stiffness[index, direction])
            numbers = friction_numbers(p, k, condition.torque_ratio)
            yield BoltLaw(PortLawKind.FRICTION, place.bolts[index, direction], numbers)


def friction_numbers(
    p: Mapping[str, float], stiffness: float, torque_ratio: float
) -> tuple[float, ...]:
    """Return the parameters of a friction law, as `PortLawKind` states them.

    Args:
        p: parameters of the effect.
        stiffness: of the spring [N/m].
        torque_ratio: torque over the reference one [-].
    """
    # The slip force grows with the preload; the stiffness does not.
    slip = p["slip"] * torque_ratio ** p["torque_exponent"]
    way = next(way for way, key in _EXPONENTS.items() if key in p)
    exponents = p[_EXPONENTS[way]], p.get("unloading", 0.0)
    return stiffness * p["share"], slip, float(way), *exponents
