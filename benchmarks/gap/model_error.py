# SPDX-License-Identifier: MIT
"""Judge the verdict under model error on benches that no model describes exactly.

Usage: python benchmarks/gap/model_error.py RUNS.jsonl [--count 120] [--seed 4000]
           [--kind "taken out"]

The benches are those of tests/judges/imperfect_benches.py. Each seed is judged with the
whole catalogue; every second one again with the family of its main law taken out; every
second one without a law, so that only model error is there. One JSON line for each
judgement; those that are in the file are skipped. With --kind only that one of
"mixture", "taken out" and "no law" is judged. With --whole the whole engine runs
before, as in `jointbench gap`; without it only the part under model error.

With --outside the joint law is one that no catalogue has, and every second bench is
free of model error but for its scatter.
"""

import argparse
import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))
from imperfect_benches import (
    FAMILY,
    ImperfectBench,
    Imperfection,
    make_bench_with_errors,
)
from imperfect_laws import OUTSIDE

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.diagnosis.base_fit import fit_base
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.model.diagnosis_record import diagnosis_json
from jointbench.analysis.gap.model.partial_records import partial_json
from jointbench.analysis.gap.model_error.explain_mostly import explain_mostly
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench

KINDS = ("mixture", "taken out", "no law")
VISIBLE = (0.55, 4.4)
"""Change by the laws over that by the model error: a third is below 1."""


def drawn(seed: int) -> tuple[tuple[str, str], float]:
    """Return main and second law of a seed, of different families, and their size."""
    rng = np.random.default_rng([seed, 77])
    names = tuple(FAMILY)
    main = names[seed % len(names)]
    others = [name for name in names if FAMILY[name] != FAMILY[main]]
    visible = float(np.exp(rng.uniform(*np.log(VISIBLE))))
    return (main, str(rng.choice(others))), visible


def waiting(
    seeds: range, kinds: tuple[str, ...], done: set[str]
) -> Iterator[tuple[str, int]]:
    """Return the judgements that are not in the file yet."""
    for seed in seeds:
        for kind in kinds:
            k = KINDS.index(kind)
            due = k == 0 or seed % 2 == k - 1
            if due and f"{kind}-{seed}" not in done:
                yield kind, seed


def drawn_outside(seed: int) -> ImperfectBench:
    """Return a bench with a law that no catalogue has, of the size of a seed."""
    rng = np.random.default_rng([seed, 78])
    name = tuple(OUTSIDE)[seed // 2 % len(OUTSIDE)]
    visible = float(np.exp(rng.uniform(*np.log(VISIBLE))))
    errors = Imperfection()
    if seed % 2:
        errors = Imperfection(absorber=(1e-9, 2e-9), mass=0.003, gain=0.0)
        # The size of a law is relative to the change by the model error.
        visible *= 3.0
    return make_bench_with_errors(seed, (name,), visible=visible, imperfection=errors)


def judged(kind: str, seed: int, bench: ImperfectBench, whole: bool) -> dict[str, Any]:
    """Return truth and judgement of one bench."""
    family = bench.family
    without = frozenset(
        name for name, own in FAMILY.items() if kind == "taken out" and own == family
    )
    start = time.process_time()
    effects: list[str] = []
    if whole:
        found = diagnosis_json(diagnose(bench.campaign, without=without))
        base_seconds = 0.0
        effects = [f"{e['name']}@{e['site']}" for e in found["effects"]]
        left = min(c["chi2_per_dof"] for c in found["candidates"])
        partial = found["mostly"]
        verdict = found["verdict"]
    else:
        with one_thread():
            inner, base = fit_base(make_bench(bench.campaign, without=without))
            base_seconds = time.process_time() - start
            if not isinstance(inner, LumpedBench):
                raise TypeError("a lumped bench is expected")
            left = base.chi2 / inner.blocks.dof
            one = explain_mostly(inner, base, lambda line: None)
        partial = None if one is None else partial_json(one)
        verdict = "mostly" if one is not None and one.named else "unknown"
    return {
        "kind": kind,
        "seed": seed,
        "whole": whole,
        "truth": list(bench.names),
        "family": family,
        "visible": bench.visible,
        "verdict": verdict,
        "effects": effects,
        "left": left,
        "mostly": partial,
        "seconds": time.process_time() - start - base_seconds,
    }


def run(path: Path, seeds: range, kinds: tuple[str, ...], whole: bool) -> None:
    """Judge what is not in the file yet."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    done = {f"{r['kind']}-{r['seed']}" for r in map(json.loads, lines)}
    last: tuple[int, ImperfectBench] | None = None
    for kind, seed in waiting(seeds, kinds, done):
        names, visible = drawn(seed)
        if kind == "no law":
            bench = make_bench_with_errors(seed + 100000)
        elif last is not None and last[0] == seed:
            bench = last[1]
        else:
            bench = make_bench_with_errors(seed, names, visible=visible)
            last = seed, bench
        with path.open("a", encoding="utf-8") as out:
            out.write(json.dumps(judged(kind, seed, bench, whole)) + "\n")
        sys.stderr.write(f"\r{kind} {seed}   ")


def run_outside(path: Path, seeds: range, whole: bool) -> None:
    """Judge benches with an effect outside every catalogue that are not in the file."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    done = {r["seed"] for r in map(json.loads, lines) if r["kind"] == "outside"}
    for seed in seeds:
        if seed in done:
            continue
        found = judged("outside", seed, drawn_outside(seed), whole)
        with path.open("a", encoding="utf-8") as out:
            out.write(json.dumps(found) + "\n")
        sys.stderr.write(f"\routside {seed}   ")


def main() -> None:
    """Run the judgements."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--count", type=int, default=120)
    parser.add_argument("--seed", type=int, default=4000)
    parser.add_argument("--kind", choices=KINDS)
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--outside", action="store_true")
    arguments = parser.parse_args()
    seeds = range(arguments.seed, arguments.seed + arguments.count)
    if arguments.outside:
        run_outside(arguments.runs, seeds, arguments.whole)
        return
    kinds = (arguments.kind,) if arguments.kind else KINDS
    run(arguments.runs, seeds, kinds, arguments.whole)


if __name__ == "__main__":
    main()
