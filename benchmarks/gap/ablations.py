# SPDX-License-Identifier: MIT
"""Diagnose the same campaigns with one part of the engine switched off at a time.

Usage: OMP_NUM_THREADS=1 python benchmarks/gap/ablations.py FOLDER RUNS.jsonl [--jobs 2]
       python benchmarks/gap/ablations.py --page RUNS.jsonl > docs/gap-ablations.md

Half of the campaigns hide one effect, half nothing; RUNS.jsonl is continued.
"""

import argparse
import json
import multiprocessing
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from judge import judge_one
from outcomes import NAMEABLE, Run, word_of

from jointbench.analysis.gap.model.policy import STANDARD, Policy

ONE_TEST = 7.88
"""99.5 % of chi2 with one degree of freedom: the limit of a single test."""
KINDS = ("null", "single")


def no_coarse_stages() -> None:
    """Fit whole records from the first step on."""
    from jointbench.analysis.gap.diagnosis import base_fit
    from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL

    base_fit.BASE_RESOLUTIONS = ((FULL, 19), (FULL, 20))


def no_bootstrap() -> None:
    """Compare the largest of all directed tests with the limit of one test."""
    from jointbench.analysis.gap.search import screening

    screening.null_threshold = lambda *_, **__: ONE_TEST


def no_priors() -> None:
    """Fit the base without priors, and accept any base."""
    from jointbench.analysis.gap.residuals import joint_fit as fit

    free = fit.make_problem

    def unpriced(bench: Any, candidates: Any) -> Any:
        problem = free(bench, candidates)
        prior = problem.prior.copy()
        prior[: problem.n_base] *= 1e-4
        return replace(problem, prior=prior)

    _everywhere("make_problem", unpriced)


def one_start() -> None:
    """Give each candidate one start, as its directed test predicts it."""
    from jointbench.analysis.gap.search import candidate_starts
    from jointbench.analysis.gap.search import selection_round as race

    race.STARTS = 1
    candidate_starts.SHARES = (1.0,)
    race.HUGE = np.inf


def _everywhere(name: str, value: Any) -> None:
    """Put a function in the place of another in all modules that imported it."""
    for module in list(sys.modules.values()):
        if module.__name__.startswith("jointbench.analysis.gap"):
            if hasattr(module, name):
                setattr(module, name, value)


VARIANTS: Mapping[str, Callable[[], None]] = {
    "whole engine": lambda: None,
    "without coarse-to-fine": no_coarse_stages,
    "without bootstrap null": no_bootstrap,
    "without priors": no_priors,
    "without multi-start": one_start,
    "without group scoring": lambda: None,
}
POLICIES: Mapping[str, Policy] = {
    "without coarse-to-fine": replace(STANDARD, far_chi2=np.inf),
    "without priors": replace(STANDARD, prior_limit=np.inf),
    "without group scoring": replace(
        STANDARD, parts_chance=-1.0, parts_chance_base=-1.0
    ),
}
"""Policies of the variants that change thresholds."""


def switch_off(variant: str) -> None:
    """Switch one part of the engine off in this process, for good."""
    from jointbench.analysis.gap import diagnose  # noqa: F401 - all modules loaded

    VARIANTS[variant]()


def chosen(folder: Path, count: int) -> list[Path]:
    """Return the same number of campaigns of each kind."""
    chosen: list[Path] = []
    for kind in KINDS:
        paths = folder.glob(f"{kind}-*.json")
        found = sorted(p for p in paths if "truth" not in p.name)
        chosen += found[: count // len(KINDS)]
    return chosen


def run_all(folder: Path, runs: Path, count: int, jobs: int) -> None:
    """Diagnose the campaigns that are not yet in the file."""
    done = set()
    if runs.exists():
        for line in runs.read_text(encoding="utf-8").splitlines():
            run = json.loads(line)
            done.add((run["variant"], run["kind"], run["seed"]))
    with runs.open("a", encoding="utf-8") as out:
        for variant in VARIANTS:
            waiting = [
                path
                for path in chosen(folder, count)
                if (variant, *_key(path)) not in done
            ]
            with multiprocessing.Pool(jobs, switch_off, (variant,)) as pool:
                policy = POLICIES.get(variant, STANDARD)
                judge = partial(judge_one, whole=False, policy=policy)
                for k, run in enumerate(pool.imap_unordered(judge, waiting)):
                    out.write(json.dumps(run | {"variant": variant}) + "\n")
                    out.flush()
                    sys.stderr.write(f"\r{k + 1}/{len(waiting)} {variant}   ")


def _key(path: Path) -> tuple[str, int]:
    kind, _, seed = path.stem.partition("-")
    return kind, int(seed)


def page(runs: list[Run], engine: str) -> str:
    """Return the page, from the campaigns that all variants have judged."""
    judged = Counter((r["kind"], r["seed"]) for r in runs)
    runs = [r for r in runs if judged[r["kind"], r["seed"]] == len(VARIANTS)]
    lines = [
        "# What each part of the gap engine contributes",
        "",
        "Made by `benchmarks/gap/ablations.py`: the same campaigns with one part "
        "switched off at a time. Right: the exact name, or none where nothing is "
        "missing. Wrong: another name, or any name where nothing is missing. All other "
        "verdicts are undecided: ambiguous, unknown, or none where an effect is "
        "hidden. Margins are log-uniform from 1 to 10,000, so that some of the effects "
        "cannot be named by any method. Without multi-start each candidate has one "
        "start; without group scoring no part of the records is tested for separate "
        "parameters.",
        f"Engine: {engine}." if engine else "",
        "",
        "| engine | nothing missing: right, wrong, of | margin >= 50: right, wrong, of "
        "| margin < 50: right, wrong, of | median s | worst s |",
        "|---|---|---|---|---|---|",
    ]
    return "\n".join([*lines, *(_row(v, runs) for v in VARIANTS), ""])


def _row(variant: str, runs: list[Run]) -> str:
    mine = [r for r in runs if r["variant"] == variant]
    null = [r for r in mine if r["kind"] == "null"]
    single = [r for r in mine if r["kind"] == "single"]
    clear = [r for r in single if min(r["margins"]) >= NAMEABLE]
    faint = [r for r in single if min(r["margins"]) < NAMEABLE]
    seconds = [r["seconds"] for r in mine] or [np.nan]
    cells = [_share(part) for part in (null, clear, faint)]
    times = f"{np.median(seconds):.1f} | {max(seconds):.0f}"
    return f"| {variant} | {' | '.join(cells)} | {times} |"


def _share(runs: list[Run]) -> str:
    """Return right, wrong and all."""
    words = [word_of(r) for r in runs]
    if runs and runs[0]["kind"] == "null":
        return f"{words.count('none')}, {words.count('wrong name')}, {len(runs)}"
    return f"{words.count('right')}, {words.count('wrong name')}, {len(runs)}"


def main() -> None:
    """Run the variants, or print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("runs", type=Path, nargs="?")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--page", action="store_true")
    parser.add_argument("--engine", default="", help="which state was judged")
    arguments = parser.parse_args()
    if arguments.page:
        lines = arguments.folder.read_text(encoding="utf-8").splitlines()
        sys.stdout.write(page([json.loads(line) for line in lines], arguments.engine))
        return
    run_all(arguments.folder, arguments.runs, arguments.count, arguments.jobs)


if __name__ == "__main__":
    main()
