# SPDX-License-Identifier: MIT
"""End of the converter's pass band, estimated from the response of a stiff law.

Force and response are recorded through the same anti-alias filter, which cancels in the
linear part. The force of a nonlinear law arises inside the machine and is filtered only
once. A closing stop excites frequencies beyond the Nyquist frequency; an assumed pass
band that ends a hundredth of the sample rate too high causes an error of thousands of
times the noise of a quiet record. Data sheets give the pass band, not the shape of its
end, so the shape is a nuisance parameter: splines over frequency, by least squares.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.evaluation_resolutions import FINE, FULL
from jointbench.analysis.gap.residuals.lumped_residual import SomeBench
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.response.excitation import pass_band_end

KNOTS = np.arange(0.37, 0.505, 0.01)
"""Centres of the splines over the sample rate [-]."""


def with_converter_edge(
    bench: SomeBench, base: FloatArray, terms: Sequence[Term]
) -> SomeBench:
    """Return the bench with the end of the pass band estimated at a solution.

    Args:
        bench: with any filter; it is estimated again, or reset to the default. It is
            not expanded about the settling of hits.
        base: log(parameter / nominal), shape (n_base,).
        terms: effects; without a nonlinear law the end of the pass band has no
            influence.
    """
    usual = pass_band_end(_frequency(bench))
    plain = _with_taper(bench, usual)
    if not any(a.entry.law is not None for a in bench.actions(terms)):
        return plain
    splines = _splines(_frequency(bench))
    muted = usual * (1.0 - splines.sum(axis=0))
    tapers = [usual, muted, *(usual + s for s in splines)]
    residual, mute, *raised = (
        plain.residual_of(y - bench.campaign.response)
        for y in plain.tapered(base, terms, tapers, FULL.oversampling)
    )
    heard = residual - mute
    if not heard @ heard > RESIDUALS.edge_chi2:
        return plain
    slopes = np.stack([r - residual for r in raised])
    normal = slopes @ slopes.T + np.eye(len(splines)) / RESIDUALS.edge_prior_sd**2
    left = plain.residual(base, terms, FINE)
    change = np.linalg.solve(normal, -slopes @ left)
    left = left + change @ slopes
    if not left @ left < bench.policy.far_chi2 * bench.blocks.dof:
        return plain
    return _with_taper(bench, usual + change @ splines)


def _frequency(bench: SomeBench) -> FloatArray:
    """Return the lines over the sample rate, shape (n_lines,)."""
    excitation = bench.excitation
    return np.asarray(excitation.s.imag / (2 * np.pi * excitation.sample_rate))


def _splines(frequency: FloatArray) -> FloatArray:
    """Return a cubic B-spline about each knot, shape (n_knots, n_lines).

    A corner in the filter would cause ringing over the whole record.
    """
    width = KNOTS[1] - KNOTS[0]
    away = np.abs(frequency[None, :] - KNOTS[:, None]) / width
    inner = 2.0 / 3.0 - away**2 + 0.5 * away**3
    outer = np.maximum(2.0 - away, 0.0) ** 3 / 6.0
    return np.asarray(np.where(away < 1.0, inner, outer))


def _with_taper(bench: SomeBench, taper: FloatArray) -> SomeBench:
    excitation = replace(bench.excitation, taper=taper)
    return replace(bench, excitation=excitation, short={})
