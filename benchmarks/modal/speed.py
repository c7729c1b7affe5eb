# SPDX-License-Identifier: MIT
"""Time, memory and accuracy on the benchmark case, compared with other programs.

Usage: python benchmarks/modal/speed.py [--decibel 40] [--repeats 5] [--rounds 3]
    [--page PAGE.md] [--no-costs]

Peers are the optional extra `benchmarks`; those that cannot be imported are left out
and named. Each runs in a process of its own with one thread, all of them in turn in
each round, so that other load of the machine meets all. Times are CPU seconds, the
least of the rounds and, for ours, of the repeats after one warm-up; memory is what the
peak of the process stands above what it held, data included, before the first run
(Linux only). Errors are rms
over the eight modes, each against the nearest pole of the highest order, as a person
would pick it. In the cost tables ours is run three times and a peer once. Imports and
compiled loops are paid for by a small case before.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from unittest.mock import patch

import numpy as np
from case import Case, benchmark_case
from memory import peak_mib, reset_peak
from peers import OURS, PEERS

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.signal.modal.lscf import fit_poles
from jointbench.signal.modal.matrix_roots import companion_roots

OUTPUTS, LINES, HIGHEST = 40, 4096, 60
_ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "QT_QPA_PLATFORM": "offscreen",
    "PYTHONWARNINGS": "ignore",
}
# What takes longer is left out of the cost tables [s].
_PATIENCE = 90.0
Found = dict[str, float]
Size = tuple[int, int, int]

# Outputs, lines, order: one changes at a time.
COSTS: dict[str, tuple[Size, ...]] = {
    "outputs": tuple((n, LINES, HIGHEST) for n in (4, 16, 40, 64)),
    "lines": tuple((OUTPUTS, n, HIGHEST) for n in (512, 1024, 4096, 16384)),
    "order": tuple((OUTPUTS, LINES, n) for n in (20, 40, 60, 80)),
}


def errors(case: Case, poles: ComplexArray) -> tuple[float, float]:
    """Return rms relative errors of frequency and damping ratio [%]."""
    frequency = np.abs(poles) / (2.0 * np.pi)
    ratio = -poles.real / np.abs(poles)
    likely = (poles.imag > 0.0) & (ratio > 0.0) & (ratio < 0.1)
    frequency, ratio = frequency[likely], ratio[likely]
    away = np.abs(frequency[:, None] / case.natural_frequency - 1.0)
    away = away + 0.01 * np.abs(np.log(ratio[:, None] / case.damping_ratio))
    if frequency.size == 0:
        return float("nan"), float("nan")
    near = np.argmin(away, axis=0)
    parts = (
        frequency[near] / case.natural_frequency - 1.0,
        ratio[near] / case.damping_ratio - 1.0,
    )
    rms = [100.0 * float(np.sqrt(np.mean(p**2))) for p in parts]
    return rms[0], rms[1]


def child(name: str, case: Case, decibel: float, order: int, repeats: int) -> Found:
    """Run one of them in this process."""
    # Imports and compiled loops do not count in time and memory.
    PEERS[name](benchmark_case(4, 1024).noisy(decibel, 0), 20)
    frf = case.noisy(decibel, 0)
    before = reset_peak()
    took, poles = [], np.empty(0, complex)
    for _ in range(repeats + (repeats > 1)):
        start = time.process_time()
        poles = PEERS[name](frf, order)
        took.append(time.process_time() - start)
    peak = peak_mib() - before
    frequency, damping = errors(case, poles)
    return {
        "cpu": min(took),
        "mib": peak,
        "frequency": frequency,
        "damping": damping,
    }


def measure(
    name: str, size: Size, more: list[str], limit: float | None
) -> Found | None:
    """Run one in a process of its own.

    Returns:
        None where it cannot be imported or takes longer than the limit [s].
    """
    outputs, lines, order = (str(n) for n in size)
    command = [sys.executable, __file__, "--child", name, "--outputs", outputs]
    command += ["--lines", lines, "--order", order, *more]
    try:
        done = subprocess.run(
            command,
            env=os.environ | _ONE_THREAD,
            capture_output=True,
            text=True,
            check=False,
            timeout=limit,
        )
    except subprocess.TimeoutExpired:
        return None
    if done.returncode:
        if "ImportError" in done.stderr or "ModuleNotFoundError" in done.stderr:
            return None
        raise RuntimeError(done.stderr)
    found: Found = json.loads(done.stdout.splitlines()[-1])
    return found


def compare(decibel: float, repeats: int, rounds: int) -> list[str]:
    """Return the table of the benchmark case with ratios to jointbench."""
    size, more = (OUTPUTS, LINES, HIGHEST), ["--decibel", str(decibel)]
    turns: dict[str, list[Found | None]] = {name: [] for name in PEERS}
    for _ in range(rounds):
        for name, own in turns.items():
            times = str(repeats if name in OURS else 1)
            own.append(measure(name, size, [*more, "--repeats", times], None))
    found = {name: _least(own) for name, own in turns.items()}
    base = found["jointbench LSCF"]
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    lines = [
        f"{decibel:g} dB, one thread, {rounds} rounds of {repeats} repeats (peers 1), "
        f"load average {load:.1f} on {os.cpu_count()} cores.\n",
        "| | CPU s | over the LSCF | memory MiB | rms f error | rms zeta error |",
        "|---|---|---|---|---|---|",
    ]
    for name, row in found.items():
        if row is None or base is None:
            lines.append(f"| {name} | not installed | | | | |")
            continue
        lines.append(
            f"| {name} | {row['cpu']:.3f} | {row['cpu'] / base['cpu']:.1f} | "
            f"{row['mib']:.0f} | {row['frequency']:.2g} % | {row['damping']:.2g} % |"
        )
    return lines


def _least(turns: list[Found | None]) -> Found | None:
    """Return the round that took the least time, None where one did not run."""
    done = [one for one in turns if one is not None]
    return min(done, key=lambda one: one["cpu"]) if len(done) == len(turns) else None


def costs() -> list[str]:
    """Return CPU seconds and memory against outputs, lines and order."""
    names = [name for name in PEERS if "pyOMA2" not in name]
    lines = []
    for what, sizes in COSTS.items():
        lines.append(f"\n### Against {what}\n")
        lines.append("| outputs | lines | order | " + " | ".join(names) + " |")
        lines.append("|---" * (3 + len(names)) + "|")
        for size in sizes:
            cells = [_cost(name, size) for name in names]
            lines.append(f"| {' | '.join(map(str, size))} | {' | '.join(cells)} |")
    return lines


def _cost(name: str, size: Size) -> str:
    more = ["--repeats", "3" if name in OURS else "1"]
    row = measure(name, size, more, _PATIENCE)
    return "-" if row is None else f"{row['cpu']:.3f} s, {row['mib']:.0f} MiB"


def root_error(decibel: float) -> float:
    """Return how far our poles of the case, all orders, lie from LAPACK's.

    Returns:
        The largest distance relative to the pole [-].
    """
    frf = benchmark_case(OUTPUTS, LINES).noisy(decibel, 0)
    orders = range(2, HIGHEST + 1)
    ours = fit_poles(frf.frequency, frf.response, orders)
    with patch(
        "jointbench.signal.modal.lscf.inverse_roots",
        lambda a, start: companion_roots(a),
    ):
        theirs = fit_poles(frf.frequency, frf.response, orders)
    worst = 0.0
    for one, other in zip(ours, theirs, strict=True):
        if one.pole.size != other.pole.size:
            return float("inf")
        if one.pole.size == 0:
            continue
        away = np.abs(one.pole[:, None] - other.pole).min(axis=1) / np.abs(one.pole)
        worst = max(worst, float(away.max()))
    return worst


def page(given: argparse.Namespace) -> list[str]:
    """Run everything and return the lines of the page."""
    decibel = given.decibel
    lines = [
        "# Time, memory and accuracy compared with other programs\n",
        "Generated by benchmarks/modal/speed.py in one run; its docstring states what "
        "is measured.\nsdypy-EMA fits orders up to 120 (two poles per mode), SDynPy 2 "
        "to 60, each as in its own examples.\nTargets: jointbench LSCF at least 60 "
        "times faster than SDynPy PolyPy and 5 times faster than sdypy-EMA at equal "
        "accuracy,\nthe fit with covariance within 10 times of it, poles within 1e-10 "
        "of LAPACK's.\n",
        *compare(decibel, given.repeats, given.rounds),
        "\nLargest relative difference of the poles of all orders from those of "
        f"LAPACK's `eigvals`: {root_error(decibel):.1e}.",
    ]
    if given.costs:
        lines += [
            '\n## Cost\n\nCPU seconds and memory, two inputs; "-" means more than '
            f"{_PATIENCE:.0f} s. sdypy-EMA runs with twice the order.",
            *costs(),
        ]
    return lines


def main() -> None:
    """Run the benchmark and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--decibel", type=float, default=40.0)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--no-costs", dest="costs", action="store_false")
    parser.add_argument("--lines", type=int, default=LINES)
    parser.add_argument("--outputs", type=int, default=OUTPUTS)
    parser.add_argument("--order", type=int, default=HIGHEST)
    parser.add_argument("--child", default="", help="run this one here, print JSON")
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    if given.child:
        case = benchmark_case(given.outputs, given.lines)
        found = child(given.child, case, given.decibel, given.order, given.repeats)
        print(json.dumps(found))
        return
    lines = page(given)
    if given.page is not None:
        given.page.write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
