"""A small joint over its preload whose values follow from the bench's own formulas."""

from dataclasses import replace

import numpy as np

from jointbench.analysis.gap.contact_bench.contact_bench import (
    ContactBench,
    make_contact_bench,
)
from jointbench.analysis.gap.contact_bench.joint_states import (
    JointData,
    JointFacts,
    JointRows,
    JointStates,
)
from jointbench.analysis.gap.contact_bench.preload_law import LawParameter
from jointbench.analysis.gap.contact_bench.preload_laws import PowerPreloadLaw
from jointbench.analysis.gap.model.effect import Term

LEVELS = np.array([5.0, 10.0, 20.0, 40.0, 80.0])
NOISE = 0.02
LAW = PowerPreloadLaw(
    (
        LawParameter("stiffness", "N/m", 1e9, 0.2),
        LawParameter("exponent", "-", 0.9, 0.01),
    ),
    25e3,
    0.28,
)
FACTS = JointFacts(4, 0.016, 0.2, 0.15, 0.03, 0.2, 0.02, 1e11, 0.28)


def joint(
    effect: str = "", amplitude: float = 0.0, *, seed: int = 0, assemblies: int = 2
) -> JointData:
    """Return kn and kt at five torques, rising and falling, with a hidden effect.

    Args:
        effect: name in the catalogue, or empty.
        amplitude: of its first parameter [scale of the bench].
        seed: of scatter and noise.
        assemblies: number.
    """
    order = np.concatenate([LEVELS, LEVELS[-2::-1]])
    n = order.size * assemblies
    states = JointStates(
        torque=np.tile(order, assemblies),
        preload=np.full(n, np.nan),
        preload_sd=np.zeros(n),
        assembly=np.repeat(np.arange(assemblies), order.size),
        falling=np.tile(np.arange(order.size) >= LEVELS.size, assemblies),
        time=np.full(n, np.nan),
        shear=np.full(n, np.nan),
        frequency=np.full(n, np.nan),
    )
    data = _with_values(states, np.full(2 * n, np.log(1e9)))
    rng = np.random.default_rng(seed)
    bench = make_contact_bench(data, LAW)
    drawn = bench.base_sd * rng.standard_normal(bench.base_sd.size)
    bench = replace(bench, scales=_scales_at(bench, drawn))
    values = bench.predict(drawn, _terms(bench, effect, amplitude))
    return _with_values(states, values + NOISE * rng.standard_normal(values.size))


def _with_values(states: JointStates, values: np.ndarray) -> JointData:
    n = states.torque.size
    return JointData(
        "joint",
        FACTS,
        states,
        JointRows(
            np.repeat(np.arange(n), 2),
            np.tile([0, 1], n),
            values,
            NOISE**2 * np.eye(2 * n),
            np.zeros(2 * n, dtype=bool),
        ),
    )


def _scales_at(bench: ContactBench, base: np.ndarray) -> dict[str, float]:
    """Return the scales that the bench has once these values are measured."""
    stiffness = np.exp(bench.predict(base, ())[::2])
    return bench.scales | {
        "compliance": 1.0 / float(stiffness.max()),
        "least_stiffness": float(stiffness.min()),
    }


def _terms(bench: ContactBench, effect: str, amplitude: float) -> tuple[Term, ...]:
    if not effect:
        return ()
    candidate = next(c for c in bench.candidates if c.effect.name == effect)
    shape = [p.encode(p.starts[-1]) for p in candidate.effect.parameters[1:]]
    return (Term(candidate, np.array([amplitude, *shape])),)
