# SPDX-License-Identifier: MIT
"""Covariance of a fit as its report states it."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.fit_records import Blocks, Fit
from jointbench.analysis.gap.residuals.slopes import along_columns


def stated_covariance(fit: Fit, blocks: Blocks) -> FloatArray:
    """Return the covariance of the coordinates of a fit, shape (n, n).

    It is that of the curvature, widened where chi2 exceeds its degrees of freedom.
    Where the sd of the residual holds an error of the model, that error is the same
    throughout a record, and its samples do not average it out: no sd is then below the
    one that the records show as clusters.

    Args:
        fit: with its derivatives.
        blocks: its rows as records.

    Source:
        Liang and Zeger 1986, Biometrika 73, 13: H^-1 (sum g g') H^-1 with the score g
        of each record.
    """
    inverse = fit.covariance
    covariance = inverse * max(fit.chi2 / blocks.dof, 1.0)
    records = blocks.shape[0]
    if blocks.white or records < 2:
        return np.asarray(covariance)
    count = fit.residual.size // records
    # By records: the slopes of all of them, reshaped, would be copied.
    j, r = fit.jacobian, fit.residual
    each = (slice(k * count, (k + 1) * count) for k in range(records))
    scores = np.stack([along_columns(j[own], r[own]) for own in each])
    scores *= np.sqrt(records / (records - 1))
    spread = scores.T @ scores + np.diag(fit.prior)
    shown = np.diag(inverse @ spread @ inverse)
    curved = np.maximum(np.diag(covariance), np.finfo(float).tiny)
    ratio = np.sqrt(np.maximum(shown / curved, 1.0))
    return np.asarray(covariance * np.outer(ratio, ratio))
