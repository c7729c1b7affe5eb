# SPDX-License-Identifier: MIT
"""The Silverbox, a real electronic Duffing oscillator: is the cubic spring found?

Usage: python benchmarks/gap/silverbox.py ../shared/data/silverbox/SNLS80mV.mat

Trains on the first eight multisine realisations, scores on the last two, and
extrapolates to the growing arrow.

Source:
    Wigren and Schoukens 2013, European Control Conference, 2933.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy.io

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.campaign import Campaign
from jointbench.analysis.gap.diagnose import conclude
from jointbench.analysis.gap.fit import Fit
from jointbench.analysis.gap.loop import investigate
from jointbench.analysis.gap.lumped import LumpedBench
from jointbench.analysis.gap.lumped_make import make_bench
from jointbench.analysis.gap.single_record import SingleSheet, single_campaign

SAMPLE_RATE = 610.35
FIRST = 40_578
PERIOD = 8_693
LENGTH = 8_560
ARROW = 40_400
SHEET = SingleSheet(mass=5.5e-6, stiffness=1.0, damping=2.5e-4)


def load(path: Path) -> tuple[FloatArray, FloatArray]:
    """Return input and output [V], their offsets taken off."""
    data = scipy.io.loadmat(path)
    u, y = data["V1"].ravel(), data["V2"].ravel()
    return u - u.mean(), y - y.mean()


def realisations(u: FloatArray, y: FloatArray, which: range) -> Campaign:
    """Return chosen multisine realisations as a campaign."""
    starts = np.array([FIRST + PERIOD * k for k in which])
    return single_campaign("silverbox", u, y, SAMPLE_RATE, starts, LENGTH, SHEET)


def error_mv(bench: LumpedBench, fit: Fit) -> float:
    """Return the RMS error of a fit on a bench [mV]."""
    r = bench.response(fit.base, fit.terms, 8) - bench.campaign.response
    return 1e3 * float(np.sqrt(np.mean(r[:, :, bench.campaign.lead : -64] ** 2)))


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("path", type=Path)
    u, y = load(parser.parse_args().path)
    began = time.perf_counter()
    bench = make_bench(realisations(u, y, range(8)))
    outcome = investigate(bench, print)
    assert isinstance(outcome.bench, LumpedBench)
    found = conclude(outcome, outcome.bench)
    print(found.verdict, found.effects, found.reason)
    for ranked in found.candidates:
        print("  ", ranked)
    test = replace(
        make_bench(realisations(u, y, range(8, 10))), scales=outcome.bench.scales
    )
    arrow = replace(
        make_bench(
            single_campaign(
                "arrow", u, y, SAMPLE_RATE, np.array([100]), ARROW, SHEET, lead=100
            )
        ),
        scales=outcome.bench.scales,
    )
    for word, scored in (("held-out multisine", test), ("arrow", arrow)):
        before, after = error_mv(scored, outcome.base), error_mv(scored, outcome.best)
        print(f"{word}: {before:.3f} -> {after:.3f} mV")
    print(f"{time.perf_counter() - began:.1f} s")


if __name__ == "__main__":
    main()
