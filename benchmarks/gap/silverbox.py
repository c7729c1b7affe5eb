# SPDX-License-Identifier: MIT
"""The Silverbox, a real electronic Duffing oscillator: is the cubic spring found?

Usage: python benchmarks/gap/silverbox.py ../shared/data/silverbox/SNLS80mV.mat

Trains on the first eight multisine realisations, scores on the last two, and
extrapolates to the growing arrow: what ``jointbench gap`` does with the model file
`examples/silverbox.toml`, with every explanation that was tried.

Source:
    Wigren and Schoukens 2013, European Control Conference, 2933.
"""

import argparse
import time
from pathlib import Path

from jointbench.analysis.gap.diagnosis.single_record import diagnose_record
from jointbench.station.files.toml_file import read_toml
from jointbench.station.gap.record_campaign import read_record
from jointbench.station.schemas.bench_model import BenchModel

MODEL = Path(__file__).parents[2] / "examples" / "silverbox.toml"


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("path", type=Path)
    began = time.perf_counter()
    given = read_record(parser.parse_args().path, read_toml(MODEL, BenchModel))
    found, scores = diagnose_record(
        given.record, given.training, given.scored, given.nominal, progress=print
    )
    print(found.verdict, found.effects, found.reason)
    for ranked in found.candidates:
        print("  ", ranked)
    for score in scores:
        print(f"{score.name}: {1e3 * score.before:.3f} -> {1e3 * score.after:.3f} mV")
    print(f"{time.perf_counter() - began:.1f} s")


if __name__ == "__main__":
    main()
