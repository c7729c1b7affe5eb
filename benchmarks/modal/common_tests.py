# SPDX-License-Identifier: MIT
"""The common modal tests: roving hammer, repeated roots, dense sets, heavy damping.

Usage: OMP_NUM_THREADS=1 python benchmarks/modal/common_tests.py FILE.jsonl
    [--label after] [--kinds KIND,KIND] [--seeds 30] [--first 0]

Structures are integrated in time from their matrices (tests/judges), hit with aim
scatter of 1 % and recorded with noise 40, 50 or 60 dB below each response. A mode can
be shown by a measurement where the Cramer-Rao bound on its frequency is below a tenth
of its half-power width. It counts as found where a mode was reported within half its
half-power width, each reported mode for one true one only; what is left is false.
Each line of the file is one structure; what the file holds is not run again. Rows of
an earlier version, run with --label before, stand beside those of this one on the page
that common_tests_page.py writes.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import linear_sum_assignment

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

from hammered_structures import (
    BAND,
    Bench,
    Measured,
    Strike,
    Structure,
    pole_bound,
    prescribed,
    square_membrane,
    strike,
)

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.modal.modes import identify_modes

_FAR = 1e9
_SHOWN = 0.1
Row = dict[str, object]
Rng = np.random.Generator


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A structure, and what was measured on it."""

    structure: Structure
    measured: Measured


def _roving(sensors: tuple[int, ...], points: range) -> list[Strike]:
    names = tuple(f"a{i + 1}" for i in range(len(sensors)))
    return [Strike(point, sensors, names) for point in points]


def _bench(rng: Rng) -> Bench:
    return Bench(decibel=float(rng.choice([40.0, 50.0, 60.0])))


def _spread(rng: Rng, count: int, low: float, high: float) -> tuple[FloatArray, ...]:
    """Return frequencies over 25 to 480 Hz, and damping ratios."""
    place = np.sort(rng.uniform(25.0, 480.0, count))
    return place, np.exp(rng.uniform(np.log(low), np.log(high), count))


def roving(rng: Rng) -> Case:
    """Twelve hit points, one accelerometer; 5 to 16 modes of 0.4 to 3 %."""
    one = prescribed(*_spread(rng, int(rng.integers(5, 17)), 0.004, 0.03), 12, rng)
    return Case(one, strike(one, _roving((3,), range(12)), _bench(rng), rng))


def mixed(rng: Rng) -> Case:
    """Six points hit, six measured from one of them, that one both ways."""
    one = prescribed(*_spread(rng, int(rng.integers(5, 17)), 0.004, 0.03), 12, rng)
    moved = [Strike(0, (sensor,), ("a1",)) for sensor in (1, *range(6, 12))]
    return Case(one, strike(one, [*_roving((0,), range(6)), *moved], _bench(rng), rng))


def repeated(rng: Rng, *, imperfection: float = 0.0) -> Case:
    """A square net, twelve hit points and two accelerometers."""
    lowest, ratio = rng.uniform(50.0, 90.0), rng.uniform(0.003, 0.01)
    one = square_membrane(5, lowest, ratio, imperfection, 14, rng)
    return Case(one, strike(one, _roving((12, 13), range(12)), _bench(rng), rng))


def split(rng: Rng) -> Case:
    """The same net with masses 0.1 % off: pairs apart by less than their width."""
    return repeated(rng, imperfection=1e-3)


def dense(rng: Rng) -> Case:
    """40 modes in the band at a modal overlap of 0.4; 12 outputs, 2 hit points."""
    one = _dense_structure(rng, 12)
    names = tuple(f"a{i + 1}" for i in range(12))
    strikes = [Strike(point, tuple(range(12)), names) for point in (0, 7)]
    return Case(one, strike(one, strikes, _bench(rng), rng))


def dense_single(rng: Rng) -> Case:
    """The same at one drive point, nothing else measured."""
    one = _dense_structure(rng, 1)
    return Case(one, strike(one, _roving((0,), range(1)), _bench(rng), rng))


def _dense_structure(rng: Rng, n_points: int) -> Structure:
    spacing = (BAND[1] - BAND[0]) / 40.0
    place = BAND[0] + spacing * (np.arange(48) + 0.5 + rng.uniform(-0.35, 0.35, 48))
    # Overlap: half-power width over mean spacing.
    return prescribed(place, 0.4 * spacing / (2.0 * place), n_points, rng)


def single(rng: Rng) -> Case:
    """One accelerometer, one hit point; 5 to 16 modes of 0.4 to 3 %."""
    one = prescribed(*_spread(rng, int(rng.integers(5, 17)), 0.004, 0.03), 2, rng)
    return Case(one, strike(one, _roving((1,), range(1)), _bench(rng), rng))


def heavy(rng: Rng) -> Case:
    """6 to 10 modes of 5 to 10 %, four outputs, two hit points."""
    one = prescribed(*_spread(rng, int(rng.integers(6, 11)), 0.05, 0.1), 4, rng)
    names = ("a1", "a2", "a3", "a4")
    strikes = [Strike(point, (0, 1, 2, 3), names) for point in (0, 2)]
    return Case(one, strike(one, strikes, _bench(rng), rng))


def close(rng: Rng) -> Case:
    """4 to 7 places with one, two or three modes in 0.001 to 0.3 of their width.

    Twelve hit points and two accelerometers: of three modes at one frequency these
    show two.
    """
    place, ratio = _spread(rng, int(rng.integers(4, 8)), 0.004, 0.02)
    count = rng.integers(1, 4, place.size)
    each, damped = np.repeat(place, count), np.repeat(ratio, count)
    near = np.repeat(10.0 ** rng.uniform(-3.0, -0.5, place.size), count)
    apart = 2.0 * damped * each * near * rng.uniform(size=each.size)
    damped = damped * np.exp(near * rng.normal(0.0, 0.3, each.size))
    order = np.argsort(each + apart)
    one = prescribed((each + apart)[order], damped[order], 14, rng)
    return Case(one, strike(one, _roving((12, 13), range(12)), _bench(rng), rng))


def apart(rng: Rng) -> Case:
    """5 to 9 modes at least 15 Hz apart, five widths or more, before two references."""
    count = int(rng.integers(5, 10))
    room = (460.0 - 25.0) / count
    place = 25.0 + room * np.arange(count) + rng.uniform(0.0, room - 15.0, count)
    ratio = np.exp(rng.uniform(np.log(0.002), np.log(0.004), count))
    one = prescribed(place, ratio, 14, rng)
    return Case(one, strike(one, _roving((12, 13), range(12)), _bench(rng), rng))


KINDS: dict[str, Callable[[Rng], Case]] = {
    "roving": roving,
    "mixed": mixed,
    "repeated": repeated,
    "split": split,
    "dense": dense,
    "dense_single": dense_single,
    "single": single,
    "heavy": heavy,
    "close": close,
    "apart": apart,
}


def score(case: Case) -> Row:
    """Return what was found of one structure."""
    pole, sd = pole_bound(case.structure, case.measured)
    width = -2.0 * pole.real
    shown = sd[:, 1] < _SHOWN * width
    # At the edge of the band one flank is all that was measured.
    shown &= pole.imag + width < 2.0 * np.pi * BAND[1]
    try:
        result = identify_modes(estimate_frf(case.measured.recordings))
    except BadData as error:
        return {"modes": pole.size, "shown": int(shown.sum()), "refused": str(error)}
    model = result.model
    away = np.abs(model.poles.imag[:, None] - pole.imag) / width
    rows, columns = linear_sum_assignment(np.where(away < 0.5, away, _FAR))
    good = away[rows, columns] < 0.5
    rows, columns = rows[good], columns[good]
    hit = np.zeros(pole.size, bool)
    hit[columns] = True
    left = np.setdiff1d(np.arange(model.poles.size), rows)
    low, high = result.band
    true_frequency = np.abs(pole) / (2.0 * np.pi)
    ratio = -pole.real / np.abs(pole)
    return {
        "modes": pole.size,
        "shown": int(shown.sum()),
        "found": int((shown & hit).sum()),
        "missed": [float(f) for f in true_frequency[shown & ~hit]],
        "false": [float(f) for f in model.natural_frequency[left]],
        "pairs": _pairs(case, pole, hit),
        "notes": list(getattr(result, "remarks", ())),
        "band": [low, high],
        "zeta_error": [
            float(v)
            for v in (model.damping_ratio[rows] / ratio[columns] - 1.0)[shown[columns]]
        ],
        "zeta_bound": [
            float(v) for v in (sd[columns, 0] / -pole[columns].real)[shown[columns]]
        ],
        "f_score": [
            float(v)
            for v in (
                (model.natural_frequency[rows] - true_frequency[columns])
                / model.frequency_sd[rows]
            )
        ],
        "zeta_score": [
            float(v)
            for v in (
                (model.damping_ratio[rows] - ratio[columns])
                / model.damping_ratio_sd[rows]
            )
        ],
        "f_sd_over_bound": [
            float(v) for v in model.frequency_sd[rows] * 2.0 * np.pi / sd[columns, 1]
        ],
    }


def _pairs(
    case: Case, pole: ComplexArray, hit: BoolArray
) -> list[tuple[float, bool, int]]:
    """Return pairs closer than half a width: frequency, shown or not, how many found.

    The second of two modes at one pole is shown where the second singular value of
    their residue stands for a chi-squared of 1000, a residue known to 5 %.
    """
    whole, moved, drive = case.structure.poles()
    measured = case.measured
    pairs, group = np.unique(measured.pairs, axis=0, return_inverse=True)
    outputs, inputs = np.unique(pairs[:, 0]), np.unique(pairs[:, 1])
    s = 2j * np.pi * measured.frequency
    found = []
    for i in np.flatnonzero(np.diff(pole.imag) < -pole.real[:-1]):
        both = [int(np.argmin(np.abs(whole - p))) for p in pole[i : i + 2]]
        both = [both[0], both[0] + 1]
        residue = moved[both][:, outputs].T @ drive[both][:, inputs]
        left, scale, right = np.linalg.svd(residue)
        rest = residue - scale[0] * np.outer(left[:, 0], right[0])
        gain = np.abs(s**2 / (s - pole[i])) ** 2
        total = 0.0
        for number, (o, k) in enumerate(pairs):
            weight = np.sum(1.0 / measured.line_variance[group == number], axis=0)
            size = rest[np.searchsorted(outputs, o), np.searchsorted(inputs, k)]
            total += 2.0 * abs(size) ** 2 * float(np.sum((gain * weight)[1:]))
        frequency = float(abs(pole[i]) / (2.0 * np.pi))
        found.append((frequency, bool(total > 1e3), int(hit[i]) + int(hit[i + 1])))
    return found


def run(kind: str, seed: int, label: str) -> Row:
    """Return the row of one seed."""
    rng = np.random.default_rng([seed, list(KINDS).index(kind), 24])
    case = KINDS[kind](rng)
    started = time.process_time()
    found = score(case)
    spent = time.process_time() - started
    return {"label": label, "kind": kind, "seed": seed, "cpu_s": spent} | found


def main() -> None:
    """Run what the file does not hold yet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--label", default="after")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    known = given.file.read_text().splitlines() if given.file.exists() else []
    rows: list[Row] = [json.loads(line) for line in known]
    done = {(row["label"], row["kind"], row["seed"]) for row in rows}
    with given.file.open("a") as file:
        for seed in range(given.first, given.first + given.seeds):
            for kind in given.kinds.split(","):
                if (given.label, kind, seed) not in done:
                    row = run(kind, seed, given.label)
                    file.write(json.dumps(row) + "\n")
                    file.flush()


if __name__ == "__main__":
    main()
