# SPDX-License-Identifier: MIT
"""Prepare the evidence of a gap: representative record, spectra, estimates."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.evidence_facts import gather
from jointbench.analysis.gap.diagnosis.findings import advise, describe
from jointbench.analysis.gap.diagnosis.law_curves_of_fit import law_curves
from jointbench.analysis.gap.diagnosis.location import (
    condition_of,
    counted_samples,
    locate,
    most_significant_view,
    prior_deviation_words,
    relative_residuals,
)
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.effect import words_of
from jointbench.analysis.gap.model.evidence_records import (
    CampaignLimits,
    Curves,
    DirectedTest,
    GapEvidence,
    RecordEstimates,
    Spectra,
)
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.lumped.lumped_model import Output

_UNITS = {
    Output.DISPLACEMENT: "m",
    Output.VELOCITY: "m/s",
    Output.ACCELERATION: "m/s^2",
}
_SHOWN = (Finding.NAMED, Finding.AMBIGUOUS)


def make_evidence(
    bench: LumpedBench, base: Fit, outcome: SearchOutcome, finding: Finding
) -> GapEvidence:
    """Prepare the evidence of an outcome for figures and text.

    Args:
        bench: with its final noise estimate.
        base: fit without effects on that bench.
        outcome: of the search on that bench.
        finding: the verdict on it.
    """
    best = outcome.best if outcome.best.candidates else base
    residual = _cube(bench, base)
    relative = relative_residuals(bench, residual)
    record_estimates = _record_estimates(bench, base, best)
    tests = _tests(bench, base, outcome)
    models = (
        bench.response(base.base, base.terms),
        bench.response(best.base, best.terms),
    )
    curves, spectra = _representative(bench, (residual, _cube(bench, best)), models)
    facts = gather(bench, base, outcome, finding, relative["output"])
    limits = _limits(outcome, bench)
    view = most_significant_view(bench, residual, facts)
    where = ""
    look: tuple[str, ...] = ()
    if base.chi2 / bench.blocks.dof > limits.chi2_allowed:
        where = locate(bench, residual, facts)
        look = describe(bench, residual, relative, facts, record_estimates, tests)
    elif not outcome.base_acceptance.passed and _deviates(bench, base):
        where, view = prior_deviation_words(bench, base), "priors"
    elif not outcome.base_acceptance.passed:
        where = locate(bench, residual, facts)
    return GapEvidence(
        tried=words_of(best.candidates),
        where=where,
        look=look,
        advice=advise(bench, facts) if look and facts.guessed else "",
        view=view,
        relative=relative,
        curves=curves,
        spectra=spectra,
        record_estimates=record_estimates,
        limits=limits,
        tests=tests[: DIAGNOSIS.figure_tests],
        laws=law_curves(bench, best) if finding in _SHOWN else (),
    )


def _cube(bench: LumpedBench, fit: Fit) -> FloatArray:
    """Return the whitened residual, shape (n_records, n_channels, n_samples)."""
    return fit.residual.reshape(bench.campaign.response.shape)


def _deviates(bench: LumpedBench, base: Fit) -> bool:
    """Return whether a prior deviation exceeds its limit."""
    return bool(np.abs(base.prior_deviations).max() > bench.policy.prior_limit)


def _limits(outcome: SearchOutcome, bench: LumpedBench) -> CampaignLimits:
    """Return the acceptance limits of the outcome."""
    return CampaignLimits(
        chi2_per_dof=1.0 + outcome.acceptance.excess,
        chi2_allowed=1.0 + outcome.acceptance.allowed,
        remaining=outcome.acceptance.remaining,
        remaining_allowed=outcome.acceptance.remaining_allowed,
        deviation_allowed=bench.policy.prior_limit,
    )


def _tests(
    bench: LumpedBench, base: Fit, outcome: SearchOutcome
) -> tuple[DirectedTest, ...]:
    largest: dict[str, float] = {}
    for direction in outcome.base_screening.directions:
        largest.setdefault(direction.candidate.label, direction.drop)
    excess = max(base.chi2 - bench.blocks.dof, 1e-300)
    return tuple(
        DirectedTest(label, drop, min(drop / excess, 1.0))
        for label, drop in largest.items()
    )


def _representative(
    bench: LumpedBench,
    whitened: tuple[FloatArray, FloatArray],
    models: tuple[FloatArray, FloatArray],
) -> tuple[Curves, Spectra]:
    """Return curves of the record and channel with the largest share of the excess."""
    counted = counted_samples(bench)
    excess = np.maximum(np.sum(whitened[0] ** 2, axis=2) - counted, 0.0)
    if not excess.any():
        excess = np.abs(bench.campaign.response).max(axis=2)
    record, channel = (int(i) for i in np.unravel_index(excess.argmax(), excess.shape))
    share = float(excess[record, channel] / excess.sum())
    curves = _curves(bench, models, whitened, record, channel, share)
    return curves, _spectra(bench, models, whitened, record, channel)


def _curves(
    bench: LumpedBench,
    models: tuple[FloatArray, FloatArray],
    whitened: tuple[FloatArray, FloatArray],
    record: int,
    channel: int,
    share: float,
) -> Curves:
    first, last = _window(bench, whitened[0][record, channel])
    cut = slice(first, last)
    sigma = float(bench.noise.sigma[record, channel])
    return Curves(
        record=record,
        condition=condition_of(bench, record),
        channel=bench.campaign.model.channels[channel].name,
        unit=_UNITS[bench.campaign.model.output],
        share=share,
        time=np.arange(first, last) / bench.campaign.sample_rate,
        measured=bench.campaign.response[record, channel, cut],
        before=models[0][record, channel, cut],
        after=models[1][record, channel, cut],
        residual_before=-sigma * whitened[0][record, channel, cut],
        residual_after=-sigma * whitened[1][record, channel, cut],
        sigma=sigma,
    )


def _window(bench: LumpedBench, residual: FloatArray) -> tuple[int, int]:
    """Return the range of samples with the hit and most of the residual."""
    rate, n = bench.campaign.sample_rate, residual.size
    if bench.campaign.continuous:
        peak = int(np.argmax(np.abs(residual)))
        first = min(
            max(peak - DIAGNOSIS.figure_most_samples // 4, 0),
            max(n - DIAGNOSIS.figure_most_samples // 2, 0),
        )
        return first, min(first + DIAGNOSIS.figure_most_samples // 2, n)
    first = max(bench.time_gate[0] - int(DIAGNOSIS.figure_lead * rate), 0)
    power = np.cumsum(residual[first:] ** 2)
    reach = (
        int(np.searchsorted(power, DIAGNOSIS.figure_share * power[-1]))
        if power[-1] > 0
        else 0
    )
    return first, min(
        first
        + min(
            max(reach, DIAGNOSIS.figure_least_samples), DIAGNOSIS.figure_most_samples
        ),
        n,
    )


def _spectra(
    bench: LumpedBench,
    models: tuple[FloatArray, FloatArray],
    whitened: tuple[FloatArray, FloatArray],
    record: int,
    channel: int,
) -> Spectra:
    own = {k: v for k, v in bench.blocks.labels[record].items() if k != "order"}
    rows = [
        i
        for i, labels in enumerate(bench.blocks.labels)
        if all(labels[k] == v for k, v in own.items())
    ]
    campaign = bench.campaign
    force = np.fft.rfft(campaign.force[rows], axis=1)
    power = np.sum(np.abs(force) ** 2, axis=0)
    kept = np.flatnonzero(power > DIAGNOSIS.figure_force_floor**2 * power.max())
    frequency = np.fft.rfftfreq(campaign.force.shape[1], 1 / campaign.sample_rate)
    kept = kept[frequency[kept] > 0.0][: 4 * DIAGNOSIS.figure_lines]
    centres, residuals = _residual_spectra(bench, whitened)

    def ratio(response: FloatArray) -> FloatArray:
        y = np.fft.rfft(response[rows, channel], axis=1)
        h1 = np.sum(y * force.conj(), axis=0)[kept] / power[kept]
        return np.asarray(
            np.interp(centres, frequency[kept], np.abs(h1), left=np.nan, right=np.nan)
        )

    return Spectra(
        condition=condition_of(bench, record),
        channel=campaign.model.channels[channel].name,
        unit=f"{_UNITS[campaign.model.output]}/N",
        frequency=centres,
        measured=ratio(campaign.response),
        before=ratio(models[0]),
        after=ratio(models[1]),
        residual_before=residuals[0],
        residual_after=residuals[1],
    )


def _residual_spectra(
    bench: LumpedBench, whitened: tuple[FloatArray, FloatArray]
) -> tuple[FloatArray, list[FloatArray]]:
    """Return band centres [Hz] and the rms of whitened residuals in each band."""
    n = whitened[0].shape[2]
    frequency = np.fft.rfftfreq(n, 1 / bench.campaign.sample_rate)
    bands = _bands(frequency)
    starts = np.flatnonzero(np.diff(bands, prepend=-1))
    counts = np.diff(np.append(starts, bands.size))
    found = []
    for residual in whitened:
        # Lead and tail have no weight: the counted samples normalise noise to 1.
        power = np.mean(np.abs(np.fft.rfft(residual, axis=2)) ** 2, axis=(0, 1))
        power /= max(counted_samples(bench), 1)
        found.append(np.sqrt(np.add.reduceat(power[1:], starts) / counts))
    return np.add.reduceat(frequency[1:], starts) / counts, found


def _bands(frequency: NDArray[np.floating[Any]]) -> IntArray:
    """Assign lines, from the second on, to bands: single lines, then log-spaced."""
    decades = np.log10(frequency[1:] / frequency[1])
    return np.asarray(np.floor(DIAGNOSIS.figure_bands * decades), dtype=np.int64)


def _record_estimates(
    bench: LumpedBench, base: Fit, best: Fit
) -> RecordEstimates | None:
    """Estimate stiffness and damping of the joint from each record separately."""
    model, campaign = bench.campaign.model, bench.campaign
    joint = next((i for i, link in enumerate(model.links) if link.joint), None)
    if joint is None:
        return None
    columns = [len(model.bodies) + joint, len(model.bodies) + len(model.links) + joint]
    before, sd_before, taken = _freed(bench, base, columns)
    after, sd_after, _ = _freed(bench, best, columns)
    excess = max(base.chi2 - bench.blocks.dof, 1e-300)
    return RecordEstimates(
        link=model.links[joint].name,
        level=campaign.level,
        preload=campaign.preload,
        order=campaign.order,
        hit=tuple(model.bodies[int(hit)].name for hit in campaign.hit),
        stiffness=np.stack([before[:, 0], after[:, 0]], axis=1),
        stiffness_sd=np.stack([sd_before[:, 0], sd_after[:, 0]], axis=1),
        damping=np.stack([before[:, 1], after[:, 1]], axis=1),
        damping_sd=np.stack([sd_before[:, 1], sd_after[:, 1]], axis=1),
        share=float(np.clip(taken / excess, 0.0, 1.0)),
    )


def _freed(
    bench: LumpedBench, fit: Fit, columns: list[int]
) -> tuple[FloatArray, FloatArray, float]:
    """Regress each record's residual on columns of the slopes.

    Returns:
        Changes of the logarithms and their sd, (n_records, n_columns), and the total
        drop of chi2.
    """
    records = bench.campaign.response.shape[0]
    slopes = fit.jacobian[:, columns].reshape(records, -1, len(columns))
    residual = fit.residual.reshape(records, -1, 1)
    turned = slopes.transpose(0, 2, 1)
    inverse = np.linalg.pinv(turned @ slopes, hermitian=True)
    push = turned @ residual
    change = -(inverse @ push)
    taken = float(np.sum(push * (inverse @ push)))
    variance = np.diagonal(inverse, axis1=1, axis2=2)
    return change[:, :, 0], np.sqrt(np.maximum(variance, 0.0)), taken
