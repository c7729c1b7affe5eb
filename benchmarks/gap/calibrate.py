# SPDX-License-Identifier: MIT
"""Fit the confidence of a name to judged campaigns, never to those of the page.

Usage: python benchmarks/gap/calibrate.py RUNS.jsonl [RUNS.jsonl ...]

Campaigns whose effect is in no catalogue are weighted as one in ten: the true share at
a bench is unknown, and a confidence needs an assumption.

A logistic model of the evidence (`confidence`) is fitted to all names, right or wrong,
with a weak prior that more evidence gives more confidence. Prints the coefficients for
that module.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from outcomes import NOT_IN_CATALOGUE, word_of
from scipy.optimize import minimize

from jointbench.analysis.gap.model.confidence import Evidence, features

PRIOR = np.array([2.0, 1.0, 0.5, 0.5, -0.5])
PRIOR_WEIGHT = 0.5
BOUNDS = [(None, None), (0.0, None), (0.0, None), (0.0, None), (None, 0.0)]
"""More evidence never lowers a confidence, a second effect never raises it."""
OUTSIDE = 0.1
"""Assumed share of campaigns whose effect is in no catalogue."""


def main() -> None:
    """Fit and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path, nargs="+")
    rows, right, outside, campaigns = [], [], [], []
    for path in parser.parse_args().runs:
        for line in path.read_text(encoding="utf-8").splitlines():
            run = json.loads(line)
            if run["kind"] == "null":
                continue
            campaigns.append(run["kind"] in NOT_IN_CATALOGUE)
            if run["found"]["verdict"] != "named":
                continue
            evidence = Evidence(**run["found"]["effects"][0]["evidence"])
            rows.append([1.0, *features(evidence)])
            right.append(word_of(run) == "right")
            outside.append(run["kind"] in NOT_IN_CATALOGUE)
    x, y, out = np.array(rows), np.array(right, dtype=float), np.array(outside)
    share = float(np.mean(campaigns))
    weight = np.where(out, OUTSIDE / share, (1.0 - OUTSIDE) / (1.0 - share))

    def loss(w: np.ndarray) -> float:
        logit = x @ w
        data = np.sum(weight * (np.logaddexp(0.0, logit) - y * logit))
        return float(data + 0.5 * PRIOR_WEIGHT * np.sum((w - PRIOR) ** 2))

    found = minimize(loss, PRIOR, bounds=BOUNDS).x
    names = ("intercept", "margin", "slack", "amplitude", "second")
    for name, value in zip(names, found, strict=True):
        print(f"{name}={value:.3f}")
    print(f"n = {y.size}, right {int(y.sum())}")


if __name__ == "__main__":
    main()
