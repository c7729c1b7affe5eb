# SPDX-License-Identifier: MIT
"""Make campaigns on flexible bodies and bolts, each with its truth.

Usage: python benchmarks/gap/flexible_campaigns.py FOLDER --kind single --count 20

Kinds: null; single (one effect, each in turn); hidden (the same, to be judged with the
effect taken out of the catalogue); pair; outside (an effect that no catalogue has). A
campaign is a folder with hits.h5, its nominal values and truth.json, which holds the
margin of each effect; one that is there already is not made again. A campaign is drawn
again until each of its effects reaches the margin.
"""

import argparse
import json
import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.flexible.draw_flexible_bench import draw_bench
from jointbench.simulators.flexible.draw_specimen import SPECIMEN_KINDS
from jointbench.simulators.flexible.flexible_bench import FlexibleBench
from jointbench.simulators.flexible.flexible_campaign import (
    FlexibleCampaign,
    make_flexible_campaign,
)
from jointbench.simulators.flexible.flexible_effects import (
    FLEXIBLE_EFFECTS,
    FLEXIBLE_OUTSIDE,
)
from jointbench.simulators.flexible.flexible_margin import flexible_margin
from jointbench.simulators.flexible.physical_bodies import WORLDS
from jointbench.simulators.flexible.write_flexible import (
    flexible_truth,
    known_bench,
    write_hits,
)

KINDS = ("null", "single", "pair", "hidden", "outside")
NAMEABLE = 50.0
"""Least margin of an effect that is to be named."""
_DRAWS = 5
_NEXT = 100_000  # added to the seed of a campaign that is drawn again


def hidden_names(kind: str, seed: int, among: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the names of what is hidden; each effect takes its turn over the seeds.

    Args:
        kind: of the campaign.
        seed: of the campaign.
        among: effects to choose from; none for all of the kind.
    """
    if kind == "null":
        return ()
    names = FLEXIBLE_OUTSIDE if kind == "outside" else FLEXIBLE_EFFECTS
    chosen = tuple(among) or names
    if kind == "pair":
        rng = np.random.default_rng([seed, 29])
        first, second = rng.choice(len(chosen), size=2, replace=False)
        return chosen[first], chosen[second]
    return (chosen[seed % len(chosen)],)


def nameable_bench(
    seed: int, names: Sequence[str], *, specimen: str, world: str, least: float
) -> tuple[FlexibleBench, dict[str, object]]:
    """Return a bench whose effects reach a margin, and the margins, by name."""
    for draw in range(_DRAWS):
        bench = draw_bench(
            seed + draw * _NEXT, kind=specimen, world=world, effects=names
        )
        margins = {name: flexible_margin(bench, name) for name in names}
        if all(found.margin >= least for found in margins.values()):
            break
    return bench, {name: asdict(found) for name, found in margins.items()}


def _simulated(
    seed: int, names: Sequence[str], specimen: str, world: str
) -> tuple[FlexibleBench, dict[str, object], FlexibleCampaign]:
    """Return a bench with its margins and hits; one that diverges is drawn again."""
    for draw in range(_DRAWS):
        bench, margins = nameable_bench(
            seed + draw * _DRAWS * _NEXT,
            names,
            specimen=specimen,
            world=world,
            least=NAMEABLE,
        )
        try:
            return bench, margins, make_flexible_campaign(bench)
        except UsageError as error:
            print(error, flush=True)
    raise UsageError(f"no draw of seed {seed} stays finite; use another one")


def make_one(folder: Path, seed: int, names: Sequence[str], world: str) -> Path:
    """Write one campaign, unless it is there.

    Args:
        folder: of all campaigns.
        seed: of the campaign; the specimens take their turn.
        names: of the effects to hide.
        world: ``exact`` or ``life``.
    """
    kinds = tuple(SPECIMEN_KINDS)
    label = "-".join(names) or "none"
    specimen = kinds[seed % len(kinds)]
    place = folder / f"{specimen}-{label}-{world}-{seed}"
    if (place / "truth.json").exists():
        return place
    began = time.process_time()
    bench, margins, campaign = _simulated(seed, names, specimen, world)
    place.mkdir(parents=True, exist_ok=True)
    write_hits(campaign, place / "hits.h5")
    cost = {"cpu_s": round(time.process_time() - began, 2)}
    truth = flexible_truth(bench) | {"margins": margins} | cost
    for name, content in (("sheet", known_bench(bench)), ("truth", truth)):
        text = json.dumps(content, indent=1)
        (place / f"{name}.json").write_text(text, encoding="utf-8")
    return place


def main() -> None:
    """Fill a folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kind", choices=KINDS, default="single")
    parser.add_argument("--world", choices=WORLDS, default="exact")
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--among", nargs="*", default=[], help="effects to choose from")
    arguments = parser.parse_args()
    for seed in range(arguments.seed, arguments.seed + arguments.count):
        names = hidden_names(arguments.kind, seed, arguments.among)
        print(make_one(arguments.folder, seed, names, arguments.world), flush=True)


if __name__ == "__main__":
    main()
