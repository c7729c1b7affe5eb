# SPDX-License-Identifier: MIT
"""Vary each decision setting of the gap engine by 30 % down and up, on 20 campaigns.

Usage: OMP_NUM_THREADS=1 python benchmarks/gap/policy_sweep.py run FOLDER RUNS.jsonl
           [--settings chi2_limit,rival_score] [--kinds null,single] [--minutes 30]
       python benchmarks/gap/policy_sweep.py page RUNS.jsonl > docs/gap-policy.md
       python benchmarks/gap/policy_sweep.py effects RUNS.jsonl

The campaigns are made in FOLDER if they are not there: 7 without an effect, 9 with one
and 4 with two, on the small grid of 8 hits. RUNS.jsonl holds one line for each setting,
factor and campaign; a run continues where it was, and may be ended at any time.
`effects` prints what the policy states as the effect of each setting.
"""

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from campaigns import draw_effects
from judge import judge_one
from outcomes import Run, word_of

from jointbench.analysis.gap.catalogue.catalogue_settings import CATALOGUE_SETTINGS
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.intake.intake_settings import HITS, INTAKE
from jointbench.analysis.gap.judgement.judgement_settings import JUDGEMENT
from jointbench.analysis.gap.modal_bench.modal_settings import MODAL
from jointbench.analysis.gap.model.campaign_settings import CAMPAIGN
from jointbench.analysis.gap.model.confidence_settings import CONFIDENCE
from jointbench.analysis.gap.model.policy import STANDARD, Policy, policy_digest
from jointbench.analysis.gap.model.setting import Setting, settings_of
from jointbench.analysis.gap.model_error.model_error_settings import (
    MODEL_ERROR_SETTINGS,
)
from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS
from jointbench.analysis.gap.response.response_settings import RESPONSE
from jointbench.analysis.gap.search.search_settings import SEARCH
from jointbench.analysis.gap.second_method.second_method_settings import (
    SECOND_METHOD,
)
from jointbench.analysis.gap.structure_response.modal_table_settings import MODAL_TABLE
from jointbench.analysis.gap.structure_response.port_law_settings import PORT_LAWS
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)
from jointbench.analysis.gap.structure_search.weak_settings import WEAK
from jointbench.simulators.campaigns.campaign_records import make_campaign
from jointbench.simulators.campaigns.write_campaign import write_campaign

CAMPAIGNS: tuple[tuple[str, int], ...] = (
    *(("null", seed) for seed in range(121000, 121007)),
    *(("single", seed) for seed in range(121100, 121109)),
    *(("pair", seed) for seed in (121202, 121203, 121205, 121206)),
)
GRID = "small"
MARGINS = {"null": (1.0, 1.0), "single": (5.0, 100.0), "pair": (20.0, 200.0)}
"""Ranges of the expected margin, drawn log-uniformly: about what can just be named."""
FACTORS = (0.7, 1.3)
PARTS: Mapping[str, Any] = {
    "model": CAMPAIGN,
    "response": RESPONSE,
    "catalogue": CATALOGUE_SETTINGS,
    "residuals": RESIDUALS,
    "intake": INTAKE,
    "search": SEARCH,
    "judgement": JUDGEMENT,
    "confidence": CONFIDENCE,
    "diagnosis": DIAGNOSIS,
    "second method": SECOND_METHOD,
    "model error": MODEL_ERROR_SETTINGS,
    "modes and ports": MODAL,
    "bolted bodies": STRUCTURE,
    "laws at bolts": PORT_LAWS,
    "uncertain tables of bolted bodies": MODAL_TABLE,
    "search on bolted bodies": STRUCTURE_SEARCH,
    "weak effects on bolted bodies": WEAK,
    "raw hits": HITS,
}
"""The numerical settings by part of the engine."""
UNDER_MODEL_ERROR = ("mostly_", "open_", "floor_")
"""Decision settings that no campaign of the sweep reaches: model error, structures."""
AS_IT_IS = "none"
"""Name of the run with the standard policy."""


def varied(name: str, factor: float) -> Policy:
    """Return the standard policy with one setting times a factor.

    A whole number is rounded away from its value, so that it changes.
    """
    value = getattr(STANDARD, name)
    if isinstance(value, int):
        moved = round(value * factor)
        step = 1 if factor > 1.0 else -1
        return replace(STANDARD, **{name: moved if moved != value else value + step})
    return replace(STANDARD, **{name: value * factor})


def make_small(folder: Path, kind: str, seed: int) -> Path:
    """Write a campaign and its truth, if it is not there; return the truth's path."""
    path = folder / f"{kind}-{seed}.h5"
    known = path.with_suffix(".json")
    if known.exists():
        return known
    rng = np.random.default_rng([seed, 7])
    effects = draw_effects(kind, seed, rng)
    scatter = float(rng.uniform(1e-3, 2e-3)) if rng.random() < 0.5 else 0.0
    campaign = make_campaign(
        seed, effects=effects, margin=MARGINS[kind], grid=GRID, hit_scatter=scatter
    )
    write_campaign(campaign, path)
    truth = {
        "kind": kind,
        "seed": seed,
        "truth": [effect.name for effect in campaign.effects],
        "margins": [float(m.margin) for m in campaign.margins],
    }
    known.write_text(json.dumps(truth), encoding="utf-8")
    return known


def outcome_of(run: dict[str, Any]) -> Run:
    """Return what the sweep keeps of a judged campaign."""
    found = run["found"]
    return {
        "campaign": f"{run['kind']}-{run['seed']}",
        "verdict": found["verdict"],
        "explanations": sorted(map(sorted, found.get("explanations", []))),
        "word": worth_of(run),
        "seconds": round(run["seconds"], 1),
    }


def worth_of(run: Run) -> str:
    """Return what a verdict is worth; none is right where nothing is missing."""
    word = word_of(run)
    return "right" if word == "none" and run["kind"] == "null" else word


def waiting(
    done: set[tuple[str, float, str]],
    names: Sequence[str],
    campaigns: Sequence[tuple[str, int]],
) -> Iterator[tuple[str, float, str, int]]:
    """Return what is still to be run: the standard policy first, then each setting."""
    variants = [(AS_IT_IS, 1.0)]
    variants += [(name, factor) for name in names for factor in FACTORS]
    for name, factor in variants:
        for kind, seed in campaigns:
            if (name, factor, f"{kind}-{seed}") not in done:
                yield name, factor, kind, seed


def run_sweep(
    folder: Path,
    runs: Path,
    names: Sequence[str],
    campaigns: Sequence[tuple[str, int]] = CAMPAIGNS,
    minutes: float = np.inf,
) -> None:
    """Judge what is not yet in the file, and stop after so many minutes.

    Args:
        folder: of the campaigns; made where they are missing.
        runs: one JSON line for each setting, factor and campaign.
        names: of the settings to vary.
        campaigns: kinds and seeds to use.
        minutes: after which no other campaign is started.
    """
    folder.mkdir(parents=True, exist_ok=True)
    done = {(r["setting"], r["factor"], r["campaign"]) for r in read_runs(runs)}
    end = time.monotonic() + 60.0 * minutes
    with runs.open("a", encoding="utf-8") as out:
        for name, factor, kind, seed in waiting(done, names, campaigns):
            if time.monotonic() > end:
                return
            policy = STANDARD if name == AS_IT_IS else varied(name, factor)
            truth = make_small(folder, kind, seed)
            found = outcome_of(judge_one(truth, whole=False, policy=policy))
            out.write(json.dumps({"setting": name, "factor": factor} | found) + "\n")
            out.flush()
            sys.stderr.write(f"\r{name} {factor} {kind}-{seed}          ")


def read_runs(runs: Path) -> list[Run]:
    """Return the lines of a file of runs; none where it is missing."""
    if not runs.exists():
        return []
    return [json.loads(line) for line in runs.read_text(encoding="utf-8").splitlines()]


def effect_of(name: str, runs: Sequence[Run]) -> str:
    """Return what a change of a setting by 30 % did to the verdicts."""
    return "; ".join(_one_effect(name, factor, runs) for factor in FACTORS)


def _one_effect(name: str, factor: float, runs: Sequence[Run]) -> str:
    sign = f"{100 * (factor - 1):+.0f} %"
    before = {r["campaign"]: r for r in runs if r["setting"] == AS_IT_IS}
    after = [r for r in runs if (r["setting"], r["factor"]) == (name, factor)]
    if not after:
        return f"{sign}: not run"
    moves = Counter(
        f"{before[r['campaign']]['word']} to {r['word']}"
        for r in after
        if not same_verdict(before[r["campaign"]], r)
    )
    changed = f"{sign}: {sum(moves.values())} of {len(after)}"
    if not moves:
        return changed
    words = ", ".join(f"{n} x {move}" for move, n in sorted(moves.items()))
    return f"{changed} ({words})"


def same_verdict(one: Run, other: Run) -> bool:
    """Return whether two runs of a campaign gave one verdict with the same names."""
    keys = ("verdict", "explanations")
    return all(one[key] == other[key] for key in keys)


def page(runs: Sequence[Run]) -> str:
    """Return the page: decision settings with their effect, then all the others."""
    standard = Counter(r["word"] for r in runs if r["setting"] == AS_IT_IS)
    counts = ", ".join(f"{n} {word}" for word, n in sorted(standard.items()))
    lines = [
        "# The policy of the gap engine",
        "",
        "Made by `benchmarks/gap/policy_sweep.py`. Every threshold and every number of "
        "an algorithm in `analysis/gap` is a field of a frozen record with its unit, "
        "its purpose and the basis on which it was set.",
        "",
        "## Decision settings",
        "",
        "A verdict is compared with these (`analysis/gap/model/policy.py`). They are "
        "part of `gap --json` (key `policy`) and of the provenance of the gap report. "
        f"Digest of the standard policy: `{policy_digest(STANDARD)[:16]}`.",
        "",
        "The last column gives, for a change of the setting alone by 30 % down and up "
        "(whole numbers: by one), in how many campaigns the verdict or the names "
        "change, and how. The campaigns are 7 without an effect (seeds 121000 to "
        "121006), 9 with one effect (121100 to 121108, expected margin 5 to 100) and 4 "
        "with two (121202, 121203, 121205, 121206, margins 20 to 200; other pairs take "
        "too long), all on the small grid of 8 hits, half of them with scatter between "
        f"hits. With the standard policy: {counts}. Right: the exact names, or none "
        "where nothing is missing. Where fewer than 20 campaigns are counted, the rest "
        "has not been run; `run` adds it.",
        "",
        "| setting | value | unit | what it does | how it was set | effect of -30 %; "
        "+30 % |",
        "|---|---|---|---|---|---|",
        *(_row(s, _effect(s, runs)) for s in settings_of(STANDARD)),
        "",
        "## Numerical settings",
        "",
        "Steps, tolerances, sizes and caps of the algorithms, by part of the engine. "
        "No verdict is compared with them.",
    ]
    for part, record in PARTS.items():
        lines += [
            "",
            f"### {part}",
            "",
            "| setting | value | unit | what it does | how it was set |",
            "|---|---|---|---|---|",
            *(_row(s) for s in settings_of(record)),
        ]
    return "\n".join([*lines, ""])


def _effect(setting: Setting, runs: Sequence[Run]) -> str:
    """Return the effect of a setting: of these runs, or as its record states it."""
    apart = setting.name.startswith(UNDER_MODEL_ERROR)
    return setting.effect if apart else effect_of(setting.name, runs)


def _row(setting: Setting, *more: str) -> str:
    cells = (
        setting.name,
        f"{setting.value}",
        setting.unit,
        setting.purpose,
        setting.basis,
        *more,
    )
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Run the sweep, or print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("run", "page", "effects"))
    parser.add_argument("paths", type=Path, nargs="+")
    names = [s.name for s in settings_of(STANDARD)]
    parser.add_argument("--settings", default=",".join(names))
    parser.add_argument("--kinds", default="null,single,pair")
    parser.add_argument("--minutes", type=float, default=np.inf)
    arguments = parser.parse_args()
    if arguments.what == "page":
        sys.stdout.write(page(read_runs(arguments.paths[0])))
        return
    if arguments.what == "effects":
        runs = read_runs(arguments.paths[0])
        for name in names:
            sys.stdout.write(f"{name}: {effect_of(name, runs)}\n")
        return
    folder, file = arguments.paths
    chosen = [name for name in arguments.settings.split(",") if name]
    kinds = arguments.kinds.split(",")
    campaigns = [one for one in CAMPAIGNS if one[0] in kinds]
    run_sweep(folder, file, chosen, campaigns, arguments.minutes)


if __name__ == "__main__":
    main()
