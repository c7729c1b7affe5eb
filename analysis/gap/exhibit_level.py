# SPDX-License-Identifier: MIT
"""Does a misfit recur at other levels, in proportion to the hit?

A cause that is linear in the motion leaves the same misfit per force at every level,
whatever it is; a nonlinear one does not, even where a refitted base hides that in the
sizes alone. So the misfit over the force of the hardest hits is looked for in softer
ones: 1 where it recurs whole, 0 where not at all, below 0 where it turns round.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.lumped import LumpedBench

FORCE_FLOOR = 0.05
"""Of the largest line of a force, below which a ratio to it says nothing."""
VAGUE = 0.15
"""Standard deviation beyond which a recurrence is not told."""
LINEAR_WITHIN = 0.35


@dataclass(frozen=True, slots=True)
class Recurrence:
    """How much of the misfit of the hardest hits recurs at a lower level.

    Attributes:
        level: nominal peak force [N].
        share: of the misfit per force [-].
        sd: of `share` by noise [-].
        size: of the misfit per force, over that of the hardest hits [-].
    """

    level: float
    share: float
    sd: float
    size: float


def recurrences(bench: LumpedBench, misfit: FloatArray) -> tuple[Recurrence, ...]:
    """Look for the misfit of the hardest hits at lower levels.

    Args:
        bench: measurement and noise.
        misfit: measured less model, (n_records, n_channels, n_samples), any unit.

    Returns:
        One for each lower level that the noise lets speak, hardest first; empty where
        no hit point and preload met two levels.
    """
    if bench.campaign.continuous:
        return ()
    spectra = np.fft.rfft(misfit / bench.noise.sigma[:, :, None], axis=2)
    forces = np.fft.rfft(bench.campaign.force, axis=1)
    size = np.abs(forces)
    spoken = np.all(size > FORCE_FLOOR * size.max(axis=1, keepdims=True), axis=0)
    spectra, forces = spectra[:, :, spoken], forces[:, spoken]
    found, n = [], misfit.shape[2]
    level = bench.campaign.level
    for rows in _pairings(bench):
        top = level[rows].max()
        hard = _per_force(spectra, forces, rows[level[rows] == top])
        for low in np.unique(level[rows]):
            if low < top:
                soft = rows[level[rows] == low]
                found.append(_compare(float(low), hard, spectra, forces, soft, n))
    merged = [_merge(found, x) for x in sorted({f.level for f in found}, reverse=True)]
    return tuple(f for f in merged if f.sd < VAGUE)


def _pairings(bench: LumpedBench) -> list[IntArray]:
    """Return the records of each hit point and preload that met several levels."""
    keys = [f"{x['hit point']}|{x['preload']}" for x in bench.blocks.labels]
    groups = [
        np.array([i for i, k in enumerate(keys) if k == key])
        for key in dict.fromkeys(keys)
    ]
    return [g for g in groups if np.unique(bench.campaign.level[g]).size > 1]


def _per_force(
    spectra: ComplexArray, forces: ComplexArray, rows: IntArray
) -> ComplexArray:
    """Return the misfit per force over some hits, shape (n_channels, n_lines)."""
    push = forces[rows, None, :]
    total = np.sum(np.abs(push) ** 2, axis=0)
    return np.asarray(np.sum(spectra[rows] * push.conj(), axis=0) / total)


def _compare(
    level: float,
    hard: ComplexArray,
    spectra: ComplexArray,
    forces: ComplexArray,
    rows: IntArray,
    samples: int,
) -> Recurrence:
    soft = _per_force(spectra, forces, rows)
    weight = np.sum(np.abs(forces[rows]) ** 2, axis=0)
    norm = float(np.sum(np.abs(hard) ** 2 * weight))
    # White noise of unit variance: its misfit per force has variance n / weight.
    noise = samples * hard.size
    share = float(np.sum((hard.conj() * soft).real * weight)) / max(norm, 1e-300)
    left = max(float(np.sum(np.abs(soft) ** 2 * weight)) - noise, 0.0)
    return Recurrence(
        level,
        share,
        float(np.sqrt(samples / 2 / max(norm, 1e-300))),
        float(np.sqrt(left / max(norm, 1e-300))),
    )


def _merge(found: Sequence[Recurrence], level: float) -> Recurrence:
    own = [f for f in found if f.level == level]
    weight = np.array([1.0 / max(f.sd, 1e-9) ** 2 for f in own])
    return Recurrence(
        level,
        float(np.average([f.share for f in own], weights=weight)),
        float(1.0 / np.sqrt(weight.sum())),
        float(np.average([f.size for f in own], weights=weight)),
    )


def is_linear(found: Sequence[Recurrence]) -> bool:
    """Return whether the misfit recurs whole at every level."""
    return all(abs(f.share - 1.0) < LINEAR_WITHIN + 2 * f.sd for f in found)
