# SPDX-License-Identifier: MIT
"""Scores on held-out records, leaving out one group at a time.

At the minimum of a fit, leaving out a group moves the parameters by one Newton step,
whose matrices are known; the residual of the group after that step is, to first order,
that of a refit without the group. The step keeps what the group has contributed to the
noise estimate and to the choice of the effect. It is therefore checked where it moves
most: noise, scatter and parameters are estimated again without that group, and its
rivals compete again. If the two disagree, further groups are refitted in the same way,
and the result states it. An effect that only the held-out group shows (the only hits
that slip, the only other preload) cannot be predicted from the other groups, so it is
left out of the prediction.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray, freeze
from jointbench.analysis.gap.judgement.judgement_settings import JUDGEMENT
from jointbench.analysis.gap.model.effect_parameter import Transform
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import (
    FINE,
    FULL,
    MIDDLE,
    Resolution,
)
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.residuals.slopes import (
    SlopeArray,
    along_columns,
    curvature,
    linear_change,
)
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.selection_round import score


@dataclass(frozen=True, slots=True, eq=False)
class HeldOut:
    """Chi2 of each group when it is held out.

    Attributes:
        chi2: shape (n_groups,).
        dof: residuals with weight in each group, shape (n_groups,).
        refitted: groups that were refitted without their records.
        discrepancy: largest difference between step and refit, relative to the refit
            [-]; None if no group was checked.
    """

    chi2: FloatArray
    dof: FloatArray
    refitted: tuple[int, ...] = ()
    discrepancy: float | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "chi2", "dof")

    @property
    def chi2_per_dof(self) -> float:
        """Over all groups [-]."""
        return float(self.chi2.sum() / self.dof.sum())

    @property
    def gap(self) -> float:
        """sqrt(max(0, chi2/dof - 1)) [-]."""
        return float(np.sqrt(max(0.0, self.chi2_per_dof - 1.0)))

    @property
    def words(self) -> str:
        """How the conditions were held out, in one clause."""
        count = len(self.chi2)
        if self.discrepancy is None:
            return f"{count} conditions held out by one step each"
        return (
            f"{len(self.refitted)} of {count} conditions held out by a refit with "
            "noise and choice of effect, the others by one step; step and refit differ "
            f"by {100 * self.discrepancy:.2g} % at most"
        )


def hold_out(
    fit: Fit,
    bench: Bench,
    bare: HeldOut | None = None,
    rivals: Sequence[Fit] = (),
) -> HeldOut:
    """Hold out each condition in turn, including its repeats.

    A single condition is predicted from the priors alone.

    Args:
        fit: a minimum.
        bench: on which it was found.
        bare: result for the fit without effects, used where all effects are left out.
        rivals: fits that compete with it again without the held-out condition.
    """
    stepped = _stepped(fit, bench, bare)
    return _checked(stepped, fit, bench, rivals)


def hold_out_by_steps(fit: Fit, blocks: Blocks) -> HeldOut:
    """Hold out each condition in turn by one Newton step, without any refit.

    Args:
        fit: a minimum, with its slopes.
        blocks: groups of its rows.
    """
    condition = conditions_of(blocks)
    hessian = curvature(fit.jacobian) + np.diag(fit.prior)
    chi2, dof = [], []
    share = blocks.dof / fit.residual.size
    for c in range(int(condition.max()) + 1):
        rows = condition[blocks.group] == c
        left = _left_out(fit, hessian, rows)
        chi2.append(float(left @ left))
        dof.append(share * rows.sum())
    return HeldOut(np.array(chi2), np.array(dof))


def _left_out(fit: Fit, hessian: FloatArray, rows: BoolArray) -> FloatArray:
    """Return the residual of rows after the step of a fit without them."""
    j, r = fit.jacobian[rows], fit.residual[rows]
    step = np.linalg.lstsq(hessian - curvature(j), along_columns(j, r), rcond=1e-12)
    return r + linear_change(j, np.asarray(step[0], np.float64))


def _stepped(fit: Fit, bench: Bench, bare: HeldOut | None) -> HeldOut:
    """Hold out each condition by one step, or by a fit where the step is long."""
    blocks = bench.blocks
    condition = conditions_of(blocks)
    hessian = curvature(fit.jacobian) + np.diag(fit.prior)
    chi2, dof = [], []
    share = blocks.dof / fit.residual.size
    for c in range(int(condition.max()) + 1):
        rows = np.isin(blocks.group, np.flatnonzero(condition == c))
        j, r = fit.jacobian[rows], fit.residual[rows]
        others = hessian - curvature(j)
        dof.append(share * rows.sum())
        left = _left_out(fit, hessian, rows)
        chi2.append(float(left @ left))
        if rows.all():
            continue
        exclusive = _shown_by_it_alone(fit, np.diag(hessian), np.diag(others))
        if bare is not None and exclusive.size and exclusive.all():
            chi2[c] = float(bare.chi2[c])
        elif exclusive.any() or chi2[c] > JUDGEMENT.refit_growth * (r @ r):
            left = _fitted_without(fit, bench, rows, exclusive)
            chi2[c] = float(left @ left)
    return HeldOut(np.array(chi2), np.array(dof))


def _checked(
    stepped: HeldOut, fit: Fit, bench: Bench, rivals: Sequence[Fit]
) -> HeldOut:
    """Check the step where it moves most, and refit more conditions if it fails."""
    condition = conditions_of(bench.blocks)
    far = stepped.chi2.sum() > bench.policy.far_chi2 * stepped.dof.sum()
    if far or len(stepped.chi2) < JUDGEMENT.least_conditions:
        return stepped
    own = np.bincount(condition[bench.blocks.group], weights=fit.residual**2)
    order = np.argsort(own - stepped.chi2)
    chi2, refitted, largest = stepped.chi2.copy(), list[int](), 0.0
    for c in order[: JUDGEMENT.most_refits].tolist():
        held = np.flatnonzero(condition == c)
        chi2[c] = _refitted(fit, bench, rivals, held)
        refitted.append(c)
        # The noise of chi2 is no disagreement.
        noise = JUDGEMENT.refit_noise_sd * np.sqrt(2.0 * stepped.dof[c])
        apart = abs(float(chi2[c] - stepped.chi2[c]))
        largest = max(largest, apart / max(float(chi2[c]), 1e-300))
        if apart < noise + JUDGEMENT.refit_tolerance * chi2[c]:
            break
    return HeldOut(chi2, stepped.dof.copy(), tuple(refitted), largest)


def _refitted(fit: Fit, bench: Bench, rivals: Sequence[Fit], held: IntArray) -> float:
    """Return chi2 of held-out groups by a refit that has not seen them.

    Noise and scatter are estimated without them, and the rivals compete without them.
    """
    rows = np.isin(bench.blocks.group, held)
    without = held.tolist()
    seen = bench.refine(fit.base, fit.terms, without=without)
    found = [_minimum_without(seen, f, rows) for f in (fit, *rivals)]
    best = min(found, key=lambda f: score(seen, f))
    seen = seen.refine(best.base, best.terms, without=without)
    again = _minimum_without(seen, best, rows)
    left = seen.residual(again.base, again.terms, FULL)[rows]
    return float(left @ left)


def _minimum_without(bench: Bench, fit: Fit, rows: BoolArray) -> Fit:
    """Return the minimum of a fit's effects with some rows held out."""
    whole = make_problem(bench, fit.candidates)
    known = {f.name: getattr(whole, f.name) for f in fields(whole)}
    return minimise(
        _Without(**known, hidden=rows),
        fit.x,
        FULL,
        iterations=JUDGEMENT.refit_iterations,
        jacobian_resolution=MIDDLE,
        exact_slopes=False,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Without(FitProblem):
    """A problem that ignores some of its rows."""

    hidden: BoolArray

    def residual(self, x: FloatArray, resolution: Resolution) -> FloatArray:
        """Return the whitened residual at x, 0 in the ignored rows."""
        seen = FitProblem.residual(self, x, resolution)
        seen[self.hidden] = 0.0
        return seen

    def base_slopes(self, x: FloatArray, resolution: Resolution) -> SlopeArray | None:
        """Return the slopes by the base, 0 in the ignored rows; None if unknown."""
        slopes = FitProblem.base_slopes(self, x, resolution)
        if slopes is not None:
            slopes[self.hidden] = 0.0
        return slopes


def _shown_by_it_alone(fit: Fit, whole: FloatArray, others: FloatArray) -> BoolArray:
    """Return the effects with a parameter that no other group determines.

    Args:
        fit: a minimum.
        whole: curvature along each coordinate from all groups, shape (n,).
        others: the same from all groups but one, shape (n,).
    """
    alone, at = [], fit.n_base
    for term in fit.terms:
        own = slice(at, at + term.coordinates.size)
        logarithmic = [
            p.transform is Transform.LOG for p in term.candidate.effect.parameters
        ]
        size = np.where(logarithmic, 1.0, np.abs(term.coordinates))
        significance = size * np.sqrt(np.maximum([whole[own], others[own]], 0.0))
        alone.append(
            bool(
                np.any(
                    (significance[0] > JUDGEMENT.shown_sd)
                    & (significance[1] < JUDGEMENT.unshown_sd)
                )
            )
        )
        at = own.stop
    return np.array(alone, dtype=bool)


def _fitted_without(
    fit: Fit, bench: Bench, rows: BoolArray, off: BoolArray
) -> FloatArray:
    """Return the residual of held-out rows at a fit to all others.

    Args:
        fit: a minimum, to start from.
        bench: on which it was found.
        rows: held-out rows, shape (n_rows,).
        off: effects to leave out, shape (n_candidates,).
    """
    kept = [t for t, o in zip(fit.terms, off, strict=True) if not o]
    whole = make_problem(bench, [t.candidate for t in kept])
    known = {f.name: getattr(whole, f.name) for f in fields(whole)}
    moved = minimise(
        _Without(**known, hidden=rows),
        np.concatenate([fit.base, *(t.coordinates for t in kept)]),
        FINE,
        iterations=JUDGEMENT.refit_iterations,
        jacobian_resolution=MIDDLE,
        exact_slopes=False,
    )
    return whole.residual(moved.x, FINE)[rows]


def conditions_of(blocks: Blocks) -> IntArray:
    """Return the condition of each group: a combination of level, point and preload."""
    keys = [
        tuple(v for k, v in sorted(labels.items()) if k != "order")
        for labels in blocks.labels
    ]
    index = {key: i for i, key in enumerate(dict.fromkeys(keys))}
    return np.array([index[key] for key in keys])
