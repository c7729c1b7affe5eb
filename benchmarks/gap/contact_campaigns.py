# SPDX-License-Identifier: MIT
"""Simulated joints over their preload, with hidden effects drawn with their size.

The physics is that of `contact_physics`: summits one by one, boundary elements,
flattened summits. Scatter is drawn here: torques uniform, assemblies lognormal with
another size than the file states, values with correlated errors.
"""

from dataclasses import dataclass, replace

import numpy as np
from contact_physics import (
    Array,
    RoughContact,
    flattened_stiffness,
    start_rms,
    summits,
    tangential,
    wave_compliance,
)

from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    JointData,
    JointFacts,
    JointRows,
    JointStates,
)
from jointbench.analysis.gap.contact_bench.preload_law import PreloadLaw
from jointbench.analysis.gap.contact_bench.preload_laws import (
    AsperityPreloadLaw,
    asperity_parameters,
)

HIDDEN = (
    "series_compliance",
    "contact_patch",
    "interaction",
    "waviness",
    "law_exponent",
    "plastic_flattening",
    "scale_cut",
    "film",
    "partial_slip",
    "prevailing_torque",
    "falling_torque",
    "relaxation",
    "radiated_damping",
    "gas_film",
    "microslip_damping",
)
_TORQUE_ONLY = {"prevailing_torque", "falling_torque", "relaxation"}
_SHEAR = {"partial_slip", "microslip_damping"}
_LEAST_BANDWIDTH = 1.25
"""Root of the smallest bandwidth that a law of Gaussian summits accepts."""
KEYS = [q.value for q in QUANTITIES]


@dataclass(frozen=True, eq=False)
class JointCampaign:
    """One simulated joint.

    Attributes:
        seed: of all draws.
        truth: name of the hidden effect, or empty.
        site: word of its site.
        data: as measured.
        clean: the same without scatter and noise.
        assembled: as it is: with the scatter of torques and assemblies, without the
            errors of an identification.
        law: contact law of the measured surface.
    """

    seed: int
    truth: str
    site: str
    data: JointData
    clean: JointData
    assembled: JointData
    law: PreloadLaw


@dataclass(frozen=True, eq=False)
class JointPlan:
    """States and quantities of a joint that is about to be measured."""

    contact: RoughContact
    facts: JointFacts
    states: JointStates
    keys: list[str]
    true_preload: Array
    friction: float
    loss: float
    effect: str
    rng: np.random.Generator


def make_joint(seed: int, effect: str) -> JointCampaign:
    """Return a joint with a hidden effect, or with none."""
    plan = plan_joint(np.random.default_rng([seed, 77]), effect)
    law, plan = measured_law(plan)
    sds = value_sds(plan)
    n = plan.states.torque.size
    clean = data_of(plan, truth_of(plan, seed, np.ones((6, n))), sds)
    plan, factors = scattered(plan)
    true = truth_of(plan, seed, factors)
    assembled = data_of(plan, true, sds)
    measured = data_of(plan, true, sds, noisy=True)
    site = {
        "radiated_damping": "joint:normal",
        "gas_film": "joint:normal",
        "microslip_damping": "joint:tangential",
    }.get(effect, "link:joint")
    return JointCampaign(seed, effect, site, measured, clean, assembled, law)


def plan_joint(rng: np.random.Generator, effect: str) -> JointPlan:
    """Return states, facts and contact of a joint."""
    levels = int(rng.integers(4, 9))
    ratio = rng.uniform(6.0, 20.0)
    torque = np.geomspace(1.0, ratio, levels) * rng.uniform(5.0, 12.0)
    falls = effect in {"plastic_flattening", "falling_torque"} or rng.random() < 0.7
    order = np.concatenate([torque, torque[-2::-1]]) if falls else torque
    falling = np.arange(order.size) >= levels
    count = int(rng.integers(2, 5))
    washer = effect not in _TORQUE_ONLY and rng.random() < 0.6
    area, modulus = rng.uniform(0.005, 0.05), np.exp(rng.uniform(*np.log([2e10, 1e11])))
    facts = JointFacts(
        bolts=int(rng.integers(2, 9)),
        diameter=float(rng.choice([0.008, 0.010, 0.012, 0.016])),
        nut_factor=0.2,
        nut_factor_sd=0.15,
        torque_scatter=rng.uniform(0.02, 0.05),
        reassembly=0.2,
        area=area,
        modulus=modulus,
        poisson=0.28,
        rocking_radius=np.sqrt(area / 12.0),
        bolt_radius=rng.uniform(0.5, 0.9) * np.sqrt(area / 12.0),
        cone_radius=rng.uniform(0.08, 0.16) * np.sqrt(area),
    )
    n = order.size * count
    nut = facts.nut_factor * np.exp(facts.nut_factor_sd * rng.standard_normal())
    nominal = facts.bolts * np.tile(order, count) / (nut * facts.diameter)
    timed = effect == "relaxation" or rng.random() < 0.5
    waits = np.exp(rng.uniform(np.log(30.0), np.log(3e4), n))
    shear = effect in _SHEAR or rng.random() < 0.3
    forces = nominal.min() * rng.choice([0.003, 0.01, 0.03, 0.06], n)
    states = JointStates(
        torque=np.tile(order, count),
        preload=nominal.copy() if washer else np.full(n, np.nan),
        preload_sd=np.full(n, rng.uniform(0.01, 0.03)),
        assembly=np.repeat(np.arange(count), order.size),
        falling=np.tile(falling, count),
        time=waits if timed else np.full(n, np.nan),
        shear=forces if shear else np.full(n, np.nan),
        frequency=np.exp(rng.uniform(np.log(300.0), np.log(900.0), n)),
    )
    kind = int(rng.integers(8))
    contact = RoughContact(kind, 1e-6, 3e-6, area, modulus, facts.poisson)
    loaded = replace(contact, area=_loaded_area(facts, effect))
    rms = start_rms(loaded, float(nominal.min()), rng.uniform(2.3, 2.7))
    return JointPlan(
        replace(contact, rms=rms),
        facts,
        states,
        _keys(rng, effect),
        nominal,
        rng.uniform(0.12, 0.3),
        np.exp(rng.normal(np.log(0.02), 0.5)),
        effect,
        rng,
    )


def _loaded_area(facts: JointFacts, effect: str) -> float:
    """Return the area that carries the preload [m^2]."""
    cones = facts.bolts * np.pi * (facts.cone_radius or 0.0) ** 2
    return min(cones, facts.area) if effect == "contact_patch" else facts.area


def _keys(rng: np.random.Generator, effect: str) -> list[str]:
    keys = ["kn"]
    if effect in _SHEAR or rng.random() < 0.85:
        keys.append("kt")
    if effect == "contact_patch" or rng.random() < 0.4:
        keys.append("kr")
    if effect in {"radiated_damping", "gas_film"} or rng.random() < 0.5:
        keys.append("cn")
    if effect == "microslip_damping" or ("kt" in keys and rng.random() < 0.4):
        keys.append("ct")
    return keys


def measured_law(plan: JointPlan) -> tuple[PreloadLaw, JointPlan]:
    """Return the law of the surface as measured, with its errors."""
    contact, rng, s = plan.contact, plan.rng, summits(plan.contact.kind)
    height, slope, bend = 1.0, s.slope, s.line_curvature
    if plan.effect == "scale_cut":
        height, slope, bend = s.coarse[float(rng.choice([2.0, 3.0, 4.0]))]
    scale = contact.rms / contact.pixel
    sds = (0.05, 0.08, 0.1, 0.03)
    errors = np.exp(np.array(sds) * rng.standard_normal(4))
    least = _LEAST_BANDWIDTH * (errors[1] * slope) ** 2 / (errors[0] * height * bend)
    errors[2] = max(errors[2], least)
    values = (
        height * contact.rms,
        slope * scale,
        bend * scale / contact.pixel,
        contact.modulus,
    )
    given = [(float(v * e), sd) for v, e, sd in zip(values, errors, sds, strict=True)]
    law = AsperityPreloadLaw(asperity_parameters(*given), contact.area, contact.poisson)
    return law, replace(plan, facts=replace(plan.facts, modulus=given[3][0]))


def truth_of(plan: JointPlan, seed: int, factors: Array) -> Array:
    """Return true stiffness and damping of each state, shape (6, n_states).

    Args:
        plan: of the joint.
        seed: of the sizes of the effect.
        factors: of the contact in this assembly, same shape.
    """
    plan = replace(plan, rng=np.random.default_rng([seed, 78]))
    p, rng, c = _preload(plan), plan.rng, plan.contact
    states, effect = plan.states, plan.effect
    if effect == "contact_patch":
        c = replace(c, area=_loaded_area(plan.facts, effect))
    kn = c.stiffness(p)
    if effect == "law_exponent":
        m = rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 0.6)
        kn = kn * (p / np.median(p)) ** m
    if effect == "plastic_flattening":
        depth = np.exp(rng.uniform(np.log(1e-4), np.log(3e-3)))
        for k in np.flatnonzero(states.falling):
            own = (states.assembly == states.assembly[k]) & ~states.falling
            top = float(p[own].max())
            kn[k] = flattened_stiffness(c, top, float(p[k]), depth)
    ratio = 2.0 * (1 - c.poisson) / (2.0 - c.poisson)
    kt = ratio * kn
    lever = (plan.facts.rocking_radius or 1.0) ** 2
    kr = kn * lever
    if effect == "partial_slip":
        share = rng.uniform(0.4, 0.95)
        # The highest force is that share of what friction holds.
        mu = float((states.shear / p).max()) / share
        kt = np.array(
            [
                tangential(c, float(a), float(q), mu)
                for a, q in zip(p, states.shear, strict=True)
            ]
        )
    contact = (factors[0] * kn, factors[1] * kt, factors[3] * kr)
    kn, kt, kr = _in_series(plan, p, contact, lever)
    omega = 2.0 * np.pi * states.frequency
    cn, ct = plan.loss * factors[4:] * np.array([kn, kt]) / omega
    cn, ct = _damped(plan, p, (cn, ct), kt / omega)
    return np.array([kn, kt, kt, kr, cn, ct])


def _preload(plan: JointPlan) -> Array:
    """Return the true preload of each state without scatter [N]."""
    states, rng, p = plan.states, plan.rng, plan.true_preload.copy()
    if plan.effect == "prevailing_torque":
        p *= 1.0 - rng.uniform(0.1, 0.8) * states.torque.min() / states.torque
    if plan.effect == "falling_torque":
        p[states.falling] *= np.exp(rng.choice([-1, 1]) * rng.uniform(0.08, 0.5))
    if plan.effect == "relaxation":
        start = rng.uniform(30.0, 100.0)
        p *= 1.0 - rng.uniform(0.02, 0.1) * np.log10(1.0 + states.time / start)
    return p


def _in_series(
    plan: JointPlan, p: Array, stiffness: tuple[Array, Array, Array], lever: float
) -> tuple[Array, Array, Array]:
    """Return kn, kt and kr with bodies, waves, patches or a film."""
    kn, kt, kr = stiffness
    rng, facts, effect = plan.rng, plan.facts, plan.effect
    normal, tangent = np.zeros(p.size), np.zeros(p.size)
    if effect == "series_compliance":
        normal += np.exp(rng.uniform(np.log(0.5), np.log(8.0))) / kn.max()
        tangent = normal * np.exp(rng.normal(np.log(1.3), 0.2))
    if effect == "interaction":
        # Mean displacement under uniform pressure on a rectangle of 1:1 to 1:3.
        normal += rng.uniform(0.85, 0.95) / (facts.modulus * np.sqrt(facts.area))
        tangent = normal * rng.uniform(1.1, 1.25)
    if effect == "waviness":
        share, curve = wave_compliance()
        close = p.max() * np.exp(rng.uniform(np.log(0.15), np.log(1.0)))
        depth = np.exp(rng.uniform(np.log(0.3), np.log(10.0))) / kn.max()
        normal += np.pi * depth * np.interp(p / close, share, curve)
        tangent = normal * rng.uniform(1.1, 1.25)
    rocking = normal / lever
    if effect == "contact_patch":
        radius, circle = facts.cone_radius or 1.0, facts.bolt_radius or 1.0
        apart = (
            2.8284 * circle * np.sin(np.pi * np.arange(1, facts.bolts) / facts.bolts)
        )
        alone = 16.0 / (3.0 * np.pi**2) / (facts.modulus * radius)
        near = np.sum(1.0 / (np.pi * facts.modulus * np.maximum(apart, 2 * radius)))
        normal += (alone + near) / facts.bolts
        own = circle**2 + 0.25 * radius**2
        tangent, rocking = 1.2 * normal, alone / facts.bolts / own
        kr = kr * own / lever
    if effect == "film":
        extra = np.exp(rng.uniform(np.log(0.3), np.log(5.0))) * kn.min()
        kn, kr = kn + extra, kr + extra * lever
    return kn / (1 + normal * kn), kt / (1 + tangent * kt), kr / (1 + rocking * kr)


def _damped(
    plan: JointPlan, p: Array, damping: tuple[Array, Array], slip: Array
) -> tuple[Array, Array]:
    """Return cn and ct with what leaves or is lost beside the contact's own loss."""
    cn, ct = damping
    rng, effect = plan.rng, plan.effect
    size = np.exp(rng.uniform(np.log(0.3), np.log(10.0)))
    if effect == "radiated_damping":
        cn = cn + size * cn.min()
    if effect == "gas_film":
        gap = plan.contact.gap(p)
        # Closed surfaces keep a thousandth of the gap in their valleys.
        left = np.maximum(gap, 1e-3 * gap.max())
        cn = cn + size * cn.min() * (left.max() / left) ** 3
    if effect == "microslip_damping":
        x = np.minimum(plan.states.shear / (plan.friction * p), 0.95)
        # Loss of Cattaneo and Mindlin over the energy that is stored, to all orders.
        left = 1.0 - x
        loss = 1.0 - left ** (5 / 3) - 5.0 * x / 6.0 * (1.0 + left ** (2 / 3))
        shape = loss / x**2
        ct = ct + plan.loss * size * shape / shape.max() * slip
    return cn, ct


def value_sds(plan: JointPlan) -> dict[str, float]:
    """Return the relative sd of the values of each quantity."""
    rng = plan.rng
    sds = {key: rng.uniform(0.01, 0.03) for key in ("kn", "kt", "kr")}
    return sds | {key: rng.uniform(0.04, 0.12) for key in ("cn", "ct")}


def scattered(plan: JointPlan) -> tuple[JointPlan, Array]:
    """Return the plan with scattered preloads, and the contact of each assembly."""
    rng, states = plan.rng, plan.states
    n, count = states.torque.size, int(states.assembly.max()) + 1
    # Uniform, as wrenches with a dead band scatter; same sd as stated.
    wide = np.sqrt(3.0) * plan.facts.torque_scatter
    preload = plan.true_preload * np.exp(rng.uniform(-wide, wide, n))
    if not states.by_torque.any():
        reading = preload * np.exp(states.preload_sd * rng.standard_normal(n))
        states = replace(states, preload=reading)
    size = rng.uniform(0.1, 0.3)
    common = size * rng.standard_normal(count)
    own = 0.3 * size * rng.standard_normal((6, count))
    common_to_stiffness = np.outer([1.0, 1.0, 1.0, 1.0, 0.0, 0.0], common)
    factors = np.exp(common_to_stiffness + own)[:, states.assembly]
    return replace(plan, states=states, true_preload=preload), factors


def data_of(
    plan: JointPlan, table: Array, sds: dict[str, float], *, noisy: bool = False
) -> JointData:
    """Return the joint as measured, with the errors of identification if noisy."""
    n = plan.states.torque.size
    rows = [KEYS.index(key) for key in plan.keys]
    state = np.repeat(np.arange(n), len(rows))
    quantity = np.tile(rows, n)
    own = np.array([sds[KEYS[q]] for q in quantity])
    same = state[:, None] == state[None, :]
    covariance = np.outer(own, own) * np.where(same, 0.3, 0.0)
    covariance[np.diag_indices_from(covariance)] = own**2
    values = np.log(table[quantity, state])
    if noisy:
        error = plan.rng.standard_normal(own.size)
        values = values + np.linalg.cholesky(covariance) @ error
    return JointData(
        f"joint-{plan.effect or 'none'}",
        plan.facts,
        plan.states,
        JointRows(state, quantity, values, covariance, np.zeros(state.size, bool)),
    )
