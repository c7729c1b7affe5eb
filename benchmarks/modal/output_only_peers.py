# SPDX-License-Identifier: MIT
"""Modes from responses alone beside pyOMA2, on the same records, in the same run.

Usage: OMP_NUM_THREADS=1 python benchmarks/modal/output_only_peers.py FILE.jsonl
    [--structures 12] [--first 0] [--seconds 120] [--page PAGE.md]

The docstring of output_only_structures.py describes the records. Each structure is run
without and with a spindle. pyOMA2 (extra `benchmarks`) gets the band, and for SSI and
pLSCF the orders of jointbench; its interactive choice is replaced by the true natural
frequencies, which favours it: medians of its own stable poles within 2 % of them. False
modes are counted for its automatic clustering (SSI). Each line of the file is one
method on one record; what the file holds is not run again.
"""

import argparse
import json
import logging
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from output_only_structures import (
    BAND,
    RATE,
    OperatedStructure,
    operated,
    random_structure,
)
from scipy.stats import beta

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import NoModeFound
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.output_only.output_only_modes import (
    OutputOnlySettings,
    identify_output_only,
)

ORDER, ROWS, BLOCKS = 40, 50, 24
"""Highest order, block rows and blocks of jointbench, used for pyOMA2 as well."""
_NEAR = 0.02
"""Relative distance up to which a mode counts as found."""
_NORMAL_95 = 1.959964
_LINES = 2048
_FAILURES = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
Found = tuple[FloatArray, FloatArray, FloatArray, FloatArray, bool]
"""Frequencies, damping ratios, their standard deviations (nan without), automatic."""


def ours(run: Recording, truth: FloatArray) -> Found:
    """Return the modes of jointbench, harmonics taken out; the band is given."""
    return _ours(run, OutputOnlySettings(band=BAND))


def ours_with_sines(run: Recording, truth: FloatArray) -> Found:
    """Return the modes of jointbench, harmonics left in the record."""
    return _ours(run, OutputOnlySettings(band=BAND, take_out_sines=False))


def _ours(run: Recording, settings: OutputOnlySettings) -> Found:
    try:
        found = identify_output_only(run, settings)
    except NoModeFound:
        nothing = np.zeros(0)
        return nothing, nothing, nothing, nothing, True
    kept = ~found.sine_like
    return (
        found.natural_frequency[kept],
        found.damping_ratio[kept],
        found.frequency_sd[kept],
        found.damping_ratio_sd[kept],
        True,
    )


def _setup(run: Recording, algorithm: Any) -> Any:
    from pyoma2.setup.single import SingleSetup

    setup = SingleSetup(np.array(run.samples).T, fs=RATE)
    setup.add_algorithms(algorithm)
    setup.run_by_name(algorithm.name)
    return algorithm.result


def _stable_near(result: Any, truth: FloatArray) -> Found:
    """Return the medians of a peer's own stable poles near the true frequencies."""
    known = result.Fn_poles.shape
    tables = [result.Fn_poles, result.Xi_poles]
    for name in ("Fn_poles_std", "Xi_poles_std"):
        values = getattr(result, name, None)
        tables.append(np.full(known, np.nan) if values is None else values)
    rows = []
    for wanted in truth:
        near = np.abs(result.Fn_poles - wanted) < _NEAR * wanted
        kept = near & (np.asarray(result.Lab) == 1)
        if kept.any():
            rows.append([float(np.median(table[kept])) for table in tables])
    frequency, ratio, *sds = np.array(rows).reshape(-1, 4).T
    return frequency, ratio, sds[0], sds[1], False


def ssi(run: Recording, truth: FloatArray) -> Found:
    """Return covariance-driven SSI with uncertainty, stable poles near the truth."""
    from pyoma2.algorithms import SSI

    algorithm = SSI(
        name="ssi",
        method="cov",
        br=ROWS,
        ordmax=ORDER,
        step=2,
        calc_unc=True,
        nb=BLOCKS,
    )
    return _stable_near(_setup(run, algorithm), truth)


def ssi_clustered(run: Recording, truth: FloatArray) -> Found:
    """Return covariance-driven SSI with automatic clustering (Reynders)."""
    from pyoma2.algorithms import SSI
    from pyoma2.algorithms.data.run_params import Clustering

    algorithm = SSI(name="ssi", method="cov", br=ROWS, ordmax=ORDER, step=2)
    _setup(run, algorithm)
    algorithm.add_clustering(Clustering(name="c", quick="Reynders", freqlim=BAND))
    algorithm.run_clustering("c")
    result = algorithm.result.clustering_results["c"]
    frequency = np.asarray(result.Fn, np.float64).ravel()
    ratio = np.asarray(result.Xi, np.float64).ravel()
    unknown = np.full(frequency.size, np.nan)
    return frequency, ratio, unknown, unknown, True


def plscf(run: Recording, truth: FloatArray) -> Found:
    """Return pLSCF on spectra, stable poles near the truth."""
    from pyoma2.algorithms import pLSCF

    algorithm = pLSCF(name="plscf", ordmax=ORDER // 2, nxseg=_LINES)
    return _stable_near(_setup(run, algorithm), truth)


def fsdd(run: Recording, truth: FloatArray) -> Found:
    """Return frequency-spatial domain decomposition, peaks and widths by the truth.

    Half the width of a bell is four half-power widths of 1 % of damping: the best of
    the settings tried, and better than EFDD with any.
    """
    from pyoma2.algorithms import FSDD

    algorithm = FSDD(name="fsdd", nxseg=4 * _LINES)
    _setup(run, algorithm)
    rows = []
    for wanted in truth:
        algorithm.mpe(sel_freq=[wanted], DF1=1.0, DF2=0.08 * wanted)
        result = algorithm.result
        rows.append([float(np.ravel(result.Fn)[0]), float(np.ravel(result.Xi)[0])])
    frequency, ratio = np.array(rows).T
    unknown = np.full(frequency.size, np.nan)
    return frequency, ratio, unknown, unknown, False


_KEPT = "jointbench, sines kept"
METHODS: dict[str, Callable[[Recording, FloatArray], Found]] = {
    "jointbench": ours,
    _KEPT: ours_with_sines,
    "pyOMA2 SSI-cov, poles given": ssi,
    "pyOMA2 SSI-cov, clustering": ssi_clustered,
    "pyOMA2 pLSCF, poles given": plscf,
    "pyOMA2 FSDD, peaks given": fsdd,
}


def score(name: str, run: Recording, structure: OperatedStructure) -> dict[str, Any]:
    """Return errors over truth and over stated sd of each mode, and the CPU time."""
    started = time.process_time()
    try:
        frequency, ratio, *sds, automatic = METHODS[name](run, structure.frequency)
    except _FAILURES as error:  # of a peer: it is a result
        return {"error": f"{type(error).__name__}: {error}"[:200]}
    seconds = time.process_time() - started
    modes, used = [], set()
    for wanted, damping in zip(structure.frequency, structure.ratio, strict=True):
        away = np.abs(frequency - wanted)
        away[~np.isfinite(away)] = np.inf
        if not away.size or away.min() > _NEAR * wanted:
            continue
        near = int(np.argmin(away))
        used.add(near)
        errors = frequency[near] - wanted, ratio[near] - damping
        modes.append(
            [
                errors[0] / wanted,
                errors[1] / damping,
                errors[0] / sds[0][near],
                errors[1] / sds[1][near],
            ]
        )
    inside = (frequency > BAND[0]) & (frequency < BAND[1])
    false = int(inside.sum()) - len(used) if automatic else 0
    modes = [[None if not np.isfinite(v) else float(v) for v in row] for row in modes]
    return {
        "modes": modes,
        "wanted": structure.frequency.size,
        "false": max(false, 0),
        "automatic": automatic,
        "cpu_s": seconds,
    }


def _interval(good: int, count: int) -> str:
    """Return a share with its 95 % interval (Clopper and Pearson)."""
    low = float(beta.ppf(0.025, good, count - good + 1)) if good else 0.0
    high = float(beta.ppf(0.975, good + 1, count - good)) if good < count else 1.0
    return f"{100 * good / count:.0f} % ({100 * low:.0f} to {100 * high:.0f})"


def summary(rows: list[dict[str, Any]]) -> str:
    """Return the page."""
    seconds = " and ".join(sorted({f"{row['seconds']:g}" for row in rows}))
    lines = [
        "## Beside pyOMA2\n",
        "Generated by benchmarks/modal/output_only_peers.py; its docstring and that of"
        " output_only_structures.py describe records and methods. Records of"
        f" {seconds} s, 1024 Hz, {len({row['seed'] for row in rows})} structures."
        " Errors are rms, of the modes found; false modes are counted where poles are"
        " chosen automatically. CPU time relative to jointbench on the same record.\n",
    ]
    for harmonics in (False, True):
        words = "with harmonics of a spindle" if harmonics else "only white forces"
        lines += [
            f"### {words[0].upper()}{words[1:]}\n",
            "| method | modes found | false modes | f error [%] | damping error [%] "
            "| f interval covers | damping interval covers | CPU |",
            "|---" * 8 + "|",
        ]
        own = [row for row in rows if row["harmonics"] == harmonics]
        base = {r["seed"]: r.get("cpu_s") for r in own if r["method"] == "jointbench"}
        for name in METHODS:
            mine = [row for row in own if row["method"] == name]
            if mine:
                lines.append(_line(name, mine, base))
        lines.append("")
    return "\n".join(lines)


def _line(name: str, rows: list[dict[str, Any]], base: dict[int, Any]) -> str:
    good = [row for row in rows if "error" not in row]
    if not good:
        return f"| {name} | {rows[0]['error']} | | | | | | |"
    table = np.array([mode for row in good for mode in row["modes"]], dtype=float)
    table = table.reshape(-1, 4)
    wanted = sum(row["wanted"] for row in good)
    rms = 100.0 * np.sqrt(np.nanmean(table[:, :2] ** 2, axis=0))
    covers = []
    for column in table[:, 2:].T:
        known = column[np.isfinite(column)]
        inside = int((np.abs(known) < _NORMAL_95).sum())
        covers.append(_interval(inside, known.size) if known.size else "no interval")
    false = str(sum(row["false"] for row in good)) if good[0]["automatic"] else "-"
    ratios = [r["cpu_s"] / base[r["seed"]] for r in good if base.get(r["seed"])]
    failed = f", {len(rows) - len(good)} failed" if len(good) < len(rows) else ""
    return (
        f"| {name} | {len(table)} of {wanted}{failed} | {false} | {rms[0]:.3f} | "
        f"{rms[1]:.1f} | {covers[0]} | {covers[1]} | {np.median(ratios):.2g} |"
    )


def main() -> None:
    """Run what the file does not hold yet and write the section of the page."""
    logging.disable(logging.WARNING)
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--structures", type=int, default=12)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    known = given.file.read_text().splitlines() if given.file.exists() else []
    rows: list[dict[str, Any]] = [json.loads(line) for line in known]
    done = {(row["seed"], row["harmonics"], row["method"]) for row in rows}
    with given.file.open("a") as file:
        for seed in range(given.first, given.first + given.structures):
            structure = random_structure(seed)
            for harmonics in (False, True):
                left = [
                    name
                    for name in METHODS
                    if (seed, harmonics, name) not in done
                    and (harmonics or name != _KEPT)  # no sines to keep
                ]
                if not left:
                    continue
                run, speed = operated(
                    structure, given.seconds, seed, harmonics=harmonics
                )
                for name in left:
                    row = {
                        "seed": seed,
                        "harmonics": harmonics,
                        "method": name,
                        "seconds": given.seconds,
                        "speed": speed,
                        **score(name, run, structure),
                    }
                    rows.append(row)
                    file.write(json.dumps(row) + "\n")
                    file.flush()
    text = summary(rows)
    if given.page is not None:
        head = given.page.read_text().partition("## Beside pyOMA2")[0].rstrip()
        given.page.write_text(f"{head}\n\n{text}")
    print(text)


if __name__ == "__main__":
    main()
