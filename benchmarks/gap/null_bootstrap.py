# SPDX-License-Identifier: MIT
"""Draw whole campaigns from fitted bases and count false alarms of the null test.

Usage: python benchmarks/gap/null_bootstrap.py runs.jsonl --draws 250
       python benchmarks/gap/null_bootstrap.py runs.jsonl --table > docs/gap-null.md

A simulated campaign without a hidden effect is fitted; from its base, noise and
scatter new campaigns are drawn (response noise, propagated force noise, gain and
settling of every hit, nominal parameters), and base fit, noise estimate and directed
tests are run on each as on any campaign. A run continues where the file ends.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from null_directions import (
    directions,
    fixed_starts,
    linearised_drops,
    score_variance,
)
from null_page import QUANTILES, page

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.diagnosis.base_fit import fit_base
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.gap.judgement.expected_residual import noise_sd
from jointbench.analysis.gap.judgement.naming import accept
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.predict_records import respond
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.screening import screen
from jointbench.analysis.lumped.lumped_model import LumpedModel
from jointbench.simulators.campaigns.campaign_records import make_campaign
from jointbench.simulators.campaigns.write_campaign import write_campaign

# Generators and second methods that the tests use as well.
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

from jointbench.analysis.gap.second_method.verify import verify_fit

PARENTS = tuple(
    (grid, scatter, seed)
    for seed, (grid, scatter) in enumerate(
        [(g, s) for s in (0.0, 0.0015) for g in ("small", "middle", "full")], 7100
    )
)
"""Grid of hits, scatter from hit to hit, seed."""
LINEARISED = 20000
KNOWN_EVERY = 4
"""Every so many draws without scatter are judged with the true noise as well."""


def parent(grid: str, scatter: float, seed: int) -> tuple[LumpedBench, Fit]:
    """Return a simulated campaign without a hidden effect, fitted."""
    made = make_campaign(seed, grid=grid, hit_scatter=scatter)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{grid}-{seed}.h5"
        write_campaign(made, path)
        campaign = read_campaign(path)
    return fitted(campaign)


def fitted(campaign: Campaign) -> tuple[LumpedBench, Fit]:
    """Fit the base of a campaign and estimate its noise, as the engine does."""
    bench, fit = fit_base(make_bench(campaign))
    if not isinstance(bench, LumpedBench):
        raise TypeError("the loop must return the bench it was given")
    return bench, fit


def drawn_campaign(bench: LumpedBench, fit: Fit, rng: np.random.Generator) -> Campaign:
    """Draw a campaign from a fitted base."""
    campaign, noise = bench.campaign, bench.noise
    records = campaign.hit.size
    scatter = (*noise.scatter, 0.0, 0.0)
    settling = scatter[1] * rng.standard_normal(records)
    conditions = replace(bench.excitation.conditions, settling=settling)
    theta = bench.theta(fit.base)
    response = respond(
        campaign.model, theta, replace(bench.excitation, conditions=conditions)
    )
    response *= 1.0 + scatter[0] * rng.standard_normal((records, 1, 1))
    response += noise.sigma[:, :, None] * rng.standard_normal(response.shape)
    force = np.zeros_like(campaign.force)
    first, last = bench.time_gate
    force[:, first:last] = campaign.force[:, first:last]
    force += noise.force_sigma * rng.standard_normal(force.shape)
    nominal = theta * np.exp(-bench.base_sd * rng.standard_normal(theta.size))
    return replace(
        campaign,
        response=response,
        force=force,
        model=with_nominal(campaign.model, nominal),
    )


def with_nominal(model: LumpedModel, nominal: FloatArray) -> LumpedModel:
    """Return a model with other nominal values, shape (n_base,)."""
    n, links = len(model.bodies), len(model.links)
    return replace(
        model,
        bodies=tuple(
            replace(b, mass=float(m))
            for b, m in zip(model.bodies, nominal, strict=False)
        ),
        links=tuple(
            replace(
                x,
                stiffness=float(nominal[n + i]),
                damping=float(nominal[n + links + i]),
            )
            for i, x in enumerate(model.links)
        ),
    )


def judge(bench: LumpedBench, fit: Fit) -> dict[str, Any]:
    """Return what the null test makes of a fitted base."""
    tested = screen(bench, fit, bench.candidates)
    verdict = accept(bench, fit, fit, tested)
    fixed = {(c.label, *u[1:]) for c, u in fixed_starts(bench)}
    return {
        "largest": tested.largest,
        "fixed": max(
            d.drop
            for d in tested.directions
            if (d.candidate.label, *d.coordinates[1:]) in fixed
        ),
        "threshold": tested.threshold,
        "which": tested.directions[0].candidate.label,
        "chi2_per_dof": fit.chi2 / bench.blocks.dof,
        "pull": float(np.abs(fit.prior_deviations).max()),
        "reason": verdict.reason,
    }


def with_known_noise(true: LumpedBench, truth: Fit, drawn: Campaign) -> dict[str, Any]:
    """Judge a drawn campaign with the noise and scatter it was drawn from."""
    bench = replace(
        make_bench(drawn),
        noise=true.noise,
        basis=true.basis,
        shrink=true.shrink,
    )
    offset = np.log(true.campaign.model.nominal / drawn.model.nominal)
    fit = minimise(make_problem(bench, ()), truth.base + offset)
    return judge(bench, fit)


def about_parent(bench: LumpedBench, fit: Fit, seed: int) -> dict[str, Any]:
    """Return what the draws of a parent are to be compared with."""
    tested = directions(bench, fit)
    rng = np.random.default_rng([seed, 1])
    drops = linearised_drops(tested, LINEARISED, rng)
    verified = verify_fit(bench, fit)
    return {
        "draw": -1,
        "linearised": np.quantile(drops, QUANTILES).tolist(),
        "score_variance": float(score_variance(bench, fit, tested).max()),
        "found_scatter": bench.noise.scatter,
        "noise_sd": noise_sd(bench),
        "apart": float(verified.over_peak.max()),
        "chi2_apart": verified.chi2,
    } | judge(bench, fit)


def run_parent(path: Path, key: tuple[str, float, int], draws: int) -> None:
    """Draw and judge campaigns of one parent, one line each."""
    grid, scatter, seed = key
    bench, fit = parent(grid, scatter, seed)
    head = {"grid": grid, "scatter": scatter, "seed": seed}
    done = [r for r in read_runs(path) if r["seed"] == seed]
    if not done:
        append(path, head | about_parent(bench, fit, seed))
    for k in range(max(len(done) - 1, 0), draws):
        began = time.process_time()
        drawn = drawn_campaign(bench, fit, np.random.default_rng([seed, 2, k]))
        own, own_fit = fitted(drawn)
        line = head | {"draw": k, "found_scatter": own.noise.scatter}
        line |= judge(own, own_fit) | {"seconds": time.process_time() - began}
        if scatter == 0.0 and k % KNOWN_EVERY == 0:
            line["known"] = with_known_noise(bench, fit, drawn)
        append(path, line)


def append(path: Path, line: dict[str, Any]) -> None:
    """Add a line to the runs."""
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")


def read_runs(path: Path) -> list[dict[str, Any]]:
    """Return the lines of a file of runs, none where there is no file."""
    if not path.exists():
        return []
    return [json.loads(s) for s in path.read_text(encoding="utf-8").splitlines()]


def main() -> None:
    """Run, or print the page of earlier runs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--draws", type=int, default=250)
    parser.add_argument("--table", action="store_true")
    arguments = parser.parse_args()
    if arguments.table:
        sys.stdout.write(page(read_runs(arguments.runs)))
        return
    for key in PARENTS:
        run_parent(arguments.runs, key, arguments.draws)


if __name__ == "__main__":
    main()
