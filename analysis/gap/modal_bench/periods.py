# SPDX-License-Identifier: MIT
"""One period of a steady-state multisine, with the noise that its periods show."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import SamplingError
from jointbench.analysis.gap.modal_bench.level_records import LevelRecord
from jointbench.analysis.gap.modal_bench.modal_settings import MODAL


def one_period(record: LevelRecord, period: int) -> LevelRecord:
    """Average the periods after the lead, and let one of them precede as the new lead.

    The mean of n periods has the noise of one over sqrt(n), which is known from their
    scatter; a single period leaves the noise unknown.

    Args:
        record: of a periodic force in steady state after its lead.
        period: [samples].

    Raises:
        SamplingError: no period is left after the lead.
    """
    count = (record.force.shape[1] - record.lead) // period
    if count < 1:
        raise SamplingError(
            f"record {record.name!r} has {record.force.shape[1]} samples, a lead of "
            f"{record.lead} and a period of {period}; no whole period is left: shorten "
            "the lead"
        )
    force, _ = _mean(record.force, record.lead, period, count)
    response, noise = _mean(record.response, record.lead, period, count)
    times = MODAL.lead_periods + 1
    return replace(
        record,
        force=np.tile(force, times),
        response=np.tile(response, times),
        lead=MODAL.lead_periods * period,
        period=period,
        noise=noise if count >= MODAL.least_repeats else record.noise,
    )


def _mean(
    rows: FloatArray, lead: int, period: int, count: int
) -> tuple[FloatArray, FloatArray]:
    """Return the mean of the periods and its standard deviation for each row."""
    cut = rows[:, lead : lead + count * period].reshape(len(rows), count, period)
    mean = cut.mean(axis=1)
    spread = np.sum((cut - mean[:, None]) ** 2, axis=(1, 2))
    sd = np.sqrt(spread / (max(count - 1, 1) * period) / count)
    return mean, sd
