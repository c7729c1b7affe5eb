# SPDX-License-Identifier: MIT
"""Diagnosis of one long record of a single-input, single-output bench."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData, SamplingError
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.diagnosis.diagnose import conclude
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.loop import investigate
from jointbench.analysis.gap.model.campaign import TAIL, Campaign
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.analysis.gap.model.nominal import NominalParameters
from jointbench.analysis.gap.model.stretch_score import StretchScore
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.analysis.gap.search.selection_round import Progress


@dataclass(frozen=True, slots=True, eq=False)
class SingleRecord:
    """A long record of one input and one output.

    Attributes:
        name: of the record, chosen by the user.
        excitation: input, shape (n_samples,).
        response: output, shape (n_samples,).
        sample_rate: [Hz].
        driven: index of the body that the input acts on.
    """

    name: str
    excitation: FloatArray
    response: FloatArray
    sample_rate: float
    driven: int = 0

    def __post_init__(self) -> None:
        """Check the rows once and make them read-only."""
        require_shape("excitation", self.excitation, (None,))
        if self.excitation.shape != self.response.shape:
            raise SamplingError(
                f"input has shape {self.excitation.shape} and output "
                f"{self.response.shape}; both must be one row of the same length"
            )
        if not np.all(np.isfinite(self.excitation) & np.isfinite(self.response)):
            raise BadData("the record holds NaN or infinite samples; cut them out")
        freeze(self, "excitation", "response")


@dataclass(frozen=True, slots=True)
class Stretch:
    """Realisations of one length in a long record.

    Attributes:
        name: for example ``"arrow"``.
        starts: first sample of each realisation.
        length: samples of each.
        lead: samples before each start that are simulated but not scored, so that the
            initial transient decays.
    """

    name: str
    starts: tuple[int, ...]
    length: int
    lead: int = 1024


def stretch_campaign(
    record: SingleRecord, stretch: Stretch, nominal: NominalParameters
) -> Campaign:
    """Cut realisations out of a long record and give them a model.

    Args:
        record: input and output.
        stretch: position of the realisations.
        nominal: model with one channel; its repeatability replaces repeats.

    Raises:
        SamplingError: a realisation with its lead is not inside the record.
    """
    starts = np.array(stretch.starts, dtype=np.int64)
    first = int(starts.min()) - stretch.lead
    last = int(starts.max()) + stretch.length
    if first < 0 or last > record.excitation.size:
        raise SamplingError(
            f"the realisations of {stretch.name!r} reach from sample {first} to "
            f"{last}, the record from 0 to {record.excitation.size}; shorten the lead "
            "or the realisations"
        )
    rows = starts[:, None] + np.arange(-stretch.lead, stretch.length)[None, :]
    force = record.excitation[rows]
    return Campaign(
        name=f"{record.name}: {stretch.name}",
        sample_rate=record.sample_rate,
        force=force,
        response=record.response[rows][:, None, :],
        hit=np.full(starts.size, record.driven, dtype=np.int64),
        level=np.std(force[:, stretch.lead :], axis=1),
        preload=np.ones(starts.size),
        order=np.arange(starts.size, dtype=float),
        preload_reference=1.0,
        model=nominal.model,
        lead=stretch.lead,
        continuous=True,
        repeatability=nominal.repeatability,
    )


def diagnose_record(
    record: SingleRecord,
    training: Stretch,
    scored: tuple[Stretch, ...],
    nominal: NominalParameters,
    *,
    without: frozenset[str] = frozenset(),
    entries: tuple[LumpedEffect, ...] = CATALOGUE,
    progress: Progress | None = None,
) -> tuple[Diagnosis, tuple[StretchScore, ...]]:
    """Diagnose one stretch of a record and score the outcome on others.

    Args:
        record: input and output.
        training: stretch used for the fits.
        scored: stretches that are not used for the fits.
        nominal: model with priors.
        without: names of effects to leave out of the catalogue.
        entries: the catalogue.
        progress: receives one line for each step of the search.

    Returns:
        The diagnosis, and the error on each scored stretch before and after. If no
        effect is named, after is the error of the best explanation tried.

    Raises:
        SamplingError: a stretch is not inside the record.
        UsageError: `without` holds a name that no entry has.
    """
    trained = make_bench(
        stretch_campaign(record, training, nominal), without=without, entries=entries
    )
    unseen = [stretch_campaign(record, stretch, nominal) for stretch in scored]
    outcome = investigate(trained, progress or (lambda line: None))
    final = outcome.bench
    if not isinstance(final, LumpedBench):
        raise TypeError("the search must return a bench of the type it was given")
    scores = []
    for stretch, campaign in zip(scored, unseen, strict=True):
        # Parameters of the fits are multiples of the scales of the trained bench.
        bench = replace(
            make_bench(campaign, without=without, entries=entries),
            scales=final.scales,
        )
        scores.append(
            StretchScore(
                stretch.name,
                _rms(bench, bench.campaign.response),
                _error(bench, outcome.base),
                _error(bench, outcome.best),
            )
        )
    return conclude(outcome, final), tuple(scores)


def _error(bench: LumpedBench, fit: Fit) -> float:
    modelled = bench.response(fit.base, fit.terms, DIAGNOSIS.scored_steps)
    return _rms(bench, modelled - bench.campaign.response)


def _rms(bench: LumpedBench, values: FloatArray) -> float:
    seen = values[:, :, bench.campaign.lead : -TAIL]
    return float(np.sqrt(np.mean(seen**2)))
