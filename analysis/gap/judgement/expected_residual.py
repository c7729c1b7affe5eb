# SPDX-License-Identifier: MIT
"""The chi2 that a right fit may leave: noise, and the error of its laws."""

from collections.abc import Sequence

import numpy as np

from jointbench.analysis.gap.judgement.judgement_settings import JUDGEMENT
from jointbench.analysis.gap.model.effect import labels_of
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit

MODEL_ERROR = {
    "friction": 1e-6,
    "stiffness": 1e-7,
    "contact": 1e-6,
    "damping": 1e-6,
    "converter": 5e-6,
}
"""Share of the base's excess chi2 that a right law may leave, by its family
where the effect has no `model_error` of its own: a stop closes between steps, a smooth
law is as exact as its march, and linear damping has the share of its family; scatter
carries samples over the edge of a clip, which its slope does not tell."""
EXACT = 1e-9
"""The same for what is linear or acts on a channel: it is as exact as the base, and
any more would hide a second effect behind a great first one."""


def forgiven(fit: Fit, others: Sequence[Fit], dof: int) -> float:
    """Return the chi2 that a right fit may leave: of each effect a share of its own.

    An effect is no textbook law, so a share of what it explains may be left; of what
    another one explains, nothing. Else a second effect of a loose law would excuse
    whatever the first one leaves.

    Args:
        fit: of any effects.
        others: the base, and what else was fitted; where the fit without an effect is
            not among them, the base stands for it.
        dof: degrees of freedom.
    """
    own, allowed = labels_of(fit.candidates), 0.0
    for candidate in fit.candidates:
        effect = candidate.effect
        share = effect.model_error
        if share is None:
            share = MODEL_ERROR.get(effect.family, EXACT)
        rest = own - {candidate.label}
        without = [f.chi2 for f in others if labels_of(f.candidates) == rest]
        left = min(without, default=others[0].chi2) - dof
        allowed = max(allowed, share * left)
    return allowed


def noise_sd(bench: Bench) -> float:
    """Return the sd of chi2/dof under noise, that of the noise estimate included.

    The noise is estimated from a share of the same samples, so that what both hold
    cancels.
    """
    return float(np.sqrt(2.0 / bench.blocks.dof * (1.0 / JUDGEMENT.noise_share - 1.0)))
