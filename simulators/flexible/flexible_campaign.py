# SPDX-License-Identifier: MIT
"""Hammer campaigns on flexible specimens with hidden effects."""

from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.flexible.faulty_sensors import faulty_signals, sensor_rows
from jointbench.simulators.flexible.flexible_bench import (
    FlexibleBench,
    hit_set,
    structure_of,
)
from jointbench.simulators.flexible.gauss_integration import integrate_hits
from jointbench.simulators.flexible.hit_records import SAMPLE_RATE, SAMPLES
from jointbench.simulators.flexible.sensor_chain import (
    OVERSAMPLING,
    RECORD_STEPS,
    digitised,
    sampled,
)


@dataclass(frozen=True, slots=True, eq=False)
class FlexibleCampaign:
    """A simulated campaign.

    Attributes:
        bench: everything drawn.
        counts: of each hit, shape (n_hits, 1 + n_sensors, SAMPLES).
    """

    bench: FlexibleBench
    counts: IntArray = field(repr=False)

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "counts")


def simulate_hits(bench: FlexibleBench) -> FloatArray:
    """Return force [N] and accelerations [m/s^2] of all hits, without noise.

    Returns:
        Shape (n_hits, 1 + n_sensors, SAMPLES).
    """
    place = bench.coordinates
    rows = sensor_rows(place, bench.specimen, bench.effects)
    steps = RECORD_STEPS
    step = 1 / (OVERSAMPLING * SAMPLE_RATE)
    found = np.zeros((len(bench.hits), 1 + rows.shape[0], SAMPLES))
    for group in _groups(bench):
        hits = [bench.hits[i] for i in group]
        structure, laws = structure_of(bench, hits[0])
        own = hit_set(bench, hits, rows)
        signals = integrate_hits(structure, own, laws, steps=steps, step=step)
        signals = faulty_signals(signals, bench.specimen, bench.effects, rate=1 / step)
        force = own.force(step * np.arange(steps, dtype=float))
        for index, f, seen in zip(group, force, signals, strict=True):
            found[index] = sampled(f, seen)
    return found


def _groups(bench: FlexibleBench) -> list[list[int]]:
    """Return the hits that meet the same structure."""
    drifts = any(effect.name == "thermal_drift" for effect in bench.effects)
    keys = [h.time if drifts else h.torque for h in bench.hits]
    return [[i for i, k in enumerate(keys) if k == key] for key in sorted(set(keys))]


def make_flexible_campaign(bench: FlexibleBench) -> FlexibleCampaign:
    """Simulate all hits of a bench, as its converter delivers them.

    Raises:
        UsageError: a softening spring of the bench turns over under its hits.
    """
    rng = np.random.default_rng([bench.seed, 28])
    physical = simulate_hits(bench)
    if not np.all(np.isfinite(physical)):
        names = ", ".join(effect.name for effect in bench.effects)
        raise UsageError(
            f"the bench of seed {bench.seed} ({names}) diverges under its hits; "
            "use another seed"
        )
    counts = [
        digitised(record, bench.noise, hit.time, rng)
        for record, hit in zip(physical, bench.hits, strict=True)
    ]
    return FlexibleCampaign(bench, np.stack(counts))
