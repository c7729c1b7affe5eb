# SPDX-License-Identifier: MIT
"""Learn the confidence of a name from judged campaigns, never those of the page.

Usage: python benchmarks/gap/calibrate.py RUNS.jsonl [RUNS.jsonl ...]

A logistic model of the evidence (`jointbench.analysis.gap.confidence`), fitted to all
names that were told, right or wrong, with a weak pull towards "more evidence, more
confidence"; prints the coefficients to be written there.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from page import word_of
from scipy.optimize import minimize

from jointbench.analysis.gap.confidence import Evidence, features

PRIOR = np.array([2.0, 1.0, 0.5, 0.5, -0.5])
PULL = 0.5


def main() -> None:
    """Fit and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path, nargs="+")
    rows, right = [], []
    for path in parser.parse_args().runs:
        for line in path.read_text(encoding="utf-8").splitlines():
            run = json.loads(line)
            if run["found"]["verdict"] != "named":
                continue
            evidence = Evidence(**run["found"]["effects"][0]["evidence"])
            rows.append([1.0, *features(evidence)])
            right.append(word_of(run) == "right")
    x, y = np.array(rows), np.array(right, dtype=float)

    def loss(w: np.ndarray) -> float:
        logit = x @ w
        data = np.sum(np.logaddexp(0.0, logit) - y * logit)
        return float(data + 0.5 * PULL * np.sum((w - PRIOR) ** 2))

    found = minimize(loss, PRIOR).x
    names = ("intercept", "margin", "slack", "amplitude", "second")
    for name, value in zip(names, found, strict=True):
        print(f"{name}={value:.3f}")
    print(f"n = {y.size}, right {int(y.sum())}")


if __name__ == "__main__":
    main()
