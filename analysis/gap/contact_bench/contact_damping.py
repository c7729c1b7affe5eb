# SPDX-License-Identifier: MIT
"""Effects of the contact bench that change damping, and shapes of a residual."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.contact_bench.contact_effect import (
    Act,
    ContactEffect,
    EffectPlace,
    LoadedJoint,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    ContactQuantity,
    JointData,
)
from jointbench.analysis.gap.model.effect import PROBE_FAMILY, Effect, Site
from jointbench.analysis.gap.model.effect_parameter import Parameter, Transform

_TORQUE = "add torques over a wider range"
_DIRECTIONS = (
    (ContactQuantity.NORMAL_DAMPING, "normal"),
    (ContactQuantity.TANGENTIAL_DAMPING, "tangential"),
)


def damping_effects(data: JointData) -> list[ContactEffect]:
    """Return the effects on the damping that was measured, by direction."""
    found = []
    for quantity, name in _DIRECTIONS:
        if data.measures(quantity):
            found += _parallel_damping(QUANTITIES.index(quantity), name)
    if data.measures(ContactQuantity.TANGENTIAL_DAMPING):
        found.append(_microslip(data))
    return found


def _parallel_damping(row: int, direction: str) -> list[ContactEffect]:
    """Return the dampers in parallel with the contact in one direction."""
    scale, site = f"damping_{direction}", Site("joint", direction)
    amplitude = Parameter("damping", "N s/m", scale, 0.0, 3.0, off=0.0, far=(0.5,))
    kinds: list[tuple[str, Act, str, str]] = [
        (
            "radiated_damping",
            _adds(row),
            "waves that leave through the bodies: a damping that no preload changes; "
            "Cremer, Heckl and Petersson, Structure-Borne Sound, ch. 5",
            "gas_film",
        )
    ]
    if direction == "normal":
        kinds.append(
            (
                "gas_film",
                _adds(row),
                "squeeze film, c ~ mu A^2/h^3, gap h falls with ln P: Griffin, "
                "Richardson and Yamanami 1966, J. Basic Eng. 88, 451",
                "radiated_damping",
            )
        )
    fall = Parameter(
        "gap_fall",
        "-",
        lower=0.03,
        upper=0.4,
        starts=(CONTACT.gap_slope,),
        transform=Transform.LOG,
        prior=(CONTACT.gap_slope, 0.4),
    )
    return [
        ContactEffect(
            Effect(
                name,
                "damping",
                (amplitude, fall) if name == "gas_film" else (amplitude,),
                source,
                {rival: "vacuum; " + _TORQUE},
            ),
            EffectPlace.DAMPING,
            act,
            site,
        )
        for name, act, source, rival in kinds
    ]


def _adds(row: int) -> Act:
    """Return a damper in parallel, whose gap falls with ln of the preload."""

    def act(values: FloatArray, joint: LoadedJoint) -> FloatArray:
        slope = values[1] if values.size > 1 else 0.0
        gap = np.maximum(1.0 - slope * (joint.log_preload - joint.middle), 0.2)
        found = joint.table.copy()
        found[row] = found[row] + values[0] / gap**3
        return found

    return act


def _microslip(data: JointData) -> ContactEffect:
    """Return the loss of contacts whose rims slip, tangential direction.

    Where several forces were applied at one preload, loss and stiffness are those of
    cycles up to sliding, whose shape is one more parameter.
    """
    loss = Parameter("loss", "-", "loss", 0.0, 50.0, off=0.0, far=(1.0,))
    shape = Parameter(
        "exponent",
        "-",
        lower=0.2,
        upper=2.0,
        starts=(0.5, 1.0),
        transform=Transform.LOG,
        prior=(CONTACT.slip_exponent, CONTACT.slip_exponent_sd),
    )
    return ContactEffect(
        Effect(
            "microslip_damping",
            "friction",
            (loss, shape) if data.states.several_forces else (loss,),
            source="loss of Cattaneo-Mindlin contacts grows as Q/(mu P): Johnson, "
            "Contact Mechanics, sec. 7.4; cycles by Masing 1926 with the tangent k (1 "
            "- Q/(mu P))^m",
            separates={
                "radiated_damping": "level series: slip grows with the level",
            },
        ),
        EffectPlace.DAMPING,
        _slip_loss,
        Site("joint", "tangential"),
    )


def _slip_loss(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    shear = joint.data.states.shear
    lowest = np.exp(joint.middle)
    known = np.isfinite(shear)
    relative = np.where(known, shear / np.nanmax(shear) if known.any() else 1.0, 1.0)
    row = QUANTITIES.index(ContactQuantity.TANGENTIAL_DAMPING)
    found = joint.table.copy()
    stiffness = found[QUANTITIES.index(ContactQuantity.TANGENTIAL)]
    loss = values[0] * relative * lowest / joint.preload
    if values.size > 1:
        loss = _loss_of_cycles(loss, float(values[1]))
    found[row] = found[row] + loss * stiffness / joint.omega
    return found


def _loss_of_cycles(small: FloatArray, exponent: float) -> FloatArray:
    """Return energy of a cycle over pi k u^2 from its limit for small forces, (n,).

    The tangent of first loading is k (1 - q)^m, q the force over the one that slides;
    for small q the loss is 2 m q/(3 pi).
    """
    slip = 1.5 * np.pi * small / exponent
    q = np.clip(slip, CONTACT.least_slip, CONTACT.most_ratio)
    m = exponent if abs(exponent - 1.0) > CONTACT.near_one else 1.0 - CONTACT.near_one
    left = np.log1p(-q)
    way = -np.expm1((1.0 - m) * left) / (1.0 - m)
    work = way + np.expm1((2.0 - m) * left) / (2.0 - m)
    loss = (8.0 * work - 4.0 * q * way) / (np.pi * way**2)
    # Below the least force the loss is in proportion to it, beyond sliding it grows on.
    return np.asarray(loss * slip / q)


def contact_probes(data: JointData) -> tuple[ContactEffect, ...]:
    """Return shapes of a residual that are tested but never named."""
    log_p = data.nominal_log_preload
    middle, wide = np.median(log_p), max(float(np.ptp(log_p)), 1e-6)
    x = 2.0 * (log_p - middle) / wide
    shapes = {
        "slope over preload": x,
        "curvature over preload": x**2,
        "third power of preload": x**3,
        "offset at the lowest level": 1.0 * (log_p < log_p.min() + 0.1 * wide),
        "offset at the highest level": 1.0 * (log_p > log_p.max() - 0.1 * wide),
        "offset when falling": 1.0 * data.states.falling,
        "slope when falling": x * data.states.falling,
    }
    times = data.states.time
    if np.unique(times[np.isfinite(times)]).size > 1:
        decades = np.log10(1.0 + np.where(np.isfinite(times), times, 0.0) / 60.0)
        shapes["trend with time"] = decades - decades.mean()
    found = []
    for row in np.unique(data.rows.quantity):
        for name, shape in shapes.items():
            if np.any(shape):
                found.append(_probe(int(row), name, shape))
    return tuple(found)


def _probe(row: int, name: str, shape: FloatArray) -> ContactEffect:
    def act(values: FloatArray, joint: LoadedJoint) -> FloatArray:
        found = np.zeros((len(QUANTITIES), len(shape)))
        found[row] = values[0] * shape
        return found

    return ContactEffect(
        Effect(
            name.replace(" ", "_"),
            PROBE_FAMILY,
            (Parameter("size", "-", lower=-5.0, upper=5.0, off=0.0),),
            source="shape of a residual",
        ),
        EffectPlace.VALUE,
        act,
        Site("quantity", QUANTITIES[row].value),
    )
