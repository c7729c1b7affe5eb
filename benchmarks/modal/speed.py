# SPDX-License-Identifier: MIT
"""Time, memory and accuracy on the benchmark case, beside the peers that are there.

Usage: OMP_NUM_THREADS=1 python benchmarks/modal/speed.py [--decibel 40] [--repeats 5]

Peers are the optional extra `benchmark-peers`; those that cannot be imported are left
out and named. Times are CPU seconds, the least of the repeats, after one warm-up; peak
memory is that of Python's allocations during one run. Errors are rms over the eight
modes, each against the nearest pole of the highest order, as a person would pick it.
"""

import argparse
import time
import tracemalloc
from collections.abc import Callable

import numpy as np
from case import Case, benchmark_case

from jointbench.acquisition.arrays import ComplexArray
from jointbench.signal.frf import Frf
from jointbench.signal.lscf import fit_poles
from jointbench.signal.matrix_roots import companion_roots, inverse_roots
from jointbench.signal.modes import identify_modes

HIGHEST = 60
_SCALAR_ORDER = 120

Run = Callable[[], ComplexArray]


def ours_lscf(frf: Frf) -> ComplexArray:
    """Poly-reference LSCF, orders 2 to 60."""
    return fit_poles(frf.frequency, frf.response, range(2, HIGHEST + 1))[-1].pole


def ours_scalar(frf: Frf) -> ComplexArray:
    """Scalar LSCF, orders 2 to 60: one pole a mode, where peers take two."""
    orders = range(2, HIGHEST + 1)
    return fit_poles(frf.frequency, frf.response, orders, scalar=True)[-1].pole


def ours_all(frf: Frf) -> ComplexArray:
    """LSCF, selection, maximum likelihood and covariance."""
    return identify_modes(frf).model.poles


def sdypy(frf: Frf) -> ComplexArray:
    """sdypy-EMA, scalar LSCF, order to 120; it overwrites its input."""
    from sdypy import EMA

    rows = np.array(frf.response.reshape(-1, frf.frequency.size))
    model = EMA.Model(
        frf=rows,
        freq=np.array(frf.frequency),
        lower=1.0,
        upper=1000.0,
        pol_order_high=_SCALAR_ORDER,
        frf_type="accelerance",
    )
    model.get_poles(method="lscf", show_progress=False)
    return np.asarray(model.all_poles[-1], np.complex128)


def sdynpy(frf: Frf) -> ComplexArray:
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
    fit = sdp.modal.PolyPy(data, list(range(2, HIGHEST + 1)))
    fit.compute_poles()
    found = fit.pole_list[-1]
    omega, ratio = found["omega"], found["zeta"]
    return np.asarray(omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2)))


PEERS = {
    "jointbench LSCF": ours_lscf,
    "jointbench scalar LSCF": ours_scalar,
    "jointbench LSCF + ML + covariance": ours_all,
    "sdypy-EMA": sdypy,
    "SDynPy PolyPy": sdynpy,
}


def errors(case: Case, poles: ComplexArray) -> tuple[float, float]:
    """Return rms relative errors of frequency and damping ratio [%]."""
    frequency = np.abs(poles) / (2.0 * np.pi)
    ratio = -poles.real / np.abs(poles)
    likely = (poles.imag > 0.0) & (ratio > 0.0) & (ratio < 0.1)
    frequency, ratio = frequency[likely], ratio[likely]
    away = np.abs(frequency[:, None] / case.natural_frequency - 1.0)
    away = away + 0.01 * np.abs(np.log(ratio[:, None] / case.damping_ratio))
    near = np.argmin(away, axis=0)
    parts = (
        frequency[near] / case.natural_frequency - 1.0,
        ratio[near] / case.damping_ratio - 1.0,
    )
    rms = [100.0 * float(np.sqrt(np.mean(p**2))) for p in parts]
    return rms[0], rms[1]


def measure(name: str, run: Run, case: Case, repeats: int) -> str:
    """Return one line of the table."""
    try:
        poles = run()
    except ImportError as missing:
        return f"{name:36s} not here ({missing.name})"
    took = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        took.append(time.process_time() - start)
    tracemalloc.start()
    run()
    peak = tracemalloc.get_traced_memory()[1] / 2**20
    tracemalloc.stop()
    frequency, damping = errors(case, poles)
    return (
        f"{name:36s} {min(took):8.3f} s CPU {peak:8.0f} MiB   "
        f"f {frequency:.2g} %   zeta {damping:.2g} %"
    )


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
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--decibel", type=float, default=40.0)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--lines", type=int, default=4096)
    parser.add_argument("--outputs", type=int, default=40)
    parser.add_argument("--only", default="", help="part of a name")
    given = parser.parse_args()
    case = benchmark_case(given.outputs, given.lines)
    frf = case.noisy(given.decibel, 0)
    print(f"roots against LAPACK: {root_error():.1e}")
    for name, run in PEERS.items():
        if given.only in name:
            print(
                measure(name, lambda run=run: run(frf), case, given.repeats), flush=True
            )


if __name__ == "__main__":
    main()
