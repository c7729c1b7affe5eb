# SPDX-License-Identifier: MIT
"""The chi2 that a correct fit may leave: noise, and the model error of its laws."""

from collections.abc import Sequence

from jointbench.analysis.gap.model.effect import labels_of
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.noise_models import chi2_sd


def forgiven(fit: Fit, others: Sequence[Fit], dof: int) -> float:
    """Return the chi2 that a correct fit may leave due to the model error of its laws.

    A real effect deviates from its textbook law, so a share of the chi2 that the effect
    itself explains may remain, but no share of the chi2 that another effect explains.
    Otherwise an inexact second law would excuse any residual of the first.

    Args:
        fit: of any effects.
        others: the base and the other fits; if the fit without an effect is not among
            them, the base is used instead.
        dof: degrees of freedom.
    """
    own, allowed = labels_of(fit.candidates), 0.0
    for candidate in fit.candidates:
        share = candidate.effect.error_share
        rest = own - {candidate.label}
        without = [f.chi2 for f in others if labels_of(f.candidates) == rest]
        left = min(without, default=others[0].chi2) - dof
        allowed = max(allowed, share * left)
    return allowed


def noise_sd(bench: Bench) -> float:
    """Return the sd of chi2/dof under noise, including that of the noise estimate."""
    return chi2_sd(bench.blocks.dof)
