# SPDX-License-Identifier: MIT
"""Fit the confidence of a name to forced answers, or judge it on others.

Usage: python benchmarks/gap/calibrate.py fit RUNS.jsonl [--half even]
       python benchmarks/gap/calibrate.py judge RUNS.jsonl [--half odd]

RUNS.jsonl is made by forced_answers.py. A logistic model of the evidence (`confidence`)
is fitted with a weak prior on its slopes, whose signs are fixed: more evidence never
lowers a confidence. `fit` prints the numbers of `model/confidence_settings.py`; `judge`
prints ranking (area under the curve), log score, and the confidence stated in each
third, for the settings in force. The seeds of the two must differ: --half keeps every
second block of six seeds, each with all kinds of campaigns.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from forced_answers import KINDS
from scipy.optimize import minimize
from scipy.stats import rankdata

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.gap.model.confidence import (
    REGRESSORS,
    Evidence,
    confidence_of,
    features,
)

SIGNS = (1.0, -1.0, -1.0, -1.0, -1.0, -1.0, 1.0, -1.0)
"""Of the slopes: margin, excess, probe, left, scatter, deviation, amplitude, second."""
HALVES = ("even", "odd")
PRIOR_SLOPE = 0.3
PRIOR_SD = 0.3


def answers(path: Path, half: str | None) -> list[dict[str, Any]]:
    """Return the campaigns with a forced answer, of all seeds or half of them."""
    lines = path.read_text(encoding="utf-8").splitlines()
    found = [r for r in map(json.loads, lines) if r["evidence"] is not None]
    if half is None:
        return found
    return [r for r in found if HALVES[r["seed"] // len(KINDS) % 2] == half]


def fit(runs: list[dict[str, Any]]) -> None:
    """Print intercept and slopes."""
    x = np.array([features(Evidence(**r["evidence"])) for r in runs])
    x = np.concatenate([np.ones((len(x), 1)), x], axis=1)
    y = np.array([r["right"] for r in runs], dtype=float)
    signs = np.array(SIGNS)
    centre = np.concatenate([[0.0], PRIOR_SLOPE * signs])
    weight = np.concatenate([[0.0], np.full(signs.size, PRIOR_SD**-2)])

    def loss(w: FloatArray) -> float:
        logit = x @ w
        data = np.sum(np.logaddexp(0.0, logit) - y * logit)
        return float(data + 0.5 * np.sum(weight * (w - centre) ** 2))

    bounds = [(None, None), *((0.0, None) if s > 0 else (None, 0.0) for s in SIGNS)]
    found = minimize(loss, centre, bounds=bounds).x
    names = ("intercept", *(r.name for r in REGRESSORS), "second")
    for name, value in zip(names, found, strict=True):
        print(f"{name}={value:.3f}")
    print(f"n = {y.size}, right {int(y.sum())}")


def area_under_curve(stated: FloatArray, right: BoolArray) -> float:
    """Return the chance that a right answer is stated above a wrong one [-]."""
    ranks, hits = rankdata(stated), int(right.sum())
    above = ranks[right].sum() - hits * (hits + 1) / 2
    return float(above / (hits * (right.size - hits)))


def judge(runs: list[dict[str, Any]]) -> None:
    """Print the table of docs/gap-confidence.md."""
    stated = np.array([confidence_of(Evidence(**r["evidence"])) for r in runs])
    right = np.array([r["right"] for r in runs], dtype=bool)
    chance = np.where(right, stated, 1.0 - stated)
    base = right.mean()
    guess = np.where(right, base, 1.0 - base)
    kinds = [r["kind"] for r in runs]
    parts = ", ".join(f"{kinds.count(k)} {k}" for k in dict.fromkeys(kinds))
    print(f"Forced answers: {right.size} ({parts}), {int(right.sum())} right.")
    print(f"Area under the curve: {area_under_curve(stated, right):.2f}.")
    score, least = np.mean(np.log(chance)), np.mean(np.log(guess))
    print(
        f"Log score: {score:.3f}; of the share of right answers alone: {least:.3f}.\n"
    )
    print("| third | n | mean stated | right |\n|---|---|---|---|")
    for k, rows in enumerate(np.array_split(np.argsort(stated), 3)):
        share = f"{100 * right[rows].mean():.1f} %"
        print(
            f"| {k + 1} | {rows.size} | {100 * stated[rows].mean():.1f} % | {share} |"
        )


def main() -> None:
    """Fit or judge."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("action", choices=("fit", "judge"))
    parser.add_argument("runs", type=Path)
    parser.add_argument("--half", choices=HALVES)
    arguments = parser.parse_args()
    runs = answers(arguments.runs, arguments.half)
    fit(runs) if arguments.action == "fit" else judge(runs)


if __name__ == "__main__":
    main()
