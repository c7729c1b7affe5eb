# SPDX-License-Identifier: MIT
"""Collect forced answers: the best explanation before the acceptance criteria.

Usage: python benchmarks/gap/forced_answers.py RUNS.jsonl [--count 216] [--seed 130000]
                                               [--kind outside]

Small campaigns with one effect: half from the catalogue, a sixth with it taken out of
the catalogue, a third outside every catalogue; half of all with scatter. The search
stops after single effects, since a pair could be right only by chance. An effect
outside every catalogue is diagnosed by the whole engine as well, and its margin is
computed with refitted rivals. One JSON line for each campaign; those that are in the
file are skipped. With --kind only campaigns of that kind are made.
"""

import argparse
import json
import sys
import tempfile
import time
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.diagnosis.diagnose import closest_of, diagnose
from jointbench.analysis.gap.diagnosis.loop import investigate
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.diagnosis_record import diagnosis_json
from jointbench.analysis.gap.model.policy import STANDARD
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.simulators.campaigns.campaign_records import (
    SimulatedCampaign,
    quick_campaign,
)
from jointbench.simulators.campaigns.write_campaign import write_campaign
from jointbench.simulators.detectability.expected_margin import (
    expected_margin,
    margin_scale,
)
from jointbench.simulators.hidden.effect_draws import CATALOGUE, OUTSIDE_CATALOGUE

KINDS = ("inside", "outside", "inside", "taken out", "inside", "outside")
SAMPLES = 512
"""Of each record that are kept: a diagnosis takes a quarter of the time."""
SINGLE = replace(STANDARD, most_samples=1.0)
"""The standard policy, with a search that ends after single effects."""


def forced(seed: int) -> dict[str, Any]:
    """Return truth and forced answer of one campaign."""
    rng = np.random.default_rng([seed, 17])
    kind = KINDS[seed % len(KINDS)]
    names = OUTSIDE_CATALOGUE if kind == "outside" else CATALOGUE
    name = str(rng.choice(names))
    size = float(np.exp(rng.uniform(np.log(0.03), 0.0)))
    scatter = float(rng.uniform(1e-3, 2e-3)) if rng.random() < 0.5 else 0.0
    made = quick_campaign(
        seed, effects=[name], size=size, grid="small", hit_scatter=scatter
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "campaign.h5"
        write_campaign(made, path)
        campaign = shortened(read_campaign(path))
    without = frozenset({name}) if kind == "taken out" else frozenset()
    start = time.process_time()
    with one_thread():
        bench = make_bench(campaign, without=without, policy=SINGLE)
        outcome = investigate(bench, lambda line: None)
    final = outcome.bench
    if not isinstance(final, LumpedBench):
        raise TypeError("a lumped bench is expected")
    closest = closest_of(outcome, final)
    truth = f"{name}@{made.effects[0].site}"
    found = {
        "seed": seed,
        "kind": kind,
        "truth": truth,
        "size": size,
        "scatter": scatter,
        "passed": outcome.acceptance.passed,
        "answer": None if closest is None else list(closest.effects),
        "right": closest is not None and closest.effects == (truth,),
        "evidence": None if closest is None else asdict(closest.evidence),
        "seconds": time.process_time() - start,
    }
    return found | whole(made, campaign) if kind == "outside" else found


def shortened(campaign: Campaign) -> Campaign:
    """Return a campaign with the first samples of each record."""
    return replace(
        campaign,
        force=campaign.force[:, :SAMPLES],
        response=campaign.response[..., :SAMPLES],
    )


def whole(made: SimulatedCampaign, campaign: Campaign) -> dict[str, Any]:
    """Return the margin of an effect, and what the whole engine says of it."""
    scale = margin_scale(made.design, samples=SAMPLES, shared=True)
    margin = expected_margin(scale, made.effects[0])
    start = time.process_time()
    found = diagnosis_json(diagnose(campaign))
    kept = ("verdict", "effects", "reason", "mostly")
    return {
        "margin": margin.margin,
        "rival": margin.rival,
        "found": {key: found[key] for key in kept},
        "seconds_whole": time.process_time() - start,
    }


def main() -> None:
    """Collect what is not in the file yet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--count", type=int, default=216)
    parser.add_argument("--seed", type=int, default=130000)
    parser.add_argument("--kind", choices=KINDS)
    arguments = parser.parse_args()
    path: Path = arguments.runs
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    done = {json.loads(line)["seed"] for line in lines}
    for seed in range(arguments.seed, arguments.seed + arguments.count):
        other = arguments.kind not in (None, KINDS[seed % len(KINDS)])
        if seed in done or other:
            continue
        with path.open("a", encoding="utf-8") as out:
            out.write(json.dumps(forced(seed)) + "\n")
        sys.stderr.write(f"\r{seed} ")


if __name__ == "__main__":
    main()
