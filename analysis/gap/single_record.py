# SPDX-License-Identifier: MIT
"""One long record of a single-input, single-output bench, with a sheet."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.arrays import FloatArray, IntArray
from jointbench.acquisition.errors import BadData, SamplingError
from jointbench.analysis.gap.campaign import Campaign
from jointbench.analysis.gap.model import Body, Channel, Link, LumpedModel, Output


@dataclass(frozen=True, slots=True)
class SingleSheet:
    """What is known beforehand of one body on one link.

    Attributes:
        mass: nominal [input unit s^2 / output unit].
        stiffness: nominal [input unit / output unit].
        damping: nominal [input unit s / output unit].
        spread: prior sd of the logarithm of each [-].
        repeatability: relative to the peak response [-].
        output: what the channel measures.
    """

    mass: float
    stiffness: float
    damping: float
    spread: float = 0.3
    repeatability: float = 3e-3
    output: Output = Output.DISPLACEMENT


def single_campaign(
    name: str,
    excitation: FloatArray,
    response: FloatArray,
    sample_rate: float,
    starts: IntArray,
    length: int,
    sheet: SingleSheet,
    *,
    lead: int = 1024,
) -> Campaign:
    """Cut realisations out of a long record and give them a model.

    Args:
        name: as the user knows it.
        excitation: input, shape (n_samples,).
        response: output, shape (n_samples,).
        sample_rate: [Hz].
        starts: first sample of each realisation, shape (n_records,).
        length: samples of each.
        sheet: one body, one link.
        lead: samples before each start that are simulated but not scored: what the
            bench did before dies out in them.

    Raises:
        SamplingError: input and output differ in length, or a realisation with its
            lead does not lie inside the record.
        BadData: a sample is not finite.
    """
    if excitation.shape != response.shape or excitation.ndim != 1:
        raise SamplingError(
            f"input has shape {excitation.shape} and output {response.shape}; "
            "both must be one row of the same length"
        )
    if not (np.all(np.isfinite(excitation)) and np.all(np.isfinite(response))):
        raise BadData("the record holds NaN or infinite samples; cut them out")
    first, last = int(starts.min()) - lead, int(starts.max()) + length
    if first < 0 or last > excitation.size:
        raise SamplingError(
            f"realisations reach from sample {first} to {last}, the record from 0 to "
            f"{excitation.size}; shorten the lead or the realisations"
        )
    rows = starts[:, None] + np.arange(-lead, length)[None, :]
    records = starts.size
    return Campaign(
        name=name,
        sample_rate=sample_rate,
        force=excitation[rows],
        response=response[rows][:, None, :],
        hit=np.zeros(records, dtype=np.int64),
        level=np.std(excitation[rows[:, lead:]], axis=1),
        preload=np.ones(records),
        order=np.arange(records, dtype=float),
        preload_reference=1.0,
        model=_model(sheet),
        lead=lead,
        continuous=True,
        repeatability=sheet.repeatability,
    )


def _model(sheet: SingleSheet) -> LumpedModel:
    return LumpedModel(
        bodies=(Body("body", sheet.mass, sheet.spread),),
        links=(
            Link(
                "joint",
                -1,
                0,
                sheet.stiffness,
                sheet.damping,
                sheet.spread,
                sheet.spread,
                joint=True,
            ),
        ),
        channels=(Channel("y", 0),),
        output=sheet.output,
    )
