# SPDX-License-Identifier: MIT
"""Recurrence of a residual at other levels, in proportion to the hit.

Any cause that is linear in the motion leaves the same residual per force at every
level. The residual per force of the hardest hits is therefore compared with that of
softer ones: the share is 1 if it recurs fully, 0 if not, and negative if its sign
changes.

The base must not be fitted to the hardest hits for this comparison: a base that a
softening joint has moved to 1.3 times the true masses leaves a residual in proportion
to every hit, although the cause is not. So the base is fitted to the softer hits only.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.residuals.joint_settling import joint_at
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.scatter_record import FORCE_GAIN
from jointbench.analysis.gap.search.descent import BASE_RESOLUTIONS, fit_coarse_to_fine


class LevelScaling(StrEnum):
    """Scaling of a residual with the strength of the hit."""

    PROPORTIONAL = "proportional"
    CHANGES = "changes"
    UNDETERMINED = "undetermined"


@dataclass(frozen=True, slots=True)
class Recurrence:
    """Share of the residual of the hardest hits that recurs at a lower level.

    Attributes:
        level: nominal peak force [N].
        share: of the residual per force [-].
        sd: of `share`, due to noise and scatter from hit to hit [-].
        size: of the residual per force, over that of the hardest hits [-].
    """

    level: float
    share: float
    sd: float
    size: float


@dataclass(frozen=True, slots=True)
class Scatter:
    """One way in which hits differ from one another by chance.

    Attributes:
        sd: relative standard deviation [-].
        slope: relative change of the response, (n_records, n_channels, n_samples).
    """

    sd: float
    slope: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Softer(FitProblem):
    """A problem that ignores some of the records."""

    hidden: BoolArray

    def residual(self, x: FloatArray, resolution: Resolution) -> FloatArray:
        """Return the whitened residual at x, 0 in the ignored records."""
        seen = FitProblem.residual(self, x, resolution)
        seen.reshape(self.hidden.size, -1)[self.hidden] = 0.0
        return seen


def levels_of(bench: LumpedBench, base: Fit) -> tuple[Recurrence, ...]:
    """Compare the residuals of hard and soft hits, with the base fitted to the soft.

    Args:
        bench: measurement and noise.
        base: fit without effects, to start from.

    Returns:
        See `recurrences`.
    """
    campaign = bench.campaign
    hardest = campaign.level == campaign.level.max()
    if campaign.continuous or hardest.all():
        return ()
    whole = make_problem(bench, ())
    known = {f.name: getattr(whole, f.name) for f in fields(whole)}
    softer = fit_coarse_to_fine(
        _Softer(**known, hidden=hardest), base.base, BASE_RESOLUTIONS
    ).base
    model = bench.response(softer, ())
    return recurrences(
        bench, campaign.response - model, _scatters(bench, softer, model)
    )


def _scatters(
    bench: LumpedBench, base: FloatArray, model: FloatArray
) -> tuple[Scatter, ...]:
    """Return the scatter of the hits: in strength, and in the joint stiffness."""
    moved = base.copy()
    moved[joint_at(bench.campaign.model)] += DIAGNOSIS.level_step
    scatter = bench.noise.scatter
    gain, joint = scatter.size_of(FORCE_GAIN), scatter.joint_size
    slope = (bench.response(moved, ()) - model) / DIAGNOSIS.level_step
    return Scatter(gain, model), Scatter(joint, slope)


def recurrences(
    bench: LumpedBench, difference: FloatArray, scatters: Sequence[Scatter] = ()
) -> tuple[Recurrence, ...]:
    """Compare the residual of the hardest hits with that at lower levels.

    Args:
        bench: measurement and noise.
        difference: measured minus model, (n_records, n_channels, n_samples), any unit.
        scatters: by which hits differ from one another by chance.

    Returns:
        One for each lower level with sufficient signal, hardest first; empty if no hit
        point and preload was measured at two levels.
    """
    if bench.campaign.continuous:
        return ()
    forces = np.fft.rfft(bench.campaign.force, axis=1)
    size = np.abs(forces)
    spoken = np.all(
        size > DIAGNOSIS.level_force_floor * size.max(axis=1, keepdims=True), axis=0
    )
    forces = forces[:, spoken]

    def lines(records: FloatArray) -> ComplexArray:
        whitened = records / bench.noise.sigma[:, :, None]
        return np.asarray(np.fft.rfft(whitened, axis=2)[:, :, spoken])

    # White noise of unit variance: each part of a line has half of n.
    spectra = lines(difference) / np.sqrt(difference.shape[2] / 2)
    slopes = [
        s.sd * lines(s.slope) / np.sqrt(difference.shape[2] / 2)
        for s in scatters
        if s.sd > 0.0
    ]
    found, level = [], bench.campaign.level
    for rows in _pairings(bench):
        hard = rows[level[rows] == level[rows].max()]
        for low in np.unique(level[rows])[:-1]:
            soft = rows[level[rows] == low]
            found.append(_compare(float(low), (spectra, *slopes), forces, hard, soft))
    merged = [_merge(found, x) for x in sorted({f.level for f in found}, reverse=True)]
    return tuple(f for f in merged if f.sd < DIAGNOSIS.vague_sd)


def _pairings(bench: LumpedBench) -> list[IntArray]:
    """Return the records of each hit point and preload with several levels."""
    keys = [f"{x['hit point']}|{x['preload']}" for x in bench.blocks.labels]
    groups = [
        np.array([i for i, k in enumerate(keys) if k == key])
        for key in dict.fromkeys(keys)
    ]
    return [g for g in groups if np.unique(bench.campaign.level[g]).size > 1]


def _per_force(
    spectra: ComplexArray, forces: ComplexArray, rows: IntArray
) -> ComplexArray:
    """Return the residual per force over some hits, shape (n_channels, n_lines)."""
    push = forces[rows, None, :]
    total = np.sum(np.abs(push) ** 2, axis=0)
    return np.asarray(np.sum(spectra[rows] * push.conj(), axis=0) / total)


def _compare(
    level: float,
    spectra: Sequence[ComplexArray],
    forces: ComplexArray,
    hard: IntArray,
    soft: IntArray,
) -> Recurrence:
    """Compare the residual per force of softer hits with that of the hardest.

    Args:
        level: of the softer hits [N].
        spectra: of the residual, then of one sd of each scatter, over the noise; each
            of shape (n_records, n_channels, n_lines).
        forces: shape (n_records, n_lines).
        hard: the hardest hits.
        soft: the softer hits.
    """
    weight = np.sqrt(np.sum(np.abs(forces[soft]) ** 2, axis=0))
    top, low = (
        _parts(_per_force(spectra[0], forces, r) * weight) for r in (hard, soft)
    )
    few = np.sqrt(1.0 / soft.size + 1.0 / hard.size)
    ways = [_parts(_per_force(s, forces, hard) * weight * few) for s in spectra[1:]]
    norm = max(float(top @ _without(top, ways)), 1e-300)
    left = _without(low, ways)
    return Recurrence(
        level,
        float(top @ left) / norm,
        float(1.0 / np.sqrt(norm)),
        float(np.sqrt(max(float(low @ left) - low.size, 0.0) / norm)),
    )


def _parts(lines: ComplexArray) -> FloatArray:
    """Return real and imaginary parts in one row."""
    return np.concatenate([lines.real.ravel(), lines.imag.ravel()])


def _without(values: FloatArray, ways: Sequence[FloatArray]) -> FloatArray:
    """Weight values by the inverse covariance of noise and scatter along `ways`."""
    if not ways:
        return values
    d = np.array(ways)
    return np.asarray(
        values - d.T @ np.linalg.solve(np.eye(len(ways)) + d @ d.T, d @ values)
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


def scaling_of(found: Sequence[Recurrence]) -> LevelScaling:
    """Return the scaling of a residual from its recurrence at softer hits."""
    if not found:
        return LevelScaling.UNDETERMINED
    return LevelScaling.PROPORTIONAL if is_linear(found) else LevelScaling.CHANGES


def is_linear(found: Sequence[Recurrence]) -> bool:
    """Return whether the residual recurs fully at every level."""
    return all(abs(f.share - 1.0) < DIAGNOSIS.linear_within + 2 * f.sd for f in found)
