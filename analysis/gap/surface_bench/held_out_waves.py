# SPDX-License-Identifier: MIT
"""Prediction of parts of the waves of a surface from a fit to all others."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.surface_bench.surface_bench import SurfaceBench
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE


@dataclass(frozen=True, slots=True, eq=False)
class HeldOutWaves:
    """Bins of wavelength, each predicted from a fit to the bins of other parts.

    Attributes:
        omega: of each bin [rad/sample], shape (n_bins,).
        residual: of its prediction, same shape.
        rest: residual of marks and shapes, which no bin predicts, shape (n,).
    """

    omega: FloatArray
    residual: FloatArray
    rest: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "omega", "residual", "rest")

    @property
    def chi2_per_dof(self) -> float:
        """Over all bins, marks and shapes [-]."""
        both = np.concatenate([self.residual, self.rest])
        return float(np.mean(both**2)) if both.size else 1.0

    @property
    def gap(self) -> float:
        """sqrt(max(0, chi2/dof - 1)) [-]."""
        return float(np.sqrt(max(0.0, self.chi2_per_dof - 1.0)))

    @property
    def share_inside(self) -> float:
        """Share of the bins within an interval of 95 % [-]."""
        inside = np.abs(self.residual) <= SURFACE.interval_z
        return float(inside.mean()) if inside.size else 1.0


def hold_out_waves(bench: SurfaceBench, fit: Fit) -> HeldOutWaves:
    """Predict every bin of the spectrum from bins that are not its neighbours' part.

    Args:
        bench: of the fit.
        fit: with or without effects.
    """
    waves = int(np.isfinite(bench.rows.omega).sum())
    part = np.full(bench.rows.size, -1)
    part[:waves] = np.arange(waves) % SURFACE.folds
    found = np.zeros(bench.rows.size)
    for k in range(SURFACE.folds):
        others = make_problem(bench.chosen(part != k), fit.candidates)
        refitted = minimise(
            others, fit.x, FULL, iterations=SURFACE.first_steps, exact_slopes=False
        )
        held = bench.residual(refitted.base, refitted.terms, FULL)
        found[part == k] = held[part == k]
    return HeldOutWaves(bench.rows.omega[:waves], found[:waves], fit.residual[waves:])
