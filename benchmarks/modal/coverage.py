# SPDX-License-Identifier: MIT
"""How often 95 % intervals hold the truth, and how large the errors are.

Usage: python benchmarks/modal/coverage.py [--seeds 1000] [--first 0] [--outputs 40]

Each seed is new noise on the benchmark case, at 20, 40 and 60 dB; the noise is not
told to the fit. Intervals are pooled over modes and seeds: 93 to 97 % are wanted at 20
and 40 dB, 90 to 98 % at 60 dB.
"""

import argparse
import time
from collections.abc import Sequence

import numpy as np
from case import WITHIN, Case, benchmark_case

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import NoModeFound
from jointbench.signal.modal_model import ModalModel
from jointbench.signal.modes import identify_modes

LEVELS = (20, 40, 60)
_NORMAL_95 = 1.959964


def scores(case: Case, found: ModalModel) -> FloatArray:
    """Return errors over stated sd: frequency, damping, and rms over residues.

    Args:
        case: the truth.
        found: as many modes.

    Returns:
        Shape (3, n_modes); residues as the share of intervals that hold, real and
        imaginary parts together.
    """
    frequency = (found.natural_frequency - case.natural_frequency) / found.frequency_sd
    damping = (found.damping_ratio - case.damping_ratio) / found.damping_ratio_sd
    error = found.residues - case.residues
    held = np.abs(error.real) < _NORMAL_95 * found.residues_sd.real
    held_imag = np.abs(error.imag) < _NORMAL_95 * found.residues_sd.imag
    share = 0.5 * (held.mean(axis=(1, 2)) + held_imag.mean(axis=(1, 2)))
    return np.array([frequency, damping, share])


def measure(case: Case, decibel: int, seeds: Sequence[int]) -> str:
    """Return one line of the table."""
    pooled, errors, missed, started = [], [], 0, time.process_time()
    for seed in seeds:
        try:
            found = identify_modes(case.noisy(decibel, seed)).model
        except NoModeFound:
            missed += 1
            continue
        if found.natural_frequency.size != WITHIN:
            missed += 1
            continue
        pooled.append(scores(case, found))
        errors.append(
            [
                100.0 * (found.natural_frequency / case.natural_frequency - 1.0),
                100.0 * (found.damping_ratio / case.damping_ratio - 1.0),
            ]
        )
    took = (time.process_time() - started) / len(seeds)
    if not pooled:
        return f"{decibel} dB: not once {WITHIN} modes in {len(seeds)} seeds"
    table, rms = np.array(pooled), np.sqrt(np.mean(np.square(errors), axis=(0, 2)))
    inside = np.mean(np.abs(table[:, :2]) < _NORMAL_95, axis=(0, 2))
    return (
        f"{decibel} dB: held f {100 * inside[0]:.1f} %, zeta {100 * inside[1]:.1f} %, "
        f"both {50 * inside.sum():.1f} %, residues {100 * table[:, 2].mean():.1f} %; "
        f"rms error f {rms[0]:.2g} %, zeta {rms[1]:.2g} %; "
        f"other numbers of modes {missed} of {len(seeds)}; {took:.2f} s CPU a fit"
    )


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--outputs", type=int, default=40)
    parser.add_argument("--lines", type=int, default=4096)
    given = parser.parse_args()
    case = benchmark_case(given.outputs, given.lines)
    for decibel in LEVELS:
        seeds = range(given.first, given.first + given.seeds)
        print(measure(case, decibel, seeds), flush=True)


if __name__ == "__main__":
    main()
