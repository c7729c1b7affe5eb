# SPDX-License-Identifier: MIT
"""Time, memory and accuracy on the benchmark case, beside the peers that are there.

Usage: python benchmarks/modal/speed.py [--decibel 40] [--repeats 3] [--page PAGE.md]

Peers are the optional extra `benchmarks`; those that cannot be imported are left out
and named. Each runs in a process of its own with one thread. Times are CPU seconds, the
least of the repeats after one warm-up; memory is what the peak of the process grew by
over what it held before the first run. Errors are rms over the eight modes, each
against the nearest pole of the highest order, as a person would pick it. For the cost
tables every case is run once, after a warm-up of our own compiled loops.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from case import Case, benchmark_case

from jointbench.acquisition.arrays import ComplexArray
from jointbench.signal.frf import Frf
from jointbench.signal.lscf import fit_poles
from jointbench.signal.matrix_roots import companion_roots, inverse_roots
from jointbench.signal.modes import ModalSettings, identify_modes

HIGHEST = 60
# pyOMA2 takes seconds an order; its cost grows with them.
_FEW_ORDERS = 3
_ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "QT_QPA_PLATFORM": "offscreen",
    "PYTHONWARNINGS": "ignore",
}
_KIB = 1024.0

Run = Callable[[Frf, int], ComplexArray]
Found = dict[str, float]


def ours_lscf(frf: Frf, order: int) -> ComplexArray:
    """Poly-reference LSCF, orders 2 to 60."""
    return fit_poles(frf.frequency, frf.response, range(2, order + 1))[-1].pole


def ours_scalar(frf: Frf, order: int) -> ComplexArray:
    """Scalar LSCF, orders 2 to 60: one pole a mode, where peers take two."""
    orders = range(2, order + 1)
    return fit_poles(frf.frequency, frf.response, orders, scalar=True)[-1].pole


def ours_all(frf: Frf, order: int) -> ComplexArray:
    """LSCF, selection, maximum likelihood and covariance."""
    return identify_modes(frf, ModalSettings(highest_order=order)).model.poles


def sdypy(frf: Frf, order: int) -> ComplexArray:
    """sdypy-EMA, scalar LSCF, order to 120; it overwrites its input."""
    from sdypy import EMA

    rows = np.array(frf.response.reshape(-1, frf.frequency.size))
    model = EMA.Model(
        frf=rows,
        freq=np.array(frf.frequency),
        lower=1.0,
        upper=1000.0,
        pol_order_high=2 * order,
        frf_type="accelerance",
    )
    model.get_poles(method="lscf", show_progress=False)
    return np.asarray(model.all_poles[-1], np.complex128)


def sdynpy(frf: Frf, order: int) -> ComplexArray:
    """SDynPy PolyPy, orders 2 to 60; it changes its FRFs in place."""
    import sdynpy as sdp

    outputs = sdp.coordinate_array(np.arange(frf.response.shape[0]) + 1, 3)
    inputs = sdp.coordinate_array([frf.response.shape[0], 14], 3)
    pairs = np.stack(np.broadcast_arrays(outputs[:, None], inputs[None]), axis=-1)
    data = sdp.data_array(
        sdp.data.FunctionTypes.FREQUENCY_RESPONSE_FUNCTION,
        np.array(frf.frequency),
        np.array(frf.response),
        pairs,
    )
    fit = sdp.modal.PolyPy(data)
    fit.compute_poles(np.arange(2, order + 1))
    found = fit.pole_list[0]  # from the highest order down
    omega, ratio = found["omega"], found["zeta"]
    return np.asarray(omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2)))


def pyoma(frf: Frf, order: int) -> ComplexArray:
    """PyOMA2 pLSCF, meant for spectra of responses, fed with the FRFs; three orders."""
    from pyoma2.functions import plscf

    step = 0.5 / float(frf.frequency[-1])
    few = min(order, _FEW_ORDERS)
    denominator, numerator = plscf.pLSCF(np.array(frf.response), step, few)
    poles = plscf.pLSCF_poles(denominator, numerator, step, "per", 2)[3][:, -1]
    return np.asarray(poles[np.isfinite(poles)], np.complex128)


OURS = {
    "jointbench LSCF": ours_lscf,
    "jointbench scalar LSCF": ours_scalar,
    "jointbench LSCF + ML + covariance": ours_all,
}
PEERS: dict[str, Run] = OURS | {
    "sdypy-EMA": sdypy,
    "SDynPy PolyPy": sdynpy,
    "pyOMA2 pLSCF, 3 orders": pyoma,
}
# Outputs, lines, order: one changes at a time.
COSTS = (
    (10, 4096, 60),
    (40, 4096, 60),
    (160, 4096, 60),
    (40, 1024, 60),
    (40, 16384, 60),
    (40, 4096, 30),
    (40, 4096, 100),
)
# Peers are run only where it takes them no longer than on the benchmark case.
_PEER_COSTS = ((10, 4096, 60), (40, 1024, 60), (40, 4096, 30))


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
    if name in OURS:
        PEERS[name](benchmark_case(4, 1024).noisy(decibel, 0), 20)
    frf = case.noisy(decibel, 0)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    took, poles = [], np.empty(0, complex)
    for _ in range(repeats + (repeats > 1)):
        start = time.process_time()
        poles = PEERS[name](frf, order)
        took.append(time.process_time() - start)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    frequency, damping = errors(case, poles)
    return {
        "cpu": min(took),
        "mib": peak / _KIB,
        "frequency": frequency,
        "damping": damping,
    }


def measure(name: str, size: tuple[int, int, int], more: list[str]) -> Found | None:
    """Run one in a process of its own; None where it cannot be imported."""
    outputs, lines, order = (str(n) for n in size)
    command = [sys.executable, __file__, "--child", name, "--outputs", outputs]
    command += ["--lines", lines, "--order", order, *more]
    done = subprocess.run(
        command,
        env=os.environ | _ONE_THREAD,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        if "ImportError" in done.stderr or "ModuleNotFoundError" in done.stderr:
            return None
        raise RuntimeError(done.stderr)
    found: Found = json.loads(done.stdout.splitlines()[-1])
    return found


def compare(decibel: float, repeats: int) -> list[str]:
    """Return the table of the benchmark case with ratios to our own."""
    size, more = (40, 4096, HIGHEST), ["--decibel", str(decibel)]
    more += ["--repeats", str(repeats)]
    found = {name: measure(name, size, more) for name in PEERS}
    base = found["jointbench LSCF"]
    lines = [
        f"{decibel:g} dB, one thread, {repeats} repeats.\n",
        "| | CPU s | over our LSCF | memory MiB | rms f error | rms zeta error |",
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


def costs() -> list[str]:
    """Return CPU seconds against outputs, lines and order."""
    names = [name for name in PEERS if "pyOMA2" not in name]
    lines = ["\n| outputs | lines | order | " + " | ".join(names) + " |"]
    lines.append("|---" * (3 + len(names)) + "|")
    for size in COSTS:
        cells = []
        for name in names:
            asked = name in OURS or size in _PEER_COSTS
            row = measure(name, size, ["--repeats", "1"]) if asked else None
            cells.append("-" if row is None else f"{row['cpu']:.3f}")
        lines.append(f"| {' | '.join(map(str, size))} | {' | '.join(cells)} |")
    return lines


def root_error() -> float:
    """Return the largest relative distance of warm-started roots from LAPACK's."""
    parts = np.random.default_rng(0).normal(size=(2, HIGHEST + 1, 2, 2))
    polynomial = np.asarray(parts[0] + 1j * parts[1])
    polynomial[0] = np.eye(2)
    found = inverse_roots(polynomial, companion_roots(polynomial[:-1]))
    wanted = companion_roots(polynomial)
    distance = np.abs(found[:, None] - wanted).min(axis=1)
    return float(np.max(distance / np.abs(found)))


def main() -> None:
    """Run the benchmark and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--decibel", type=float, default=40.0)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--lines", type=int, default=4096)
    parser.add_argument("--outputs", type=int, default=40)
    parser.add_argument("--order", type=int, default=HIGHEST)
    parser.add_argument("--child", default="", help="run this one here, print JSON")
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    if given.child:
        case = benchmark_case(given.outputs, given.lines)
        found = child(given.child, case, given.decibel, given.order, given.repeats)
        print(json.dumps(found))
        return
    lines = [
        "# Time, memory and accuracy beside the peers\n",
        "Generated by benchmarks/modal/speed.py; its first lines say what is measured."
        "\nsdypy-EMA fits orders to 120 (two poles a mode), SDynPy 2 to 60, each as in"
        " its own examples.\n",
        *compare(given.decibel, given.repeats),
        "\nCPU seconds against outputs, lines and order, two inputs:",
        *costs(),
        f"\nWarm-started roots against LAPACK's `eigvals`, largest relative distance: "
        f"{root_error():.1e}.",
    ]
    if given.page is not None:
        given.page.write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
