"""Outcomes of the gap engine without a selection, so that tests stay fast."""

from dataclasses import replace

import gap_bench as made
import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.diagnosis.base_fit import fit_base
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.judgement.naming import accept
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.screening import screen

Hidden = tuple[str, str, list[float]]


@one_thread()
def outcome_of(
    hidden: list[Hidden],
    *tried: tuple[str, str],
    seed: int = 1,
    rivals: int = 1,
    continuous: bool = False,
    at_truth: bool = False,
    samples: int = made.SAMPLES,
) -> tuple[SearchOutcome, LumpedBench]:
    """Fit the base and the tried effects to a campaign with hidden ones.

    Args:
        hidden: name, site and values of the effects in the campaign.
        tried: name and site of single explanations, best first.
        seed: of the noise.
        rivals: number of them that cannot be distinguished.
        continuous: as if excited by a shaker without a pause.
        at_truth: start each fit at the hidden values, which is fast and reliable.
        samples: of a record.
    """
    campaign = made.made_campaign(hidden, seed=seed, samples=samples)
    if continuous:
        campaign = replace(campaign, continuous=True, repeatability=1e-4)
    start = make_bench(campaign)
    refined, base = fit_base(start)
    assert isinstance(refined, LumpedBench)
    labels = [f"{name}@{site}" for name, site in tried]
    tests = screen(refined, base, [c for c in refined.candidates if linear(c.label)])
    truth = {
        f"{name}@{site}": made.term_of(start, name, site, values).coordinates
        for name, site, values in (hidden if at_truth else [])
    }
    fits = [with_effect(refined, base, label, truth.get(label)) for label in labels]
    if fits:
        again = refined.refine(fits[0].base, fits[0].terms)
        fits = [minimise(make_problem(again, f.candidates), f.x) for f in fits]
        refined = again
        base = minimise(make_problem(again, ()), base.x)
    best = fits[0] if fits else base
    null = accept(refined, base, base, tests)
    judged = accept(refined, best, base, None) if fits else null
    level = tuple(fits[:rivals]) or (base,)
    outcome = SearchOutcome(
        refined, base, null, tests, best, judged, tuple(fits), level
    )
    return outcome, refined


def linear(label: str) -> bool:
    """Return whether an effect is quick to screen."""
    return label.partition("@")[0] in {"delay", "gain_error", "added_mass", "maxwell"}


def with_effect(
    bench: LumpedBench, base: Fit, label: str, truth: FloatArray | None = None
) -> Fit:
    """Fit the base with one more effect, from a small amplitude or from the truth."""
    (candidate,) = [c for c in bench.candidates if c.label == label]
    problem = make_problem(bench, (candidate,))
    if truth is not None:
        return minimise(problem, np.concatenate([made.BASE, truth]))
    parameters = candidate.effect.parameters
    start = [p.encode(p.starts[0]) if p.starts else 1e-3 for p in parameters]
    return minimise(problem, np.concatenate([base.x, start]))
