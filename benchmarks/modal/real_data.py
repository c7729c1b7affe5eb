# SPDX-License-Identifier: MIT
"""Modes of the real hammer hits and tool FRFs, automatically, beside the references.

Usage: python benchmarks/modal/real_data.py FOLDER

FOLDER holds hits/measurements_*.npy and frf/Point_*.txt; they may not be passed on.
Hits are fitted together and one by one, tool points together and one by one.
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.errors import NoModeFound
from jointbench.acquisition.import_hits import read_recording
from jointbench.signal.frf import Frf, FrfKind, estimate_frf
from jointbench.signal.modal_model import ModalModel
from jointbench.signal.modes import ModalSettings, identify_modes

# Range of frequency, tolerance beyond it, range of damping; 20 or 25 % beyond it.
HITS = (
    (810.1, 810.3, 0.15, 0.0013, 0.0015),
    (900.0, 900.0, 0.15, 0.0011, 0.0013),
    (2640.2, 2640.2, 0.15, 0.000255, 0.000255),
    (3668.85, 3668.85, 0.3, 0.00024, 0.00033),
    (4391.8, 4391.8, 0.3, 0.00054, 0.00059),
)
TOOL = (
    (1067.5, 1068.5, 10.7, 0.033, 0.034),
    (1955.0, 1962.0, 19.6, 0.041, 0.050),
    (2602.9, 2611.9, 26.1, 0.025, 0.026),
)
Reference = Sequence[tuple[float, float, float, float, float]]


def frfs(folder: Path) -> Iterator[tuple[str, Frf, Reference, float]]:
    """Yield a name, an FRF, its reference and the tolerance of damping."""
    files = sorted((folder / "hits").glob("measurements_*.npy"))
    columns = "time:s,force:N,acceleration:m/s^2"
    hits = [read_recording(path, columns=columns) for path in files]
    yield "all hits", estimate_frf(hits), HITS, 0.2
    for number, hit in enumerate(hits, 1):
        yield f"hit {number}", estimate_frf(hit), HITS, 0.2
    points = sorted((folder / "frf").glob("Point_*.txt"))
    tables = np.array([np.loadtxt(path) for path in points])
    response = (tables[:, :, 1] + 1j * tables[:, :, 2])[:, None]
    tool = Frf(tables[0, :, 0], response, FrfKind.RECEPTANCE)
    yield "tool, all points", tool, TOOL, 0.25
    for number, row in enumerate(response, 1):
        one = Frf(tables[0, :, 0], row[None], FrfKind.RECEPTANCE)
        yield f"tool, point {number}", one, TOOL, 0.25


def verdict(model: ModalModel, reference: Reference, spread: float) -> str:
    """Say of every reference mode whether it was found within tolerance."""
    words = []
    for first, last, tolerance, low, high in reference:
        near = int(np.argmin(np.abs(model.natural_frequency - 0.5 * (first + last))))
        found, ratio = model.natural_frequency[near], model.damping_ratio[near]
        good = first - tolerance <= found <= last + tolerance
        damped = (1.0 - spread) * low <= ratio <= (1.0 + spread) * high
        mark = "" if good and damped else " f!" if not good else " zeta!"
        sd = 100.0 * model.damping_ratio_sd[near]
        words.append(f"{found:.2f} {100.0 * ratio:.4f} % ±{sd:.2g}{mark}")
    return " | ".join(words)


def main() -> None:
    """Run the fits and print one row each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    given = parser.parse_args()
    for name, frf, reference, spread in frfs(given.folder):
        settings = ModalSettings(band=(5.0, 5000.0)) if reference is HITS else None
        try:
            model = identify_modes(frf, settings).model
        except NoModeFound as error:
            print(f"| {name} | none: {error} |")
            continue
        print(f"| {name} | {verdict(model, reference, spread)} |")
        print("  all:", *(f"{f:.1f}" for f in model.natural_frequency))


if __name__ == "__main__":
    main()
