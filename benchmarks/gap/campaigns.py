# SPDX-License-Identifier: MIT
"""Make fresh campaigns with hidden effects, each with its truth beside it.

Usage: python benchmarks/gap/campaigns.py FOLDER --kind single --count 50 --seed 1000

Kinds: null; single; pair (both margins at least 50); hidden (one effect, to be judged
with it taken out of the catalogue); outside (an effect that no catalogue has). Margins
are log-uniform from 1 to 10,000; half of the campaigns carry 0.1 to 0.2 % scatter from
hit to hit. A campaign that is already in the folder is not made again.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

from jointbench.simulators.campaigns.campaign_records import make_campaign
from jointbench.simulators.campaigns.write_campaign import write_campaign
from jointbench.simulators.hidden.effect_draws import CATALOGUE, OUTSIDE_CATALOGUE

KINDS = ("null", "single", "pair", "hidden", "outside")
NAMEABLE = 50.0
LARGEST = 1e4


def draw_effects(kind: str, seed: int, rng: np.random.Generator) -> tuple[str, ...]:
    """Return the names of what is hidden; each effect takes its turn over the seeds."""
    if kind == "null":
        return ()
    if kind == "pair":
        return tuple(rng.choice(CATALOGUE, size=2, replace=False).tolist())
    names = OUTSIDE_CATALOGUE if kind == "outside" else CATALOGUE
    return (names[seed % len(names)],)


def make_one(folder: Path, kind: str, seed: int) -> None:
    """Write one campaign and its truth."""
    path = folder / f"{kind}-{seed}.h5"
    truth_path = path.with_suffix(".json")
    if truth_path.exists():
        return
    rng = np.random.default_rng([seed, 7])
    effects = draw_effects(kind, seed, rng)
    scatter = float(rng.uniform(1e-3, 2e-3)) if rng.random() < 0.5 else 0.0
    low = NAMEABLE if kind in {"pair", "hidden"} else 1.0
    campaign = make_campaign(
        seed, effects=effects, margin=(low, LARGEST), hit_scatter=scatter
    )
    write_campaign(campaign, path)
    truth = {
        "kind": kind,
        "seed": seed,
        "truth": [effect.name for effect in campaign.effects],
        "sites": [effect.site for effect in campaign.effects],
        "parameters": [dict(effect.parameters) for effect in campaign.effects],
        "margins": [float(m.margin) for m in campaign.margins],
        "rho": [float(m.rho) for m in campaign.margins],
        "rivals": [m.rival for m in campaign.margins],
        "physical": dict(campaign.design.physical),
        "scatter": scatter,
        "noise": campaign.design.noise,
    }
    truth_path.write_text(json.dumps(truth), encoding="utf-8")


def main() -> None:
    """Fill a folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kind", choices=KINDS, default="single")
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1000)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    for seed in range(arguments.seed, arguments.seed + arguments.count):
        make_one(arguments.folder, arguments.kind, seed)
        sys.stderr.write(f"\r{arguments.kind} {seed} ")


if __name__ == "__main__":
    main()
