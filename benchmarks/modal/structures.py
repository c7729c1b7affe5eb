# SPDX-License-Identifier: MIT
"""Automatic selection of modes on random structures and in pure noise.

Usage: OMP_NUM_THREADS=1 python benchmarks/modal/structures.py FILE.jsonl
    [--structures 500] [--noise 200] [--first 0] [--seconds 60] [--page PAGE.md]

Every structure is drawn: 2 to 20 modes between 4 and 96 % of the band, half-power
bandwidths of 2 to 40 lines, shapes normal and mildly complex, 4 to 12 outputs, 1 to 3
inputs, two modes beyond the band, noise 40 dB below the rms of each FRF. In every
second one a mode is moved to half a bandwidth from another. A mode counts as found
where a mode was reported within half of its bandwidth, each reported mode for one true
one only; what is left over is false. A fit that takes more than --seconds of CPU is an
exception. Each line of the file is one structure or one record of noise; what the file
holds is not run again.
"""

import argparse
import json
import signal
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.stats import binomtest

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import NoModeFound
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.modal.modes import identify_modes

_LINES = 2001
_HIGHEST = 1000.0
_BEYOND = np.array([1.3, 1.9]) * _HIGHEST
_NOISE = 10.0 ** (-40.0 / 20.0)
_FAR = 1e9
Row = dict[str, object]


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """A structure and the FRF measured on it.

    Attributes:
        pole: of the modes in the band [rad/s], shape (n_modes,).
        frf: with noise.
        pair: index of the lower of two modes half a bandwidth apart, or None.
    """

    pole: ComplexArray
    frf: Frf
    pair: int | None


def draw_structure(seed: int) -> Structure:
    """Draw one; odd seeds hold a pair half a bandwidth apart."""
    rng = np.random.default_rng([seed, 3])
    n_modes, n_outputs = int(rng.integers(2, 21)), int(rng.integers(4, 13))
    n_inputs = int(rng.integers(1, 4))
    frequency = np.linspace(0.0, _HIGHEST, _LINES)
    pitch = frequency[1]
    place = np.sort(rng.uniform(0.04, 0.96, n_modes)) * _HIGHEST
    decay = np.pi * pitch * np.exp(rng.uniform(np.log(2.0), np.log(40.0), n_modes))
    decay = np.minimum(decay, 0.1 * 2.0 * np.pi * place)
    one = int(rng.integers(n_modes - 1)) if seed % 2 else None
    if one is not None:
        place[one + 1] = place[one] + 0.5 * decay[one] / np.pi
        decay[one + 1] = decay[one]
    pole = -decay + 2j * np.pi * place
    everything = np.append(pole, 2.0 * np.pi * _BEYOND * (1j - 0.01))
    shape = rng.normal(size=(n_outputs, everything.size))
    shape = shape * np.exp(1j * rng.normal(0.0, 0.03, shape.shape))
    drives = shape[rng.permutation(n_outputs)[:n_inputs]]
    residue = shape[:, None] * drives / (2j * everything.imag)
    s = 2j * np.pi * frequency
    exact = residue @ (1.0 / (s - everything[:, None]))
    exact += residue.conj() @ (1.0 / (s - everything.conj()[:, None]))
    return Structure(pole, _noisy(frequency, exact * s**2, rng), one)


def _noisy(frequency: FloatArray, exact: ComplexArray, rng: np.random.Generator) -> Frf:
    rms = np.sqrt(np.mean(np.abs(exact) ** 2, axis=2, keepdims=True))
    parts = rng.normal(size=(2, *exact.shape)) / np.sqrt(2.0)
    noisy = exact + _NOISE * rms * (parts[0] + 1j * parts[1])
    return Frf(frequency, noisy, FrfKind.ACCELERANCE)


def draw_noise(seed: int) -> Frf:
    """Return FRFs that hold noise and nothing else."""
    rng = np.random.default_rng([seed, 5])
    shape = (int(rng.integers(1, 13)), int(rng.integers(1, 4)), _LINES)
    parts = rng.normal(size=(2, *shape))
    return Frf(
        np.linspace(0.0, _HIGHEST, _LINES), parts[0] + 1j * parts[1], FrfKind.RECEPTANCE
    )


def score(structure: Structure) -> Row:
    """Return what was found of one structure."""
    pole, pair = structure.pole, structure.pair
    try:
        found = identify_modes(structure.frf).model.poles
    except NoModeFound:
        found = np.empty(0, complex)
    width = -2.0 * pole.real
    away = np.abs(found.imag[:, None] - pole.imag) / width
    rows, columns = linear_sum_assignment(np.where(away < 0.5, away, _FAR))
    good = away[rows, columns] < 0.5
    hit = np.zeros(pole.size, bool)
    hit[columns[good]] = True
    gap = np.abs(pole.imag[:, None] - pole.imag) / np.maximum(width[:, None], width)
    np.fill_diagonal(gap, _FAR)
    apart = gap.min(axis=1) >= 1.0
    left = np.setdiff1d(np.arange(found.size), rows[good])
    return {
        "modes": pole.size,
        "apart": int(apart.sum()),
        "apart_found": int((apart & hit).sum()),
        "false": [float(abs(p) / (2.0 * np.pi)) for p in found[left]],
        "missed": [float(abs(p) / (2.0 * np.pi)) for p in pole[apart & ~hit]],
        "pair": pair is not None,
        "pair_found": pair is not None and bool(hit[pair] and hit[pair + 1]),
    }


def score_noise(frf: Frf) -> Row:
    """Return how many modes were reported in noise."""
    try:
        return {"modes": int(identify_modes(frf).model.natural_frequency.size)}
    except NoModeFound:
        return {"modes": 0}


class TooLong(Exception):
    """A fit took more CPU than it may."""


def _stop(number: int, frame: FrameType | None) -> None:
    raise TooLong


def run(seed: int, *, noise: bool, seconds: float) -> Row:
    """Return the row of one seed; an exception is a row too."""
    row: Row = {"seed": seed, "kind": "noise" if noise else "structure"}
    started = time.process_time()
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        more = score_noise(draw_noise(seed)) if noise else score(draw_structure(seed))
        row |= more
    except Exception as error:  # noqa: BLE001 - any exception at all is what is counted
        row["error"] = f"{type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    return row | {"cpu_s": time.process_time() - started}


def wanted(first: int, structures: int, noise: int) -> Iterator[tuple[str, int]]:
    """Yield kinds and seeds, the two kinds in turns."""
    for seed in range(first, first + max(structures, noise)):
        if seed < first + structures:
            yield "structure", seed
        if seed < first + noise:
            yield "noise", seed


def _total(rows: list[Row], name: str) -> int:
    return sum(int(row.get(name, 0)) for row in rows)  # type: ignore[call-overload]


def summary(rows: list[Row]) -> str:
    """Return the page."""
    whole = [row for row in rows if row["kind"] == "structure"]
    noise = [row for row in rows if row["kind"] == "noise"]
    errors = [row for row in rows if "error" in row]
    apart, found = _total(whole, "apart"), _total(whole, "apart_found")
    pairs, split = _total(whole, "pair"), _total(whole, "pair_found")
    false = sum(len(row.get("false", ())) for row in whole)  # type: ignore[arg-type]
    silent = sum(row.get("modes", 0) == 0 for row in noise)
    wrong = sum(bool(row.get("false")) for row in whole)
    low, high = binomtest(wrong, len(whole)).proportion_ci(method="wilson")
    seeds = [int(str(row["seed"])) for row in whole]
    slowest = max(float(str(row["cpu_s"])) for row in rows)
    lines = [
        "# Automatic selection on random structures",
        "Generated by benchmarks/modal/structures.py; its docstring states what"
        f" is drawn and what counts as found. Seeds {min(seeds)} to {max(seeds)}; 95 %"
        " Wilson intervals.\n",
        "| | result | target |",
        "|---|---|---|",
        f"| structures, 40 dB | {len(whole)} | 500 |",
        f"| modes one bandwidth or more apart found | {found} of {apart} "
        f"({100 * found / max(apart, 1):.1f} %) | 95 % |",
        f"| false modes | {false} in {len(whole)} fits "
        f"({100 * false / max(len(whole), 1):.1f} in 100), {wrong} fits with any "
        f"({100 * low:.1f} to {100 * high:.1f} %) | 1 in 100 |",
        f"| pairs half a bandwidth apart found as two | {split} of {pairs} "
        f"({100 * split / max(pairs, 1):.0f} %) | stated |",
        f"| exceptions, fits over the time limit | {len(errors)} | 0 |",
        f"| only noise, no mode reported | {silent} of {len(noise)} "
        f"({100 * silent / max(len(noise), 1):.1f} %) | 99 % of 200 |",
        f"| slowest fit, CPU s | {slowest:.1f} | |",
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run what the file does not hold yet and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--structures", type=int, default=500)
    parser.add_argument("--noise", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    signal.signal(signal.SIGVTALRM, _stop)
    known = given.file.read_text().splitlines() if given.file.exists() else []
    rows: list[Row] = [json.loads(line) for line in known]
    done = {(row["kind"], row["seed"]) for row in rows}
    with given.file.open("a") as file:
        for kind, seed in wanted(given.first, given.structures, given.noise):
            if (kind, seed) not in done:
                row = run(seed, noise=kind == "noise", seconds=given.seconds)
                rows.append(row)
                file.write(json.dumps(row) + "\n")
                file.flush()
    text = summary(rows)
    if given.page is not None:
        given.page.write_text(text)
    print(text)


if __name__ == "__main__":
    main()
